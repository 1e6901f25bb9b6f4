#!/usr/bin/python3
"""Whole cycles over simulated scans of every kind, idle and under load, each beside a busy loop of the same length and
one that reads memory; then searches with deadlines. A table, all figures, all samples and a picture."""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True  # the source tree stays as it is

from figures import COLUMNS, DEADLINE_COLUMNS, Phase
from report import all_figures, write_report

MEMORY_MAX = 2 << 30  # of all scans
BYTES_A_POINT = 12
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


class Program:
    """flatpose_latency, which runs what it is told on its standard input."""

    def __init__(self, command, log=None):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.log = log
        self.setup, self.scenes = {}, {}
        line = self.read()
        if line.get("kind") != "setup":
            raise RuntimeError("the program did not start")
        self.setup = line
        for _ in range(line["scan_count"]):
            scan = self.read()
            self.scenes[scan["scan"]] = scan["scene"]

    def read(self):
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"the program ended with {self.process.wait()}")
        if self.log:
            self.log.write(line)
        return json.loads(line)

    def run(self, what, name, threads, seconds):
        before = busy_s(), own_s(self.process.pid), time.time()
        self.process.stdin.write(f"{what} {name.replace(' ', '_')} {threads} {seconds}\n")
        self.process.stdin.flush()
        phase = Phase(name, what, threads)
        while True:
            line = self.read()
            if "c" in line:
                phase.rows.append(dict(zip(COLUMNS, line["c"])))
            elif "d" in line:
                phase.rows.append(dict(zip(DEADLINE_COLUMNS, line["d"])))
            elif line.get("kind") == "end":
                phase.end = {key: value for key, value in line.items() if key not in ("kind", "count")}
                if line["count"] != len(phase.rows):
                    raise RuntimeError(f"{name}: {line['count']} samples were taken, {len(phase.rows)} arrived")
                break
        passed = max(time.time() - before[2], 1e-3)
        others = (busy_s() - before[0]) - (own_s(self.process.pid) - before[1])
        phase.others_share = min(1.0, max(0.0, others / passed / os.cpu_count()))
        return phase

    def end(self):
        self.process.stdin.close()
        if self.process.wait() != 0:
            raise RuntimeError(f"the program ended with {self.process.returncode}")


def busy_s():
    """Seconds that all processors together have worked."""
    user, nice, system, _, _, irq, softirq, *_ = map(int, Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:])
    return (user + nice + system + irq + softirq) / TICKS_PER_S


def own_s(pid):
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_S


class Load:
    """Every kind of work on the processors that do not search; on all where there is no other."""

    def __init__(self, searching, online):
        free = [cpu for cpu in online if cpu not in searching] or online
        self.cpus = ",".join(map(str, free))
        each = str(len(free))
        self.command = ["stress-ng", "--quiet", "--taskset", self.cpus, "--cpu", each, "--vm", "1", "--vm-bytes", "256m",
                        "--cache", "1", "--switch", "1", "--timer", "1", "--timeout", "600"]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.DEVNULL)
        time.sleep(1.0)
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()


def plan(quick, seconds, cpu_count):
    """(what, name, threads, seconds, loaded)."""
    total = seconds or (13.0 if quick else 280.0)
    both = min(2, cpu_count)
    yield "cycles", "idle", 1, 0.34 * total, False
    yield "cycles", "loaded", 1, 0.34 * total, True
    if both > 1:
        yield "cycles", "2 threads, idle", 2, 0.12 * total, False
    yield "deadlines", "deadline, idle", 1, 0.1 * total, False
    yield "deadlines", "deadline, loaded", 1, 0.1 * total, True


def machine():
    model = next((line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                  if line.startswith("model name")), "unknown processor")
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], capture_output=True, text=True).stdout.strip()
    return (f"{model}, {os.cpu_count()} CPUs, Linux {os.uname().release}, load {os.getloadavg()[0]:.1f} before; "
            f"commit {commit}; {time.strftime('%Y-%m-%d %H:%M')}")


def parse():
    parser = argparse.ArgumentParser(prog="./run latency", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="some 20 seconds instead of 5 minutes")
    parser.add_argument("--seconds", type=float, metavar="S", help="of measuring, all phases together")
    parser.add_argument("--seeds", type=int, metavar="N", help="scans of each scene (8; quick 1)")
    parser.add_argument("--size", default="600x500", metavar="WxH", help="points of a scan (600x500)")
    parser.add_argument("--max-matches", type=int, default=1, metavar="N", help="of a search (1)")
    parser.add_argument("--cpus", metavar="LIST", help="on which the threads run, in their order (the last ones)")
    parser.add_argument("--priority", type=int, default=80, metavar="P", help="SCHED_FIFO; 0: none (80)")
    parser.add_argument("--output", type=Path, default=Path("build/bench/latency"), metavar="DIR", help="(build/bench/latency)")
    parser.add_argument("--binary", type=Path, default=Path("build/bench/bin/flatpose_latency"), metavar="FILE")
    return parser.parse_args()


def command_of(options, cpus):
    columns, rows = (int(side) for side in options.size.split("x"))
    seeds = options.seeds or (1 if options.quick else 8)
    scans_max = MEMORY_MAX // (columns * rows * BYTES_A_POINT)
    seeds = max(1, min(seeds, scans_max // 14))
    return [options.binary, "--seeds", str(seeds), "--cols", str(columns), "--rows", str(rows), "--max-matches",
            str(options.max_matches), "--cpus", ",".join(map(str, cpus)), "--priority", str(options.priority), "--lock-memory",
            "--cpu-latency-us", "0"]


def measure(options, online, cpus, log):
    start = time.time()
    print("   0 s  simulating scans, teaching", file=sys.stderr, flush=True)
    program = Program(command_of(options, cpus), log)
    phases = []
    for what, name, threads, seconds, is_loaded in plan(options.quick, options.seconds, len(online)):
        print(f"{time.time() - start:4.0f} s  {name}", file=sys.stderr, flush=True)
        if is_loaded:
            with Load(cpus[:threads], online):
                phases.append(program.run(what, name, threads, seconds))
        else:
            phases.append(program.run(what, name, threads, seconds))
    program.end()
    return program, phases, time.time() - start


def main():
    options = parse()
    online = sorted(os.sched_getaffinity(0))
    cpus = [int(cpu) for cpu in options.cpus.split(",")] if options.cpus else online[:-3:-1]
    options.output.mkdir(parents=True, exist_ok=True)
    head = machine()
    with open(options.output / "samples.jsonl", "w") as log:
        program, phases, took_s = measure(options, online, cpus, log)

    scan_text = f"{program.setup['scan_count']} scans of {len(set(program.scenes.values()))} kinds, {options.size}"
    notes = [f"{head}. {'Quick run. ' if options.quick else ''}{took_s:.0f} s.",
             f"{scan_text}; searches on CPU {', '.join(map(str, cpus))}, the load on the others; "
             f"arena {program.setup['arena_bytes'] / 1e6:.0f} MB."]
    steps = program.setup["steps"] + [step for phase in phases for step in phase.end.get("steps", [])]
    notes += sorted({f"- NOT SET UP: {step['text']}" for step in steps if not step["is_done"]})
    report, summary = write_report(phases, program.scenes, notes)
    (options.output / "report.md").write_text(report)
    (options.output / "results.json").write_text(
        json.dumps({"notes": notes, "setup": program.setup, "phases": all_figures(phases, program.scenes)}, indent=1))
    print(summary)
    written = "report.md, results.json, samples.jsonl"
    try:
        from plots import draw_all
        written += ", latency.png" if draw_all(phases, program.scenes, options.output / "latency.png") else ""
    except ImportError as error:
        print(f"no picture: {error}")
    print(f"{options.output}: {written}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
