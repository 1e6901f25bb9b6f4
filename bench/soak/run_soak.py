#!/usr/bin/python3
"""Many thousand triggers at the real daemon over loopback: how long a well-behaved PLC waits for a register, beside a
plain echo of as many bytes; what that costs when others misbehave; and where the time goes from the end of the
acquisition to the read that shows the pose."""

import argparse
import csv
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

sys.dont_write_bytecode = True  # the source tree stays as it is

from faults import FAULTS, Fault
from plc import Daemon, Plc, registers_of
from soak_report import stage_rows, write_report

COLUMNS, ROWS = 160, 133
SCENES = [("single", 11), ("low", 12), ("empty", 13), ("tilt", 14), ("medium", 15), ("lone", 16)]


def run(*command):
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)


class Ground:
    """Scans, a part, and configs of the daemon."""

    def __init__(self, folder, binaries):
        self.folder, self.flatpose = folder, binaries / "flatpose"
        shutil.rmtree(folder, ignore_errors=True)
        (folder / "scans").mkdir(parents=True)
        self.simulate("single", 1, folder / "teach.pcd")
        run(self.flatpose, "teach", folder / "teach.pcd", "-o", folder / "pad.fpt")
        for i, (scene, seed) in enumerate(SCENES):
            self.simulate(scene, seed, folder / "scans" / f"{i}-{scene}.pcd")

    def simulate(self, scene, seed, path):
        run(self.flatpose, "simulate", scene, "--seed", seed, "--cols", COLUMNS, "--rows", ROWS, "-o", path, "--truth",
            self.folder / "truth.json")

    def config(self, name, scans="scans", more=""):
        path = self.folder / f"{name}.toml"
        path.write_text(f"""[modbus]
bind = "127.0.0.1"
port = 0
[source]
replay = "{scans}"
allow_simulated = true
[search]
scan_width_px = {COLUMNS}
scan_height_px = {ROWS}
cell_count = 200_000
[[part]]
name = "pad"
file = "pad.fpt"
[[job]]
parts = ["pad"]
{more}""")
        return path


class Echo:
    def __init__(self, binary):
        self.process = subprocess.Popen([binary, "echo"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = int(self.process.stdout.readline())

    def end(self):
        self.process.stdin.close()
        self.process.wait()


class Bench:
    def __init__(self, options):
        self.options = options
        self.ground = Ground(options.output / "ground", options.binaries)
        self.registers = registers_of(self.ground.flatpose)
        self.echo = Echo(options.binaries / "flatpose_soak")
        self.number = 1
        self.start = time.time()

    def say(self, text):
        print(f"{time.time() - self.start:5.0f} s  {text}", file=sys.stderr, flush=True)

    def daemon(self, *args, **kwargs):
        return Daemon(self.options.binaries / "flatposed", self.ground.config(*args, **kwargs))

    def plc(self, daemon, triggers, seconds=0.0, pause_us=0, trips=None):
        """A stretch of the well-behaved PLC: its figures, or why it could not go on."""
        command = [self.options.binaries / "flatpose_soak", "plc", "--port", daemon.port, "--echo-port", self.echo.port,
                   "--triggers", triggers, "--time-max-us", int(seconds * 1e6), "--poll-us", self.options.poll_us,
                   "--pause-us", pause_us, "--first", self.number]
        done = subprocess.run([str(word) for word in command + (["--trips", trips] if trips else [])], capture_output=True,
                              text=True, check=False)
        if done.returncode != 0:
            return {"failure": done.stderr.strip() or f"ended with {done.returncode}"}
        figures = json.loads(done.stdout)
        self.number = (self.number - 1 + figures["done"] + figures["refused"] + figures["lost"]) % 65535 + 1
        return figures

    def end(self):
        self.echo.end()


def soak(bench):
    """The long stretch, with memory and descriptors looked at."""
    daemon = bench.daemon("soak")
    count = bench.options.triggers
    warm_up = bench.plc(daemon, 500)
    assert "failure" not in warm_up, warm_up
    before = {"rss_kb": daemon.rss_kb(), "fds": daemon.fd_count()}
    most = dict(before)
    with Watch(daemon, most):
        figures = bench.plc(daemon, count, trips=bench.options.output / "soak_trips.csv")
    after = {"rss_kb": daemon.rss_kb(), "fds": daemon.fd_count()}
    return {**figures, "before": before, "most": most, "after": after, "exit_code": daemon.end()}


class Watch:
    """What the daemon took at most, looked at once a second."""

    def __init__(self, daemon, most):
        self.over = threading.Event()
        self.thread = threading.Thread(target=self.look, args=(daemon, most), daemon=True)

    def look(self, daemon, most):
        while not self.over.wait(1.0):
            most["rss_kb"] = max(most["rss_kb"], daemon.rss_kb())
            most["fds"] = max(most["fds"], daemon.fd_count())

    def __enter__(self):
        self.thread.start()

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()


def stages(bench, count):
    """Each trigger's record has the daemon's times, the PLC its own; both are of one clock."""
    records = bench.ground.folder / "records"
    daemon = bench.daemon("stages", more=f"""[records]
folder = "records"
last = 10000
picture = false
""")
    trips_path = bench.options.output / "stages_trips.csv"
    figures = bench.plc(daemon, count, pause_us=15_000, trips=trips_path)
    daemon.end()
    assert "failure" not in figures, figures
    kept = {}
    for path in records.glob("record-*.json"):
        record = json.loads(path.read_text())
        kept[record["number"]] = record
    with open(trips_path, encoding="ascii") as file:
        trips = [{k: int(v) for k, v in row.items()} for row in csv.DictReader(file)]
    return stage_rows([(trip, kept[trip["number"]]) for trip in trips if trip["number"] in kept]), figures


def under_faults(bench, seconds):
    """Every fault beside one and the same daemon."""
    daemon = bench.daemon("faults")
    rows = {"none": bench.plc(daemon, 10**9, seconds)}
    for name in FAULTS:
        bench.say(f"fault: {name}")
        with Fault(name, daemon.port):
            time.sleep(0.3)
            rows[name] = bench.plc(daemon, 10**9, seconds)
    rows["afterwards"] = bench.plc(daemon, 10**9, seconds)
    rows["afterwards"]["exit_code"] = daemon.end()
    return rows


def full_disk(bench, seconds):
    """A file that may not grow is what a process without rights can be given for a full disk."""
    daemon = bench.daemon("full", more='[records]\nfolder = "full"\npicture = false\n')
    resource.prlimit(daemon.process.pid, resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))
    row = bench.plc(daemon, 10**9, seconds)
    daemon.end()
    row["log_lines"] = daemon.log.count("no record: ")
    return row


def bad_scans(bench, seconds):
    """Among good ones: cut off, and without a single point. Each costs its own number a pose, and no other."""
    scans = bench.ground.folder / "bad"
    shutil.copytree(bench.ground.folder / "scans", scans, dirs_exist_ok=True)
    whole = (scans / "0-single.pcd").read_bytes()
    (scans / "1a-cut.pcd").write_bytes(whole[:len(whole) // 2])
    head = whole.index(b"DATA binary\n") + len(b"DATA binary\n")
    (scans / "2a-dark.pcd").write_bytes(whole[:head] + b"\x00\x00\xc0\x7f" * ((len(whole) - head) // 4))
    daemon = bench.daemon("bad", scans="bad")
    row = bench.plc(daemon, 10**9, seconds)
    daemon.end()
    return row


def killed(bench, times):
    """kill -9 in mid-search and a start: the number left over is refused, the next is done."""
    row = {"kills": 0, "refused": 0, "done": 0, "sessions": set()}
    for _ in range(times):
        daemon = bench.daemon("killed", more='[records]\nfolder = "killed"\npicture = false\n')
        plc = Plc(daemon.port, bench.registers)
        plc.wait_until_ready()
        session = plc.value("session_id")
        row["sessions"].add(session)
        row["boots"] = plc.value("boot_count")
        assert plc.write(7, session) == 0
        daemon.end(signal.SIGKILL)
        row["kills"] += 1
        daemon = bench.daemon("killed", more='[records]\nfolder = "killed"\npicture = false\n')
        plc = Plc(daemon.port, bench.registers)
        plc.wait_until_ready()
        row["refused"] += plc.trigger(7, session)["refused_number"] == 7
        row["done"] += plc.trigger(8, plc.value("session_id"))["done_number"] == 8
        daemon.end()
    row["sessions"] = len(row["sessions"])
    return row


def machine():
    model = next((line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                  if line.startswith("model name")), "unknown processor")
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], capture_output=True, text=True,
                            check=False).stdout.strip()
    return (f"{model}, {os.cpu_count()} CPUs, Linux {os.uname().release}, load {os.getloadavg()[0]:.1f} before; "
            f"commit {commit}; {time.strftime('%Y-%m-%d %H:%M')}")


def parse():
    parser = argparse.ArgumentParser(prog="./run soak", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="some 30 seconds in all")
    parser.add_argument("--triggers", type=int, metavar="N", help="of the long stretch (100000; quick 500)")
    parser.add_argument("--seconds", type=float, metavar="S", help="of each fault (15; quick 1)")
    parser.add_argument("--poll-us", type=int, default=500, metavar="US", help="between two reads (500)")
    parser.add_argument("--output", type=Path, default=Path("build/bench/soak"), metavar="DIR", help="(build/bench/soak)")
    parser.add_argument("--binaries", type=Path, default=Path("build/bench/bin"), metavar="DIR")
    options = parser.parse_args()
    options.triggers = options.triggers or (500 if options.quick else 100_000)
    options.seconds = options.seconds or (1.0 if options.quick else 15.0)
    options.output.mkdir(parents=True, exist_ok=True)
    return options


def main():
    options = parse()
    head = machine()
    bench = Bench(options)
    results = {"machine": head, "triggers": options.triggers, "poll_us": options.poll_us}
    bench.say(f"{options.triggers} triggers")
    results["soak"] = soak(bench)
    bench.say("the way by stages")
    results["stages"], results["stages_plc"] = stages(bench, min(options.triggers, 200 if options.quick else 3000))
    results["faults"] = under_faults(bench, options.seconds)
    bench.say("fault: full disk, bad scans, kill -9")
    results["faults"]["full disk"] = full_disk(bench, options.seconds)
    results["faults"]["cut and dark scans"] = bad_scans(bench, options.seconds)
    results["killed"] = killed(bench, 2 if options.quick else 20)
    bench.end()
    results["took_s"] = time.time() - bench.start
    (options.output / "results.json").write_text(json.dumps(results, indent=1))
    text, is_sound = write_report(results)
    (options.output / "report.md").write_text(text)
    print(text)
    print(f"{options.output}: report.md, results.json, soak_trips.csv, stages_trips.csv")
    return 0 if is_sound else 1


if __name__ == "__main__":
    sys.exit(main())
