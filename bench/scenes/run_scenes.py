#!/usr/bin/python3
"""Runs flatpose_scenes over all cases (or those asked for) and writes report, results and pictures of failures."""

import argparse
import json
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from tqdm import tqdm

sys.dont_write_bytecode = True  # the source tree stays as it is

from cases import MOST, SEVERAL, all_cases
from report import demands, write_report


def parse_seeds(text):
    first, end = (int(part) for part in text.split(":"))
    if not 0 <= first < end:
        raise argparse.ArgumentTypeError(f"{text}: first < end wanted, e.g. 0:40")
    return first, end


def parse_list(text):
    return text.split(",")


def parse_arguments():
    parser = argparse.ArgumentParser(prog="./run scenes", description=__doc__)
    parser.add_argument("--seeds", type=parse_seeds, metavar="A:B", help="instead of the usual 1000:1040 (absent, empty 1000:1200)")
    parser.add_argument("--only", type=parse_list, metavar="SCENES", help="e.g. medium,high")
    parser.add_argument("--parts", type=parse_list, metavar="PARTS", help="e.g. pad,bracket")
    parser.add_argument("--sensors", type=parse_list, metavar="SENSORS", help="standard, noise, lost, half")
    parser.add_argument("--matches", type=int, choices=[1, SEVERAL, MOST], help="only the search for so many")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="processes (2)")
    parser.add_argument("--output", type=Path, default=Path("build/scenes"), metavar="DIR", help="(build/scenes)")
    parser.add_argument("--binary", type=Path, default=Path("build/bench/bin/flatpose_scenes"), metavar="FILE")
    parser.add_argument("--no-pictures", action="store_true", help="of failures")
    return parser.parse_args()


def chosen_cases(options):
    cases = []
    for case in all_cases(options.seeds):
        if options.matches:
            case = replace(case, max_matches=tuple(n for n in case.max_matches if n == options.matches))
        if not case.max_matches or (options.only and case.scene not in options.only):
            continue
        if options.parts and case.part not in options.parts:
            continue
        if options.sensors and case.sensor not in options.sensors:
            continue
        cases.append(case)
    return cases


def known_scenes(options):
    listed = subprocess.run([options.binary, "--list-scenes"], capture_output=True, text=True, check=True)
    return listed.stdout.split()


def run_case(case, options, bar):
    """The trials of a case, and what the program had to complain of."""
    command = [options.binary, "--scene", case.scene, "--part", case.part, "--sensor", case.sensor,
               "--seeds", f"{case.seeds[0]}:{case.seeds[1]}", "--max-matches", ",".join(map(str, case.max_matches))]
    if not case.has_target:
        command.append("--no-target")
    if not options.no_pictures:
        command += ["--pictures", options.output / "failures"]
    trials = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program:
        for line in program.stdout:
            trials.append(json.loads(line))
            bar.update()
        complaint = program.stderr.read().strip()
    if program.returncode != 0:
        complaint = complaint or f"ended with {program.returncode}"
        return trials, f"{case.name}: {complaint} (after {len(trials)} trials)"
    return trials, ""


def run_cases(cases, options):
    """All trials in the order of the cases, and complaints."""
    total = sum(case.shot_count * len(case.max_matches) for case in cases)
    seconds = 0.2 if sys.stderr.isatty() else 20.0  # a log needs no moving bar
    with tqdm(total=total, unit="trial", smoothing=0.05, mininterval=seconds) as bar, ThreadPoolExecutor(options.jobs) as pool:
        # The long ones first, so that the last does not run alone.
        order = sorted(range(len(cases)), key=lambda i: -cases[i].shot_count * len(cases[i].max_matches))
        futures = {i: pool.submit(run_case, cases[i], options, bar) for i in order}
        outcomes = [futures[i].result() for i in range(len(cases))]
    return [t for trials, _ in outcomes for t in trials], [text for _, text in outcomes if text]


def main():
    options = parse_arguments()
    failures = options.output / "failures"
    shutil.rmtree(failures, ignore_errors=True)
    failures.mkdir(parents=True)
    known = known_scenes(options)
    cases = chosen_cases(options)
    if not cases:
        sys.exit("run_scenes.py: no case is left; see --help")
    complaints = [f"{case.name}: the simulator has no such scene" for case in cases if case.scene not in known]
    cases = [case for case in cases if case.scene in known]

    start = time.time()
    trials, troubles = run_cases(cases, options)
    complaints += troubles
    notes = [f"`./run scenes {' '.join(sys.argv[1:])}`, {time.strftime('%Y-%m-%d %H:%M')}, "
             f"{len(trials)} trials in {time.time() - start:.0f} s."]
    notes += [f"- NOT RUN: {text}" for text in complaints]
    (options.output / "results.jsonl").write_text("".join(json.dumps(t) + "\n" for t in trials))
    report = write_report(trials, notes)
    (options.output / "report.md").write_text(report)
    print(report)
    print(f"{options.output}/report.md, results.jsonl, failures/")
    kept = all(row[-1] != "NO" for row in demands(trials))
    return 0 if kept and not complaints else 1


if __name__ == "__main__":
    sys.exit(main())
