"""Faults that must cost nothing: beside each, a well-behaved PLC has every number answered once, on a connection that stays.

faults_test.py FLATPOSED FLATPOSE FOLDER_OF_SHARED_MODULES FOLDER_OF_THE_EXAMPLE'S_FILES CASE
"""
import json
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

FLATPOSED, FLATPOSE, SHARED, EXAMPLE, CASE = sys.argv[1:]
sys.path.insert(0, SHARED)

from faults import FAULTS, Fault, every_disconnect, every_length  # noqa: E402
from plc import ACK, BUSY, CANCEL, DONE, READY, VALID, Daemon, GoodPlc, Plc, registers_of, wait_until  # noqa: E402

OK, NO_MATCH, SCAN_POOR, CANCELLED, NO_SCAN, ANSWER_LATE = 0, -1, -3, -4, -5, -13
NOT_OWNER_EXCEPTION = 6
STALE_SESSION = 6
QUICK, SLOW = 1, 2
TRIES = 10

REGISTERS = registers_of(FLATPOSE)
FOLDER = Path(tempfile.mkdtemp(prefix="flatpose-faults-"))


def scan(name, scene="single", columns=160, rows=133):
    path = FOLDER / name
    path.parent.mkdir(exist_ok=True)
    subprocess.run([FLATPOSE, "simulate", scene, "--seed", "1", "--cols", str(columns), "--rows", str(rows), "-o", str(path),
                    "--truth", str(FOLDER / "truth.json")], check=True, stdout=subprocess.DEVNULL)
    return path


def config(source, modbus="", more="", frame=""):
    """Job 1 is quick; job 2 searches for the same part eight times, so that there is a middle of a search."""
    parts = "".join(f'[[part]]\nname = "p{i}"\nfile = "{EXAMPLE}/pad.fpt"\n' for i in range(8))
    names = ", ".join(f'"p{i}"' for i in range(8))
    path = FOLDER / "f.toml"
    path.write_text(f"""[modbus]
bind = "127.0.0.1"
port = 0
{modbus}
[source]
allow_simulated = true
{source}
[search]
scan_width_px = 400
scan_height_px = 333
cell_count = 600_000
{parts}[[job]]
parts = ["p0"]
{frame}
[[job]]
number = 2
parts = [{names}]
max_matches = 32
{frame}
{more}""")
    return str(path)


def replay(path):
    return f'replay = "{path}"'


def example():
    return replay(f"{EXAMPLE}/scan.pcd")


def ends_well(daemon):
    assert daemon.end() == 0, daemon.log


def in_mid_search(plc, number, session=0):
    """Triggers the slow job until it is seen at work; returns the number that runs. What was done before that is done."""
    for i in range(TRIES):
        assert plc.write(number + i, session, 1, SLOW) == 0
        if plc.value("bits") & BUSY:
            return number + i
        plc.wait_for(number + i)
    raise AssertionError("no search was seen at work")


def clients():
    daemon = Daemon(FLATPOSED, config(replay(scan("small.pcd"))))
    good = GoodPlc(daemon.port, REGISTERS)
    good.more(5)
    usual_fds = daemon.fd_count()
    for name in FAULTS:
        with Fault(name, daemon.port):
            time.sleep(0.4)  # until it is at its work
            good.more(10)
        print(name, "answered so far:", good.answered)
    sound, answered = every_length(daemon.port)
    assert sound == 256 * 253 + 48 and answered == sound, (sound, answered)
    every_disconnect(daemon.port)
    good.more(5)
    assert good.end() > 100
    wait_until(lambda: daemon.fd_count() <= usual_fds, "the usual number of descriptors")
    ends_well(daemon)


def restarts():
    records = '[records]\nfolder = "records"\npicture = false\n'
    file = config(example(), more=records)
    daemon = Daemon(FLATPOSED, file)
    plc = Plc(daemon.port, REGISTERS)
    plc.wait_until_ready()
    session = plc.value("session_id")
    assert plc.value("boot_count") == 1

    # The PLC restarts in mid-search: what it asked for is answered, and its old number does nothing again.
    number = in_mid_search(plc, 10)
    scans = plc.value("scan_number")
    plc.close()
    plc = Plc(daemon.port, REGISTERS)
    block = plc.wait_for(number)
    assert block["done_number"] == number and block["result_is_readers"] == 1
    scans = block["scan_number"]
    assert plc.value("last_number") == number
    assert plc.write(number, session, 1, SLOW) == 0
    assert plc.value("scan_number") == scans and plc.value("done_number") == number
    assert plc.trigger(number + 1, session)["scan_number"] == scans + 1

    # Another connection of the same address takes over at once, in mid-search too; the old one, heard no more, stays shut out.
    number = in_mid_search(plc, 100, session)
    other = Plc(daemon.port, REGISTERS)
    assert other.write(number + 50, session, CANCEL, 1) == 0
    assert other.wait_for(number + 50)["cancelled_number"] == number
    # Another address may read, and is refused writes by exception 6.
    stranger = Plc(daemon.port, REGISTERS, "127.0.0.2")
    assert stranger.write(1) == NOT_OWNER_EXCEPTION
    assert stranger.block()["done_number"] == number + 50

    # Killed in mid-search.
    number = in_mid_search(other, 200, session)
    daemon.end(signal.SIGKILL)
    daemon = Daemon(FLATPOSED, file)
    plc = Plc(daemon.port, REGISTERS)
    plc.wait_until_ready()
    assert plc.value("session_id") != session
    assert plc.value("boot_count") == 2
    assert plc.block()["done_number"] == 0 and not plc.value("bits") & VALID
    block = plc.trigger(number, session, 1, SLOW)
    assert block["refused_number"] == number and block["refused_status"] == STALE_SESSION
    assert plc.block()["scan_number"] == 0
    block = plc.trigger(number + 1, plc.value("session_id"))
    assert block["done_number"] == number + 1 and block["scan_number"] == 1 and block["bits"] & VALID
    assert not [p for p in (FOLDER / "records").iterdir() if p.name.startswith(".")], "something half-written was left"
    ends_well(daemon)


def scans():
    """One that is cut off, one without a point, one that is no scan: each costs its own number a pose. And one that never comes."""
    whole = scan("scans/0-whole.pcd").read_bytes()
    head = whole.index(b"DATA binary\n") + len(b"DATA binary\n")
    (FOLDER / "scans/1-cut.pcd").write_bytes(whole[:len(whole) // 2])
    (FOLDER / "scans/2-whole.pcd").write_bytes(whole)
    (FOLDER / "scans/3-dark.pcd").write_bytes(whole[:head] + b"\x00\x00\xc0\x7f" * ((len(whole) - head) // 4))
    (FOLDER / "scans/4-whole.pcd").write_bytes(whole)
    (FOLDER / "scans/5-none.pcd").write_bytes(b"")
    daemon = Daemon(FLATPOSED, config(replay(FOLDER / "scans")))
    plc = Plc(daemon.port, REGISTERS)
    plc.wait_until_ready()
    first = None
    for number in range(1, 13):
        block = plc.trigger(number)
        wanted = [OK, NO_SCAN, OK, SCAN_POOR, OK, NO_SCAN][(number - 1) % 6]
        assert block["done_number"] == number and block["status"] == wanted, (number, block["status"])
        assert bool(block["bits"] & VALID) == (wanted == OK)
        assert (block["position_x"] == -2**31) == (wanted != OK), number
        if wanted == OK:
            first = first or block["position_x"]
            assert block["position_x"] == first
    ends_well(daemon)
    assert daemon.log.count("1-cut.pcd") == 2 and daemon.log.count("5-none.pcd") == 2, daemon.log

    (FOLDER / "watched").mkdir()
    daemon = Daemon(FLATPOSED, config(f'watch = "{FOLDER}/watched"', frame="answer_by_ms = 300"))
    plc = Plc(daemon.port, REGISTERS)
    plc.wait_until_ready()
    for number in range(1, 4):
        block = plc.trigger(number)
        assert block["done_number"] == number and block["status"] == ANSWER_LATE and not block["bits"] & VALID
    assert plc.trigger(9, command=CANCEL)["status"] == OK
    ends_well(daemon)


def handshake():
    """Four phases by bits alone, in frame `work`; then a master that falls silent in mid-search."""
    work = FOLDER / "work.json"
    subprocess.run([FLATPOSE, "align", f"{EXAMPLE}/scan.pcd", "-o", str(work)], check=True, stdout=subprocess.DEVNULL)
    frame = f'frame = "work"\nwork = "{work}"'
    daemon = Daemon(FLATPOSED, config(example(), 'handshake = "bits"', frame=frame))
    plc = Plc(daemon.port, REGISTERS)
    plc.wait_until_ready()
    is_up = lambda bit: lambda: bool(plc.value("bits") & bit)
    is_down = lambda bit: lambda: not plc.value("bits") & bit
    control = lambda bits: plc.write_one("control", bits)
    assert control(0) == 0
    assert plc.write_one("command_number", 5) == 3, "a number must not trigger beside the bits"
    for cycle in range(1, 4):
        assert control(1) == 0  # TRIGGER up
        wait_until(is_up(ACK), "ACK")
        assert control(0) == 0  # TRIGGER down
        wait_until(is_down(ACK), "the fall of ACK")
        wait_until(is_up(DONE), "DONE")
        block = plc.block()
        assert block["status"] == OK and block["scan_number"] == cycle and block["frame"] == 1 and block["bits"] & VALID
        assert not block["bits"] & READY, "the result is not read yet"
        assert control(2) == 0  # RESULT_READ up
        wait_until(is_down(DONE), "the fall of DONE")
        assert control(0) == 0
        wait_until(is_up(READY), "READY")
    ends_well(daemon)
    located = subprocess.run([FLATPOSE, "locate", f"{EXAMPLE}/pad.fpt", f"{EXAMPLE}/scan.pcd", "--work", str(work), "--json"],
                             capture_output=True, text=True, check=True)
    wanted_mm = json.loads(located.stdout)["matches"][0]["position_mm"]
    for name, value in zip(("position_x", "position_y", "position_z"), wanted_mm):
        assert abs(block[name] * 0.001 - value) <= 0.000501, name

    daemon = Daemon(FLATPOSED, config(example(), "lease_ms = 100"))
    for i in range(TRIES):
        silent = Plc(daemon.port, REGISTERS)
        silent.wait_until_ready()
        assert silent.write(i + 1, 0, 1, SLOW) == 0
        watcher = Plc(daemon.port, REGISTERS, "127.0.0.2")
        status = watcher.wait_for(i + 1)["status"]
        assert status in (OK, CANCELLED), status
        assert watcher.value("owner_address") in (0, 0x7f000001)
        if status == CANCELLED:
            break
    assert status == CANCELLED, "no search outlived the lease"
    wait_until(lambda: watcher.value("owner_address") == 0, "the end of the lease")
    block = watcher.trigger(1)  # whoever comes now is the owner
    assert block["done_number"] == 1 and block["bits"] & VALID and block["owner_address"] == 0x7f000002
    ends_well(daemon)


if __name__ == "__main__":
    try:
        {f.__name__: f for f in (clients, restarts, scans, handshake)}[CASE]()
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)  # a daemon of a failed case may still write there
    print("nothing was lost")
