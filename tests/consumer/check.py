"""Installs a build and looks at what came of it: check.py programs|library CMAKE BUILD

programs  every program runs where it was installed
library   no header shows another library's; a project that finds flatpose by find_package() builds and runs, and so does
          the same program by pkg-config; also after the installed tree was moved. The examples in C need no more than a C
          compiler and its linker
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parent / "project"
COMPILER = os.environ.get("CXX", "c++")
C_COMPILER = os.environ.get("CC", "cc")
C_HEADERS = ["stddef.h", "stdint.h"]


def run(*command, **options):
    print("$", *command, flush=True)
    return subprocess.run([str(word) for word in command], check=True, **options)


def installed(cmake, build, folder, *words):
    shutil.rmtree(folder, ignore_errors=True)
    run(cmake, "--install", build, "--prefix", folder, *words, stdout=subprocess.DEVNULL)
    return folder


def check_programs(cmake, build):
    tree = installed(cmake, build, build / "installed", "--component", "programs")
    programs = list((tree / "bin").iterdir())
    for program in programs:
        run(program, "--help", stdout=subprocess.DEVNULL)
    if not any(program.name == "flatpose" for program in programs):
        sys.exit("flatpose was not installed")


def check_headers(include, list_file):
    """Public headers include each other and the standard library, and bring all that they include."""
    headers = sorted(path.relative_to(include) for path in include.rglob("*.h*"))
    for header in headers:
        for other in re.findall(r'#\s*include\s*[<"]([^>"]+)[>"]', (include / header).read_text()):
            if "/" in other and not (include / other).exists():
                sys.exit(f"{header} includes {other}, which is not installed")
            if "/" not in other and "." in other and other not in C_HEADERS:
                sys.exit(f"{header} includes {other}, which is neither flatpose's nor standard C++")
    list_file.write_text("".join(f'#include "{header}"\n' for header in headers))
    print(f"{len(headers)} headers")


def check_library(cmake, build):
    folder = build / "consumer"
    shutil.rmtree(folder, ignore_errors=True)
    tree = installed(cmake, build, folder / "first").rename(folder / "moved")
    by_cmake = folder / "by_cmake"
    by_cmake.mkdir()
    check_headers(tree / "include", by_cmake / "installed_headers.inc")
    examples = next(tree.rglob("examples"))
    run(cmake, "-S", PROJECT, "-B", by_cmake, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={tree}", f"-DCMAKE_CXX_COMPILER={COMPILER}",
        f"-DFLATPOSE_EXAMPLES={examples}", stdout=subprocess.DEVNULL)
    run(cmake, "--build", by_cmake, stdout=subprocess.DEVNULL)
    run(by_cmake / "consumer")
    run(by_cmake / "find_plate")

    os.environ["PKG_CONFIG_PATH"] = str(next(tree.rglob("pkgconfig")))
    run("pkg-config", "--exists", "--print-errors", *(path.stem for path in tree.rglob("*.pc")))
    flags = run("pkg-config", "--cflags", "--libs", "flatpose", stdout=subprocess.PIPE, text=True).stdout.split()
    run(COMPILER, "-std=c++20", PROJECT / "main.cpp", "-o", folder / "by_pkg_config", *flags)
    run(folder / "by_pkg_config")
    run(C_COMPILER, "-std=c11", examples / "find_plate.c", "-o", folder / "find_plate", *flags, "-lm")
    run(folder / "find_plate")
    flags = run("pkg-config", "--cflags", "--libs", "flatpose-camera", stdout=subprocess.PIPE, text=True).stdout.split()
    run(C_COMPILER, "-std=c11", examples / "camera_driver.c", "-o", folder / "camera_driver", *flags)


def main():
    what, cmake, build = sys.argv[1:]
    {"programs": check_programs, "library": check_library}[what](cmake, Path(build))


main()
