"""mbpoll and pymodbus drive the daemon over loopback, in a dry run, and read the pose that flatpose locate prints.

real_clients.py FLATPOSED FLATPOSE EXAMPLE.toml FOLDER_OF_THE_EXAMPLE'S_FILES CLIENT WORD_ORDER
"""
import json
import math
import re
import subprocess
import sys
import tempfile
import time

PATIENCE_S = 60

# Where the scan lies in the robot's frame: a third of a turn about the diagonal, then moved.
ROBOT_R_SCAN = [0, 0, 1, 1, 0, 0, 0, 1, 0]
ROBOT_T_SCAN_MM = [812.5, -240.25, 655.0]


def times(a, b):
    """Of two matrices by rows."""
    return [sum(a[3 * i + k] * b[3 * k + j] for k in range(3)) for i in range(3) for j in range(3)]


def about(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {"x": [1, 0, 0, 0, c, -s, 0, s, c], "y": [c, 0, s, 0, 1, 0, -s, 0, c], "z": [c, -s, 0, s, c, 0, 0, 0, 1]}[axis]


def by_angles(axes, angles):
    result = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    for axis, angle in zip(axes, angles):
        result = times(result, about(axis, angle))
    return result


def by_quaternion(w, x, y, z):
    return [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
            2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
            2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]


def by_vector(x, y, z):
    angle = math.sqrt(x * x + y * y + z * z)
    if angle == 0:
        return by_quaternion(1, 0, 0, 0)
    s = math.sin(angle / 2) / angle
    return by_quaternion(math.cos(angle / 2), s * x, s * y, s * z)


# As the controllers' manuals have it: what a robot would make of the four numbers.
CONVENTIONS = {
    "kuka_abc": lambda n: by_angles("zyx", n[:3]),
    "fanuc_wpr": lambda n: by_angles("zyx", n[2::-1]),
    "ur_rotation_vector": lambda n: by_vector(*n[:3]),
    "abb_quaternion": lambda n: by_quaternion(*n),
    "staubli_xyz": lambda n: by_angles("xyz", n[:3]),
    "zyz": lambda n: by_angles("zyz", n[:3]),
}
OF_ANGLES = {"kuka_abc", "fanuc_wpr", "staubli_xyz", "zyz"}


class Frames:
    """Files of the work plane and of the robot's frame, a job for each frame and convention, and what each must tell."""

    def __init__(self, flatpose, files, folder):
        self.work, self.robot, pairs = folder + "/work.json", folder + "/robot.json", folder + "/pairs.csv"
        run = lambda *words: subprocess.check_output([flatpose, *words])
        run("align", files + "/scan.pcd", "-o", self.work)
        with open(pairs, "w", encoding="ascii") as file:
            file.write("scan_x,scan_y,scan_z,robot_x,robot_y,robot_z\n")
            for p in ([0, 0, 0], [100, 0, 20], [0, 120, -10], [-80, -90, 40], [60, 70, 80]):
                file.write(",".join(repr(float(c)) for c in p + self.to_robot(p)) + "\n")
        run("align", "--touch", pairs, "-o", self.robot)
        locate = lambda *more: json.loads(run("locate", files + "/pad.fpt", files + "/scan.pcd", "--json", *more))["matches"][0]
        scan, work = locate(), locate("--work", self.work)
        self.poses = {"scan": (scan["position_mm"], scan["rotation"]), "work": (work["position_mm"], work["rotation"]),
                      "robot": (self.to_robot(scan["position_mm"]), times(ROBOT_R_SCAN, scan["rotation"]))}
        self.jobs = {10 + i: (frame, convention)
                     for i, (frame, convention) in enumerate((f, c) for f in self.poses for c in CONVENTIONS)}

    @staticmethod
    def to_robot(p):
        return [sum(ROBOT_R_SCAN[3 * i + k] * p[k] for k in range(3)) + ROBOT_T_SCAN_MM[i] for i in range(3)]

    def config(self):
        named = {"scan": "", "work": f'work = "{self.work}"\n', "robot": f'alignment = "{self.robot}"\n'}
        return "".join(f'[[job]]\nnumber = {number}\nparts = ["pad"]\nframe = "{frame}"\npose = "object"\n'
                       f'convention = "{convention}"\n{named[frame]}' for number, (frame, convention) in self.jobs.items())


class Daemon:
    """The example's config as it stands, but for word order, port and who may connect, and with more jobs."""

    def __init__(self, program, example, word_order, files, jobs):
        text = open(example, encoding="utf-8").read()
        for old, new in (('word_order = "ABCD"', f'word_order = "{word_order}"'), ('bind = "0.0.0.0"', 'bind = "127.0.0.1"'),
                         ("../../../build/example", files)):
            assert old in text, old
            text = text.replace(old, new)
        assert "\n[search]" in text
        text = text.replace("\n[search]", "\n" + jobs + "\n[search]", 1)
        self.config = tempfile.NamedTemporaryFile("w", suffix=".toml", encoding="utf-8")
        self.config.write(text)
        self.config.flush()
        self.process = subprocess.Popen([program, "--config", self.config.name, "--modbus-port", "0"],
                                        stderr=subprocess.PIPE, text=True)
        log = ""
        for line in self.process.stderr:
            log += line
            found = re.search(r"ready: .*Modbus TCP on [0-9.]+:(\d+)", line)
            if found:
                self.port = int(found.group(1))
                return
        raise AssertionError("flatposed ended: " + log)

    def end(self):
        self.process.terminate()
        self.process.communicate(timeout=PATIENCE_S)
        assert self.process.returncode == 0, self.process.returncode


class Pymodbus:
    def __init__(self, port, registers, word_order):
        from pymodbus.client import ModbusTcpClient
        from pymodbus.constants import Endian
        from pymodbus.payload import BinaryPayloadDecoder
        self.client = ModbusTcpClient("127.0.0.1", port=port, timeout=PATIENCE_S)
        assert self.client.connect()
        self.registers = registers
        self.decoder = lambda words: BinaryPayloadDecoder.fromRegisters(
            words, byteorder=Endian.Big if word_order in ("ABCD", "CDAB") else Endian.Little,
            wordorder=Endian.Big if word_order in ("ABCD", "BADC") else Endian.Little)

    def read(self, name):
        entry = self.registers[name]
        # Results are readable by both functions alike.
        for function in (self.client.read_input_registers, self.client.read_holding_registers):
            answer = function(entry["address"], entry["words"], slave=1)
            assert not answer.isError(), answer
            words = answer.registers
        if entry["type"] in ("uint16", "int16"):
            return words[0] if entry["type"] == "uint16" else (words[0] ^ 0x8000) - 0x8000
        decode = {"uint32": "decode_32bit_uint", "int32": "decode_32bit_int", "float32": "decode_32bit_float"}
        return getattr(self.decoder(words), decode[entry["type"]])()

    def write(self, name, value):
        answer = self.client.write_register(self.registers[name]["address"], value, slave=1)
        assert not answer.isError(), answer

    def end(self):
        self.client.close()


class Mbpoll:
    """Opens, speaks once and closes, each time. It knows ABCD (-B) and CDAB."""

    def __init__(self, port, registers, word_order):
        self.common = ["mbpoll", "-m", "tcp", "-p", str(port), "-0", "-1", "-q", "-o", "10"]
        self.order = ["-B"] if word_order == "ABCD" else []
        self.registers = registers

    def run(self, args):
        done = subprocess.run(self.common + args, capture_output=True, text=True, timeout=PATIENCE_S)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def read(self, name):
        entry = self.registers[name]
        kind = {"uint16": "4", "int16": "4", "uint32": "4:int", "int32": "4:int", "float32": "4:float"}[entry["type"]]
        out = self.run(["-t", kind, *self.order, "-r", str(entry["address"]), "-c", "1", "127.0.0.1"])
        number = re.search(r"\[%d\]:\s+(\S+)(?: \((-\d+)\))?" % entry["address"], out)
        assert number, out
        if entry["type"] == "float32":
            return float(number.group(1))
        return int(number.group(2) if entry["type"] == "int16" and number.group(2) else number.group(1))

    def write(self, name, value):
        self.run(["-t", "4", "-r", str(self.registers[name]["address"]), "127.0.0.1", str(value)])

    def end(self):
        pass


def wait_until(holds):
    end = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end, "it never came"
        time.sleep(0.02)


def kuka_degrees(m):
    """A, B, C of R = Rz(A) Ry(B) Rx(C), m by rows."""
    return [math.degrees(math.atan2(m[3], m[0])), math.degrees(math.asin(-m[6])), math.degrees(math.atan2(m[7], m[8]))]


def check(client, registers, expected):
    assert client.read("test_uint16") == 0x1234
    assert client.read("test_uint32") == 0x12345678
    assert client.read("test_float32") == 123456.0
    wait_until(lambda: client.read("bits") & 1)
    assert client.read("position_x") == -2**31
    assert math.isnan(client.read("position_x_f"))

    client.write("command_number", 21)
    wait_until(lambda: client.read("done_number") == 21)
    assert client.read("status") == 0
    assert client.read("match_count") == len(expected["matches"])
    assert client.read("bits") & 0x40, "SIMULATED"
    match = expected["matches"][0]
    wanted = dict(zip(("position_x", "position_y", "position_z"), match["position_mm"]))
    wanted.update(zip(("rotation_1", "rotation_2", "rotation_3"), kuka_degrees(match["rotation"])))
    wanted["score"] = match["score"]
    for name, value in wanted.items():
        scale = registers[name]["scale"]
        assert abs(client.read(name) * scale - value) <= 0.501 * scale, name
        assert abs(client.read(name + "_f") - value) <= 1e-6 * max(1.0, abs(value)) * 10, name + "_f"


def six_digits(value):
    """What mbpoll prints of a float."""
    return 1e-5 * max(1.0, abs(value))


def check_frames(client, frames, reads_floats):
    """Every frame in every convention: what a robot makes of the numbers is where the part lies."""
    number = 40
    for job, (frame, convention) in frames.jobs.items():
        number += 1
        client.write("job", job)
        client.write("command_number", number)
        wait_until(lambda: client.read("done_number") == number)
        assert client.read("status") == 0 and client.read("result_job") == job
        position_mm, rotation = frames.poses[frame]
        for axis, wanted in zip("xyz", position_mm):
            assert abs(client.read("position_" + axis) * 0.001 - wanted) <= 0.000501 + 1e-6, (frame, axis)
            if not reads_floats:
                continue
            assert abs(client.read(f"position_{axis}_f") - wanted) <= six_digits(wanted), (frame, axis)
        scale = 0.001 if convention in OF_ANGLES else 1e-6
        numbers = [client.read(f"rotation_{i}") * scale for i in (1, 2, 3, 4)]
        floats = [client.read(f"rotation_{i}_f") for i in (1, 2, 3, 4)] if reads_floats else numbers
        for i in range(3 + (convention == "abb_quaternion")):
            assert abs(numbers[i] - floats[i]) <= 0.51 * scale + six_digits(floats[i]), (frame, convention, i)
        turned = CONVENTIONS[convention](numbers)
        assert max(abs(a - b) for a, b in zip(turned, rotation)) <= 5e-5, (frame, convention, turned, rotation)
    assert number == 40 + 3 * 6


def main():
    flatposed, flatpose, example, files, client_name, word_order = sys.argv[1:]
    registers = {r["name"]: r for r in json.loads(subprocess.check_output([flatpose, "map", "--format", "json"]))}
    # The example's job asks for so many.
    expected = json.loads(subprocess.check_output(
        [flatpose, "locate", files + "/pad.fpt", files + "/scan.pcd", "--json", "--max-matches", "8"]))
    assert expected["status"] == "ok", expected
    with tempfile.TemporaryDirectory() as folder:
        drive(flatposed, example, word_order, files, client_name, registers, expected, Frames(flatpose, files, folder))
    print("agreed")


def drive(flatposed, example, word_order, files, client_name, registers, expected, frames):
    daemon = Daemon(flatposed, example, word_order, files, frames.config())
    try:
        client = {"pymodbus": Pymodbus, "mbpoll": Mbpoll}[client_name](daemon.port, registers, word_order)
        check(client, registers, expected)
        check_frames(client, frames, reads_floats=client_name != "mbpoll")  # it takes a process for each
        client.end()
    finally:
        daemon.end()


main()
