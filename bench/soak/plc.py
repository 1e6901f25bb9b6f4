"""The daemon as a process, and a PLC of raw sockets: for the soak and for the tests of faults."""
import ctypes
import json
import os
import re
import signal
import socket
import struct
import subprocess
import threading
import time

PATIENCE_S = 60

READY, ACK, BUSY, DONE, VALID, ERROR = (1 << i for i in range(6))
LOCATE, NEXT, CAPTURE, LOCATE_IN_LAST, CANCEL, CLEAR_ERROR, VERIFY, SAVE, REPORT, RELOAD = range(1, 11)


def registers_of(flatpose):
    return {r["name"]: r for r in json.loads(subprocess.check_output([flatpose, "map", "--format", "json"]))}


def wait_until(holds, what="it"):
    end = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end, f"{what} never came"
        time.sleep(0.005)


def ends_with_its_maker():
    """Between fork and exec: however the maker ends, nothing of it is left running."""
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


class Daemon:
    def __init__(self, program, config_path, *args):
        self.process = subprocess.Popen([program, "--config", config_path, *args], stderr=subprocess.PIPE, text=True,
                                        preexec_fn=ends_with_its_maker)
        self.log = ""
        for line in self.process.stderr:
            self.log += line
            found = re.search(r"ready: .*Modbus TCP on [0-9.]+:(\d+)", line)
            if found:
                self.port = int(found.group(1))
                break
        else:
            raise AssertionError("flatposed ended: " + self.log)
        self.reader = threading.Thread(target=self.read_log, daemon=True)
        self.reader.start()

    def read_log(self):
        for line in self.process.stderr:
            self.log += line

    def end(self, how=signal.SIGTERM):
        self.process.send_signal(how)
        self.process.wait(timeout=PATIENCE_S)
        self.reader.join(timeout=PATIENCE_S)
        return self.process.returncode

    def rss_kb(self):
        status = open(f"/proc/{self.process.pid}/status", encoding="ascii").read()
        return int(re.search(r"VmRSS:\s+(\d+)", status).group(1))

    def fd_count(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))


class Plc:
    """One connection. Closed() when the other side ends it."""

    class Closed(Exception):
        pass

    def __init__(self, port, registers, own_address="127.0.0.1"):
        self.registers = registers
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S, source_address=(own_address, 0))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.transaction = 0
        self.result = registers["map_version"]["address"]
        self.result_words = registers["done_number_tail"]["address"] + 1 - self.result

    def close(self):
        self.socket.close()

    def receive(self, count):
        data = b""
        while len(data) < count:
            try:
                more = self.socket.recv(count - len(data))
            except ConnectionError as error:
                raise Plc.Closed() from error
            if not more:
                raise Plc.Closed()
            data += more
        return data

    def send(self, pdu):
        self.transaction = self.transaction % 65535 + 1
        try:
            self.socket.sendall(struct.pack(">HHHB", self.transaction, 0, len(pdu) + 1, 1) + pdu)
        except ConnectionError as error:
            raise Plc.Closed() from error

    def answer(self):
        transaction, _, length, _ = struct.unpack(">HHHB", self.receive(7))
        assert transaction == self.transaction
        return self.receive(length - 1)

    def ask(self, pdu):
        self.send(pdu)
        return self.answer()

    def read(self, address, count):
        answer = self.ask(struct.pack(">BHH", 4, address, count))
        assert answer[0] == 4, answer
        return answer[2:]

    def value(self, name, data=None):
        """Of the register, by itself or out of a block read before."""
        entry = self.registers[name]
        at = 2 * (entry["address"] - self.result)
        raw = self.read(entry["address"], entry["words"]) if data is None else data[at:at + 2 * entry["words"]]
        return struct.unpack(">" + {"uint16": "H", "int16": "h", "uint32": "I", "int32": "i", "float32": "f"}[entry["type"]],
                             raw)[0]

    def block(self):
        data = self.read(self.result, self.result_words)
        assert self.value("done_number", data) == self.value("done_number_tail", data), "torn"
        return Block(self, data)

    def write(self, *words):
        """Registers from 0 on. Returns the exception's code, 0: granted."""
        answer = self.ask(struct.pack(">BHHB", 16, 0, len(words), 2 * len(words)) + struct.pack(f">{len(words)}H", *words))
        return answer[1] if answer[0] & 0x80 else 0

    def write_one(self, name, value):
        answer = self.ask(struct.pack(">BHH", 6, self.registers[name]["address"], value))
        return answer[1] if answer[0] & 0x80 else 0

    def wait_until_ready(self):
        wait_until(lambda: self.value("bits") & READY, "READY")

    def trigger(self, number, session=0, command=LOCATE, job=1):
        assert self.write(number, session, command, job) == 0
        return self.wait_for(number)

    def wait_for(self, number):
        end = time.monotonic() + PATIENCE_S
        while True:
            block = self.block()
            if block["done_number"] == number or block["refused_number"] == number:
                return block
            assert time.monotonic() < end, f"number {number} got no answer"
            time.sleep(0.002)


class Block:
    def __init__(self, plc, data):
        self.plc, self.data = plc, data

    def __getitem__(self, name):
        return self.plc.value(name, self.data)


class GoodPlc(threading.Thread):
    """Triggers all the time, as one that nobody disturbs. Every number is done, once, on a connection that stays."""

    def __init__(self, port, registers, first=1):
        super().__init__(daemon=True)
        self.plc = Plc(port, registers)
        self.plc.wait_until_ready()
        self.number, self.answered, self.failure = first, 0, None
        self.is_over = threading.Event()
        self.start()

    def run(self):
        try:
            before = None
            while not self.is_over.is_set():
                block = self.plc.trigger(self.number)
                assert block["done_number"] == self.number, f"{self.number} was refused: {block['refused_status']}"
                scans = block["scan_number"]
                if scans != 0:  # else the scan could not be read
                    assert before is None or scans == before + 1, f"scan {scans} after {before}"
                    before = scans
                else:
                    before = None if before is None else before + 1
                self.answered += 1
                self.number = self.number % 65535 + 1
        except BaseException as failure:  # told by end()
            self.failure = failure

    def more(self, count):
        """Waits until so many more were answered."""
        wanted = self.answered + count
        wait_until(lambda: self.answered >= wanted or self.failure, "an answer")
        self.check()

    def check(self):
        if self.failure:
            raise AssertionError(f"the well-behaved PLC: {self.failure!r}") from self.failure

    def end(self):
        self.is_over.set()
        self.join(timeout=PATIENCE_S)
        self.check()
        self.plc.close()
        return self.answered
