#!/usr/bin/env python3
"""compile-shader.py GLSLANG SPIRV_VAL INPUT OUTPUT DEPFILE OPTION...: compiles a shader for Vulkan 1.2 by glslang with
these options, makes its arithmetic that of C (spirv_rounding.py), checks the code where there is a SPIRV_VAL, and
writes it as a C array named after OUTPUT: that in mean.comp.h is mean_comp."""
import array
import os
import subprocess
import sys

sys.dont_write_bytecode = True
import spirv_rounding

glslang, spirv_val, source, output, depfile, *options = sys.argv[1:]
name = os.path.basename(output)[:-len(".h")].replace(".", "_")
binary = output + ".spv"


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
    if done.returncode:
        sys.exit("%s: %s" % (source, done.stdout.strip()))


run(glslang, "-V", "--target-env", "vulkan1.2", "--quiet", "-I" + os.path.dirname(source), *options, "--depfile",
    depfile, "-o", binary, source)
with open(binary, "rb") as file:
    words = spirv_rounding.rounded(array.array("I", file.read()).tolist())
with open(binary, "wb") as file:
    file.write(array.array("I", words).tobytes())
if spirv_val:
    run(spirv_val, "--target-env", "vulkan1.2", "--scalar-block-layout", binary)
with open(output, "w", encoding="ascii") as out:
    out.write("static const uint32_t %s[] = {\n" % name)
    for i in range(0, len(words), 10):
        out.write(" ".join("0x%08x," % word for word in words[i:i + 10]) + "\n")
    out.write("};\n")
with open(depfile, encoding="utf-8") as file:
    text = file.read().split(":", 1)[1]
with open(depfile, "w", encoding="utf-8") as file:
    file.write(output + ":" + text)
os.remove(binary)
