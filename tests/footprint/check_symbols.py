"""What archives ask of whoever links them must be listed: check_symbols.py NM LIST ARCHIVE... What one of the archives
defines is not asked for."""
import re
import subprocess
import sys

REMEDY = ("Do without, hand it in through an interface (core/host.hpp), or, where it neither allocates, locks, waits nor "
          "differs between machines, add it to tests/footprint/symbols.txt")


def symbols(nm, archive, option):
    """name -> the object that it was seen in first"""
    found = {}
    command = [nm, "-A", "--format=posix", option, archive]
    for line in subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines():
        where, name, *_ = line.split()
        found.setdefault(name, where.rstrip(":").split("[")[-1].rstrip("]"))
    return found


def allowed_patterns(text, asked):
    is_sanitized = "__asan_init" in asked
    is_debug = "__assert_fail" in asked
    for line in text.splitlines():
        words = line.split("#")[0].split()
        if words[:1] == ["debug"]:
            yield from words[1:] if is_debug else []
        elif words[:1] == ["sanitized"]:
            yield from words[1:] if is_sanitized else []
        else:
            yield from map(re.escape, words)


def main():
    nm, listed, *archives = sys.argv[1:]
    asked, defined = {}, {}
    for archive in archives:
        asked |= symbols(nm, archive, "--undefined-only")
        defined |= symbols(nm, archive, "--defined-only")
    if not asked or not any("flatpose" in name for name in defined):
        sys.exit(f"no symbol of flatpose was read from {archives}")
    with open(listed) as file:
        allowed = re.compile("|".join(allowed_patterns(file.read(), asked)))
    from_outside = sorted(set(asked) - set(defined))
    faults = [f"{asked[name]} asks for {name}" for name in from_outside if not allowed.fullmatch(name)]
    print(f"{len(defined)} symbols defined; asked for from outside: {' '.join(from_outside)}")
    sys.exit("\n".join(faults + [REMEDY]) if faults else 0)


main()
