"""Reads the machine code of the library: check_objects.py PROCESSOR OBJDUMP NM ARCHIVE...

x86_64   Only the objects compiled for AVX hold its registers, and they define no weak symbol: the linker keeps one copy
         of an inline function and must not take theirs for all.
aarch64  No multiply-add is fused, which would round once instead of twice. The loops that are vectors in the text are
         vectors in the code: they hold what they are made of, and the block loop moves no single byte.
"""
import re
import subprocess
import sys

WIDE_OBJECT = re.compile(r"_avx(2|512)\.cpp")
WIDE_REGISTER = re.compile(r"%[yz]mm\d|%k[0-7]|%xmm(1[6-9]|2\d|3[01])\b|\sv[a-z]+\d*[a-z]*\s.*%xmm")
FUSED = re.compile(r"\sfn?m(la|ls|add|sub)\s")
LANE_MOVE = re.compile(r"\s(umov|smov|ins|mov)\s.*v\d+\.b\[\d+\]")
NEON_WORDS = {  # by object; two rooms call theirs row_kernels
    "block_search": [r"uabd\s+v\d+\.16b", r"umin\s+v\d+\.16b", r"cmh[is]\s+v\d+\.16b"],
    "lay_points": [r"fdiv\s+v\d+\.2d", r"fcvtzs\s+v\d+\.2d"],
    "row_kernels": [r"umin\s+v\d+\.16b", r"fsqrt\s+v\d+\.4s", r"fdiv\s+v\d+\.4s", r"fcvtl2\s", r"fcvtzs\s+v\d+\.2d"],
    "surface_sums": [r"fcvtl\s+v\d+\.2d", r"fmul\s+v\d+\.2d"],
    "tilt_rows": [r"fmul\s+v\d+\.2d", r"fdiv\s+v\d+\.2d", r"fsqrt\s+v\d+\.2d"],
}


def output_of(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def add_code_of(objdump, archive, code):
    """Adds the instructions of each object of an archive."""
    lines = []
    for line in output_of(objdump, "-d", "--no-show-raw-insn", archive).splitlines():
        name = re.match(r"(?:\S+\()?([^\s()]+)\)?:\s+file format", line)
        if name:
            lines = code.setdefault(name[1], [])
        elif re.match(r"\s+[0-9a-f]+:", line):
            lines.append(line)


def weak_symbols(nm, archive):
    """(object, symbol) of what other objects may define too."""
    found = []
    for line in output_of(nm, "-A", "--defined-only", archive).splitlines():
        symbol = re.match(r".*?:([^:]+):\s*\S+ [uvVwW] (\S+)", line)
        if symbol:
            found.append((symbol[1], symbol[2]))
    return found


def first_match(pattern, lines):
    return next((line.strip() for line in lines if pattern.search(line)), None)


def faults_x86_64(code, weak):
    wide = {name for name in code if WIDE_OBJECT.search(name)}
    for name, lines in code.items():
        hit = first_match(WIDE_REGISTER, lines)
        if name not in wide and hit:
            yield f"{name} holds AVX: {hit}"
        if name in wide and not hit:
            yield f"{name} holds no AVX"
    for name, symbol in weak:
        if name in wide:
            yield f"{name} defines {symbol}, which may be taken for all"


def faults_aarch64(code, weak):
    for name, lines in code.items():
        hit = first_match(FUSED, lines)
        if hit:
            yield f"{name} fuses: {hit}"
    for name, words in NEON_WORDS.items():
        lines = code[f"{name}_portable.cpp.o"]
        for word in words:
            if not first_match(re.compile(r"\s" + word), lines):
                yield f"{name} lacks {word}"
    hit = first_match(LANE_MOVE, code["block_search_portable.cpp.o"])
    if hit:
        yield f"the block loop moves a lane: {hit}"


def main():
    processor, objdump, nm, *archives = sys.argv[1:]
    code, weak = {}, []
    for archive in archives:
        add_code_of(objdump, archive, code)
        weak += weak_symbols(nm, archive)
    if "block_search_portable.cpp.o" not in code:
        sys.exit("the block loop is missing: was the right archive read?")
    faults = list({"x86_64": faults_x86_64, "aarch64": faults_aarch64}[processor](code, weak))
    print(f"{len(code)} objects, {sum(map(len, code.values()))} instructions, {len(weak)} weak symbols")
    sys.exit("\n".join(faults) if faults else 0)


main()
