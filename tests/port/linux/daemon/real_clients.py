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


class Daemon:
    """The example's config as it stands, but for word order, port and who may connect."""

    def __init__(self, program, example, word_order, files):
        text = open(example, encoding="utf-8").read()
        for old, new in (('word_order = "ABCD"', f'word_order = "{word_order}"'), ('bind = "0.0.0.0"', 'bind = "127.0.0.1"'),
                         ("../../../build/example", files)):
            assert old in text, old
            text = text.replace(old, new)
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


def main():
    flatposed, flatpose, example, files, client_name, word_order = sys.argv[1:]
    registers = {r["name"]: r for r in json.loads(subprocess.check_output([flatpose, "map", "--format", "json"]))}
    # The example's job asks for so many.
    expected = json.loads(subprocess.check_output(
        [flatpose, "locate", files + "/pad.fpt", files + "/scan.pcd", "--json", "--max-matches", "8"]))
    assert expected["status"] == "ok", expected
    daemon = Daemon(flatposed, example, word_order, files)
    try:
        client = {"pymodbus": Pymodbus, "mbpoll": Mbpoll}[client_name](daemon.port, registers, word_order)
        check(client, registers, expected)
        client.end()
    finally:
        daemon.end()
    print("agreed")


main()
