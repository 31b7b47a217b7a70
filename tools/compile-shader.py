#!/usr/bin/env python3
"""compile-shader.py GLSLANG SPIRV_VAL INCLUDE INPUT OUTPUT DEPFILE: compiles a shader for Vulkan 1.2, checks the code
where there is a SPIRV_VAL, and writes it as a C array named after the file: mean.comp is mean_comp."""
import os
import subprocess
import sys

glslang, spirv_val, include, source, output, depfile = sys.argv[1:]
name = os.path.basename(source).replace(".", "_")
binary = output + ".spv"


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
    if done.returncode:
        sys.exit("%s: %s" % (source, done.stdout.strip()))


run(glslang, "-V", "--target-env", "vulkan1.2", "--quiet", "-I" + include, "-I" + os.path.dirname(source), "--depfile",
    depfile, "-o", binary, source)
if spirv_val:
    run(spirv_val, "--target-env", "vulkan1.2", "--scalar-block-layout", binary)
with open(binary, "rb") as file:
    data = file.read()
words = ["0x%08x" % int.from_bytes(data[i:i + 4], sys.byteorder) for i in range(0, len(data), 4)]
with open(output, "w", encoding="ascii") as out:
    out.write("static const uint32_t %s[] = {\n" % name)
    for i in range(0, len(words), 10):
        out.write(" ".join(word + "," for word in words[i:i + 10]) + "\n")
    out.write("};\n")
with open(depfile, encoding="utf-8") as file:
    text = file.read().split(":", 1)[1]
with open(depfile, "w", encoding="utf-8") as file:
    file.write(output + ":" + text)
os.remove(binary)
