#!/usr/bin/env python3
"""tools/spirv_rounding.py: what it appends to shaders is run here, instruction by instruction, on a device whose
quotients and roots are wrong by up to four units in the last place. Its results must be IEEE's."""
import math
import os
import random
import struct
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.environ["NOC_SOURCE"], "tools"))
import spirv_rounding

WRONG = 4  # units in the last place
CASES = 6000
WORD = 0xffffffff
LEAST = 2.0 ** -126
numbers = random.Random(7)


def rounded(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def bits_of(x):
    return struct.unpack("I", struct.pack("f", x))[0]


def real(bits):
    return struct.unpack("f", struct.pack("I", bits & WORD))[0]


def signed(x):
    return x - (x >> 31 << 32)


def about(x):
    """What a device may take x for."""
    return real(bits_of(x) + numbers.randint(-WRONG, WRONG)) if x and math.isfinite(x) else x


OPERATIONS = {
    "Bitcast": lambda a: real(a) if isinstance(a, int) else bits_of(a),
    "FMul": lambda a, b: rounded(a * b), "FDiv": lambda a, b: about(rounded(a / b)),
    "Sqrt": lambda a: about(rounded(math.sqrt(a))),
    "ConvertFToS": lambda a: int(a) & WORD, "ConvertFToU": lambda a: int(a) & WORD,
    "ConvertSToF": lambda a: rounded(float(signed(a))), "ConvertUToF": lambda a: rounded(float(a)),
    "IAdd": lambda a, b: (a + b) & WORD, "ISub": lambda a, b: (a - b) & WORD, "IMul": lambda a, b: a * b & WORD,
    "ShiftRightLogical": lambda a, b: a >> b, "ShiftLeftLogical": lambda a, b: a << b & WORD,
    "BitwiseOr": lambda a, b: a | b, "BitwiseXor": lambda a, b: a ^ b, "BitwiseAnd": lambda a, b: a & b,
    "SNegate": lambda a: -a & WORD, "SGreaterThan": lambda a, b: signed(a) > signed(b),
    "SLessThan": lambda a, b: signed(a) < signed(b), "SLessThanEqual": lambda a, b: signed(a) <= signed(b),
    "ULessThan": lambda a, b: a < b, "LogicalAnd": lambda a, b: a and b, "Select": lambda a, b, c: b if a else c,
}


def run(text, **values):
    """The function's own result, None where it leaves it to the device."""
    for line in text.split("\n")[1:-1]:
        name, _, operation, kind, *operands = line.split()
        if operation == "Bitcast" and kind == "int" or operation == "Bitcast" and kind == "uint" and \
                not isinstance(values.get(operands[0]), float):
            values[name] = values[operands[0]]
            continue
        values[name] = OPERATIONS[operation](*(values[o] if o in values else int(o, 0) & WORD for o in operands))
    return values["rounded"] if values["fits"] else None


def beside_a_middle():
    """Two numbers whose quotient is next to the middle of two floats: h b + d = a 2^k, h odd, of a bit more than b."""
    while True:
        b, k = 1 << 23 | numbers.getrandbits(23) | 1, numbers.choice((24, 25))
        d = numbers.choice((-1, 1)) * (2 * numbers.randint(0, 20) + 1)
        h = -d * pow(b, -1, 1 << k) % (1 << k)
        a = (h * b + d) >> k
        if h & 1 and 1 << 23 <= a < 1 << 24:
            return float(a), float(b)


def quotients():
    wrong, checked = [], 0
    for case in range(CASES):
        a, b = beside_a_middle() if case % 2 else (real(numbers.getrandbits(32)), real(numbers.getrandbits(32)))
        if not (math.isfinite(a) and math.isfinite(b) and abs(a) >= LEAST and abs(b) >= LEAST and
                LEAST <= abs(a / b) < 2.0 ** 127):
            continue
        have, checked = run(spirv_rounding.QUOTIENTS, a=a, b=b), checked + 1
        if have is None or bits_of(have) != bits_of(rounded(a / b)):
            wrong.append("%s / %s: %s" % (a.hex(), b.hex(), have))
    return wrong, checked


def roots():
    wrong, checked = [], 0
    for case in range(CASES):
        x = real(numbers.getrandbits(31))
        if case % 2:  # next to the square of a middle
            s = 1 << 23 | numbers.getrandbits(23)
            x = rounded(float(s * s + s + (numbers.randint(-3, 3) << 22))) * 2.0 ** numbers.choice((-47, -23, -22, 3))
        if not math.isfinite(x) or x < LEAST:
            continue
        have, checked = run(spirv_rounding.ROOTS, a=x), checked + 1
        if have is None or bits_of(have) != bits_of(rounded(math.sqrt(x))):
            wrong.append("root of %s: %s" % (x.hex(), have))
    return wrong, checked


def left_to_the_device():
    """Operands that are no normal numbers, or whose quotient is none."""
    pairs = ((0.0, 1.0), (math.inf, 1.0), (1.0, math.inf), (1.0, 1e-40), (1e-40, 1.0), (1e30, 1e-30), (1e-30, 1e30),
             (math.nan, 1.0))
    wrong = ["%g / %g" % pair for pair in pairs if takes(spirv_rounding.QUOTIENTS, a=pair[0], b=pair[1])]
    return wrong + ["root of %g" % x for x in (0.0, math.inf, 1e-40) if takes(spirv_rounding.ROOTS, a=x)], 11


def takes(text, **values):
    values = {name: rounded(x) for name, x in values.items()}
    try:
        return run(text, **values) is not None
    except (OverflowError, ValueError):  # of this interpreter: the device's value is then the result
        return False


failed = 0
for number, test in enumerate((quotients, roots, left_to_the_device)):
    wrong, checked = test()
    ok = not wrong and checked > 9
    failed |= not ok
    print("%sok %d - %s (%d)" % ("" if ok else "not ", number + 1, test.__name__.replace("_", " "), checked))
    for line in wrong[:5]:
        print("# " + line)
print("1..3")
sys.exit(failed)
