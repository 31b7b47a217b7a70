"""Makes a shader's quotients and square roots those of IEEE 754, and its sums and products, too.

Vulkan lets a device contract sums and products that are not decorated (NoContraction), and be wrong by 2.5 units in the
last place in a quotient and by more in a root; C has neither. So each sum and product is decorated, and each quotient
and root becomes a call of a function that is appended here: it takes the device's value, computes in whole numbers what
is left over, and from that the nearest value. Where the specialization constant ROUNDS (number 2) is
true, because the device rounds by itself, the functions return the device's value, and nothing of the rest is kept by
the driver. Values that are not normal numbers, and results that are not, are the device's."""

HEAD = 5  # words
EXT_IMPORT, EXT_INST, FUNCTION, DECORATE = 11, 12, 54, 71
SUMS = (129, 131, 133)  # FAdd, FSub, FMul
QUOTIENT, ROOT = 136, 31  # an opcode, and an instruction of GLSL.std.450
NO_CONTRACTION, SPEC_ID, ROUNDS = 42, 1, 2

OPCODES = {
    "Bitcast": 124, "FMul": 133, "FDiv": 136, "ConvertFToS": 110, "ConvertFToU": 109, "ConvertSToF": 111,
    "ConvertUToF": 112, "IAdd": 128, "ISub": 130, "IMul": 132, "ShiftRightLogical": 194, "ShiftLeftLogical": 196,
    "BitwiseOr": 197, "BitwiseXor": 198, "BitwiseAnd": 199, "SNegate": 126, "SGreaterThan": 173, "SLessThan": 177,
    "SLessThanEqual": 179, "ULessThan": 176, "LogicalAnd": 167, "LogicalNot": 168, "Select": 169}

# result = Operation type operand ...; whole numbers are constants: of int behind "+" or "-", of uint otherwise.
QUOTIENTS = """
    device = FDiv float a b
    a_bits = Bitcast uint a
    b_bits = Bitcast uint b
    a_up = ShiftRightLogical uint a_bits 23
    b_up = ShiftRightLogical uint b_bits 23
    a_exponent = BitwiseAnd uint a_up 255
    b_exponent = BitwiseAnd uint b_up 255
    a_low = BitwiseAnd uint a_bits 0x7fffff
    b_low = BitwiseAnd uint b_bits 0x7fffff
    a_whole = BitwiseOr uint a_low 0x800000
    b_whole = BitwiseOr uint b_low 0x800000
    below = ULessThan bool a_low b_low
    shift = Select uint below 24 23
    a_real = ConvertUToF float a_whole
    b_real = ConvertUToF float b_whole
    near = FDiv float a_real b_real
    scale = Select uint below 0x4b800000 0x4b000000
    scale_real = Bitcast float scale
    scaled = FMul float near scale_real
    first = ConvertFToU uint scaled
    shifted = ShiftLeftLogical uint a_whole shift
    product = IMul uint first b_whole
    left = ISub uint shifted product
    left_int = Bitcast int left
    left_real = ConvertSToF float left_int
    off_real = FDiv float left_real b_real
    off = ConvertFToS int off_real
    divisor = Bitcast int b_whole
    taken = IMul int off divisor
    rest = ISub int left_int taken
    twice = IAdd int rest rest
    minus = SNegate int divisor
    above_half = SGreaterThan bool twice divisor
    below_half = SLessThan bool twice minus
    up = Select int above_half +1 +0
    step = Select int below_half -1 up
    all = IAdd int off step
    all_bits = Bitcast uint all
    whole = IAdd uint first all_bits
    whole_real = ConvertUToF float whole
    whole_bits = Bitcast uint whole_real
    difference = ISub uint a_exponent b_exponent
    exponent = ISub uint difference shift
    raise = ShiftLeftLogical uint exponent 23
    magnitude = IAdd uint whole_bits raise
    whole_up = ShiftRightLogical uint whole_bits 23
    result_exponent = IAdd uint whole_up exponent
    signs = BitwiseXor uint a_bits b_bits
    sign = BitwiseAnd uint signs 0x80000000
    bits = BitwiseOr uint magnitude sign
    rounded = Bitcast float bits
    a_from = ISub uint a_exponent 1
    b_from = ISub uint b_exponent 1
    from = ISub uint result_exponent 1
    a_normal = ULessThan bool a_from 254
    b_normal = ULessThan bool b_from 254
    normal = ULessThan bool from 254
    both = LogicalAnd bool a_normal b_normal
    fits = LogicalAnd bool both normal
"""
# Behind either: which value is the result.
CHOICE = """
    own = LogicalNot bool rounds
    chosen = LogicalAnd bool own fits
    result = Select float chosen rounded device
"""
ROOTS = """
    device = Sqrt float a
    a_bits = Bitcast uint a
    a_exponent = ShiftRightLogical uint a_bits 23
    odd_not = BitwiseAnd uint a_exponent 1
    odd = BitwiseXor uint odd_not 1
    a_low = BitwiseAnd uint a_bits 0x7fffff
    a_whole = BitwiseOr uint a_low 0x800000
    radicand = ShiftLeftLogical uint a_whole odd
    radicand_real = ConvertUToF float radicand
    scale_real = Bitcast float 0x4b000000
    square = FMul float radicand_real scale_real
    near = Sqrt float square
    first = ConvertFToU uint near
    shifted = ShiftLeftLogical uint radicand 23
    product = IMul uint first first
    left = ISub uint shifted product
    left_int = Bitcast int left
    left_real = ConvertSToF float left_int
    first_int = Bitcast int first
    twice = IAdd int first_int first_int
    twice_real = ConvertSToF float twice
    off_real = FDiv float left_real twice_real
    off = ConvertFToS int off_real
    sum = IAdd int twice off
    taken = IMul int sum off
    rest = ISub int left_int taken
    nearer = IAdd int first_int off
    minus = SNegate int nearer
    above_half = SGreaterThan bool rest nearer
    below_half = SLessThanEqual bool rest minus
    up = Select int above_half +1 +0
    step = Select int below_half -1 up
    whole = IAdd int nearer step
    whole_real = ConvertSToF float whole
    whole_bits = Bitcast uint whole_real
    even = ISub uint a_exponent odd
    from_odd = IAdd uint even 1
    half = ShiftRightLogical uint from_odd 1
    exponent = ISub uint half 87
    raise = ShiftLeftLogical uint exponent 23
    bits = IAdd uint whole_bits raise
    rounded = Bitcast float bits
    a_from = ISub uint a_exponent 1
    fits = ULessThan bool a_from 254
"""


class Module:
    """Instructions as lists of words, without their lengths: [opcode, operand, ...]."""

    def __init__(self, words):
        self.head, self.code = words[:HEAD], []
        at = HEAD
        while at < len(words):
            length = words[at] >> 16
            self.code.append([words[at] & 0xffff] + words[at + 1:at + length])
            at += length
        self.added = []  # types and constants, behind the module's own
        self.constants = {}

    def new_id(self):
        self.head[3] += 1
        return self.head[3] - 1

    def words(self):
        return self.head + [word for i in self.code for word in [len(i) << 16 | i[0]] + i[1:]]

    def type(self, *instruction):
        """The type that is declared so (opcode, operands): types may not be declared twice."""
        for i in self.code + self.added:
            if i[0] == instruction[0] and i[2:] == list(instruction[1:]):
                return i[1]
        self.added.append([instruction[0], self.new_id(), *instruction[1:]])
        return self.added[-1][1]

    def constant(self, text, types):
        kind = types["int" if text[0] in "+-" else "uint"]
        key = (kind, int(text, 0) & 0xffffffff)
        if key not in self.constants:
            self.constants[key] = self.new_id()
            self.added.append([43, kind, self.constants[key], key[1]])
        return self.constants[key]

    def imported(self):
        """GLSL.std.450."""
        name = b"GLSL.std.450\0\0\0\0"
        name = [int.from_bytes(name[k:k + 4], "little") for k in range(0, 16, 4)]
        for i in self.code:
            if i[0] == EXT_IMPORT and i[2:] == name:
                return i[1]
        at = next(k for k, i in enumerate(self.code) if i[0] not in (17, 10))  # behind capabilities and extensions
        self.code.insert(at, [EXT_IMPORT, self.new_id(), *name])
        return self.code[at][1]

    def function(self, text, parameters, types, rounds, library):
        """Appends it; returns its id."""
        kind = self.type(33, types["float"], *[types["float"]] * len(parameters))
        function, ids = self.new_id(), {}
        self.code.append([FUNCTION, types["float"], function, 0, kind])
        for name in parameters:
            ids[name] = self.new_id()
            self.code.append([55, types["float"], ids[name]])
        self.code.append([248, self.new_id()])  # Label
        for line in text.split("\n")[1:-1] + CHOICE.split("\n")[1:-1]:
            name, _, operation, result, *operands = line.split()
            values = [rounds if o == "rounds" else ids[o] if o in ids else self.constant(o, types) for o in operands]
            ids[name] = self.new_id()
            head = [EXT_INST, types[result], ids[name], library, ROOT] if operation == "Sqrt" else \
                [OPCODES[operation], types[result], ids[name]]
            self.code.append(head + values)
        self.code += [[254, ids["result"]], [56]]  # ReturnValue, FunctionEnd
        return function


def rounded(words):
    """The module of these words (a list), with IEEE's results."""
    m = Module(words)
    library = next((i[1] for i in m.code if i[0] == EXT_IMPORT), None)
    is_root = [i[0] == EXT_INST and i[3] == library and i[4] == ROOT for i in m.code]
    decorated = {i[1] for i in m.code if i[0] == DECORATE and i[2] == NO_CONTRACTION}
    decorations = [[DECORATE, i[2], NO_CONTRACTION] for i in m.code if i[0] in SUMS and i[2] not in decorated]
    if any(is_root) or any(i[0] == QUOTIENT for i in m.code):
        decorations += call_instead(m, is_root)
    at = next(k for k, i in enumerate(m.code) if i[0] in range(19, 60) and i[0] != 54)  # the first type
    m.code[at:at] = decorations
    return m.words()


def call_instead(m, is_root):
    """Functions in the place of quotients and roots; returns decorations."""
    types = {"float": m.type(22, 32), "uint": m.type(21, 32, 0), "int": m.type(21, 32, 1), "bool": m.type(20)}
    rounds = m.new_id()
    m.added.append([49, types["bool"], rounds])  # SpecConstantFalse
    wanted = [(i, "root") if root else (i, "quotient") for i, root in zip(m.code, is_root) if root or i[0] == QUOTIENT]
    library, first = m.imported(), len(m.code)
    functions = {"root": (ROOTS, ["a"]), "quotient": (QUOTIENTS, ["a", "b"])}
    made = {kind: m.function(*functions[kind], types, rounds, library) for kind in sorted({kind for _, kind in wanted})}
    for i, kind in wanted:
        assert i[1] == types["float"], "only of one value at a time"
        i[:] = [57, i[1], i[2], made[kind]] + (i[5:] if kind == "root" else i[3:])  # FunctionCall
    at = next(k for k, i in enumerate(m.code[:first]) if i[0] == FUNCTION)
    m.code[at:at] = m.added
    return [[DECORATE, rounds, SPEC_ID, ROUNDS]]
