#!/usr/bin/python3
"""Runs flatpose_speed group by group, contenders of a group interleaved, and writes the table, all figures and plots."""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True  # the source tree stays as it is

from report import Figures, write_report

PADS = ["lone", "low", "medium", "high", "pile"]
CYLINDERS = ["cyl_loose", "cyl_grid", "cyl_brick", "cyl_loose_planar"]
SIZES = ["600x500", "1536x1280"]


def groups(quick):
    """(filter, repetitions, seconds a repetition). A group is a process: its contenders are interleaved."""
    rows = ["lone", "lone_planar", "lone_level"] if quick else (
        PADS + [f"{pad}_planar" for pad in PADS] + ["medium_normals", "medium_normals_level", "lone_level"] + CYLINDERS)
    repetitions = 1 if quick else 3
    yield "^roof/", repetitions + 2, 0.02
    for row in rows:
        yield f"^search/{row}/", 1 if row in CYLINDERS else repetitions, 0.05
    for row in ["medium_240"] if quick else ["medium_240", "medium_720"]:
        yield f"^prune/{row}/", repetitions + 2, 0.05
    yield "^image/" if not quick else "^image/600x500/", repetitions + 2, 0.03
    for size in SIZES[:1] if quick else SIZES:
        yield f"^cycle/{size}/", 1, 0.0
    yield "^growth/angles/" if quick else "^growth/", repetitions, 0.02


def run_group(program, pattern, repetitions, seconds, quick):
    command = [program, f"--benchmark_filter={pattern}", f"--benchmark_repetitions={repetitions}",
               f"--benchmark_min_time={seconds}", "--benchmark_enable_random_interleaving=true", "--benchmark_format=json"]
    if quick:
        command.append("--quick")
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        return None, f"{pattern}: {done.stderr.strip() or 'ended with ' + str(done.returncode)}"
    if not done.stdout.strip():
        return {"benchmarks": []}, f"{pattern}: nothing of that name"
    return json.loads(done.stdout), ""


def machine(context):
    model = next((line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                  if line.startswith("model name")), "unknown processor")
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], capture_output=True, text=True).stdout.strip()
    return (f"{model}, {context.get('num_cpus', '?')} cores, load {', '.join(f'{x:.1f}' for x in context.get('load_avg', []))}; "
            f"commit {commit}; {time.strftime('%Y-%m-%d %H:%M')}")


def main():
    parser = argparse.ArgumentParser(prog="./run bench", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="under a minute: fewer inputs, rows and repetitions")
    parser.add_argument("--only", metavar="REGEX", help="groups whose filter holds this text, e.g. cycle")
    parser.add_argument("--output", type=Path, default=Path("build/bench/speed"), metavar="DIR", help="(build/bench/speed)")
    parser.add_argument("--binary", type=Path, default=Path("build/bench/bin/flatpose_speed"), metavar="FILE")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)

    start, benchmarks, complaints, context = time.time(), [], [], {}
    for pattern, repetitions, seconds in groups(options.quick):
        if options.only and options.only not in pattern:
            continue
        print(f"{time.time() - start:4.0f} s  {pattern}", file=sys.stderr, flush=True)
        result, complaint = run_group(options.binary, pattern, repetitions, seconds, options.quick)
        complaints += [complaint] if complaint else []
        if result:
            benchmarks += result["benchmarks"]
            context = context or result.get("context", {})

    notes = [f"{machine(context)}. {'Quick run. ' if options.quick else ''}{time.time() - start:.0f} s."]
    notes += [f"- NOT RUN: {text}" for text in complaints]
    (options.output / "results.json").write_text(json.dumps({"context": context, "benchmarks": benchmarks}, indent=1))
    figures = Figures(benchmarks)
    report, summary = write_report(figures, notes)
    (options.output / "report.md").write_text(report)
    print(summary)
    try:
        from plots import draw_all
        draw_all(figures, options.output)
    except ImportError as error:
        complaints.append(f"no plots: {error}")
        print(complaints[-1])
    print(f"{options.output}/report.md, results.json, *.png")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
