#!/usr/bin/python3
"""Clients that no server wants, each until it is ended: faults.py NAME PORT."""
import os
import random
import signal
import socket
import struct
import subprocess
import sys
import time

from plc import ends_with_its_maker

ADDRESS = "127.0.0.3"
READ = struct.pack(">HHHBBHH", 7, 0, 6, 1, 4, 100, 90)


def connect(port, timeout=10.0):
    return socket.create_connection(("127.0.0.1", port), timeout=timeout, source_address=(ADDRESS, 0))


def tolerant(work):
    """The server may close, and refuse, whom it likes of these."""
    try:
        work()
    except OSError:
        time.sleep(0.002)


def dribble(port):
    """Ten clients that send a byte now and then."""
    clients = []
    while True:
        while len(clients) < 10:
            clients.append([connect(port), 0])
        for client in list(clients):
            try:
                client[0].send(READ[client[1] % len(READ):][:1])
                client[1] += 1
            except OSError:
                clients.remove(client)
        time.sleep(0.05)


def flood(port):
    """Three that read as fast as they are answered, 20 requests at a time."""
    clients = [connect(port) for _ in range(3)]
    while True:
        for client in clients:
            client.sendall(READ * 20)
        for client in clients:
            for _ in range(20):
                head = receive(client, 7)
                receive(client, struct.unpack(">HHHB", head)[2] - 1)


def receive(client, count):
    data = b""
    while len(data) < count:
        more = client.recv(count - len(data))
        if not more:
            raise ConnectionResetError()
        data += more
    return data


def every_length(port, functions=range(256)):
    """Every function code with every length from 0 to 300. Returns how many frames were sound and how many were answered."""
    sound = answered = 0
    for function in functions:
        client = connect(port)
        stream = b""
        for length in range(2, 255):  # unit and function are two
            stream += struct.pack(">HHHBB", length, 0, length, 1, function) + bytes(length - 2)
        client.sendall(stream)
        for length in range(2, 255):
            transaction, _, size, _ = struct.unpack(">HHHB", receive(client, 7))
            body = receive(client, size - 1)
            sound += 1
            answered += transaction == length and body[0] & 0x7f == function & 0x7f
        client.close()
    for length in [0, 1, *range(255, 301)]:
        client = connect(port)
        client.sendall(struct.pack(">HHHBB", 1, 0, length, 1, 3) + bytes(max(length - 2, 0)))
        sound += 1
        try:
            answered += client.recv(1) == b""  # closed, not answered
        except ConnectionResetError:
            answered += 1
        client.close()
    return sound, answered


def lengths(port):
    while True:
        tolerant(lambda: every_length(port, [random.randrange(256)]))


def every_disconnect(port):
    """Goes away at every byte of a request, politely and not."""
    for request in (READ, struct.pack(">HHHBBHHBH", 8, 0, 9, 1, 16, 0, 1, 2, 0)):
        for cut in range(len(request) + 1):
            for linger in (None, struct.pack("ii", 1, 0)):
                client = connect(port)
                if linger:
                    client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, linger)
                client.send(request[:cut])
                client.close()


def disconnect(port):
    while True:
        tolerant(lambda: every_disconnect(port))


def half_open(port):
    """Fourteen that never say a word, and one that stops in the middle of one."""
    while True:
        clients = []
        for _ in range(14):
            tolerant(lambda: clients.append(connect(port)))
        tolerant(lambda: clients.append(connect(port)) or clients[-1].send(READ[:5]))
        time.sleep(1.5)


def crowd(port):
    """Two hundred attempts at once, over and over."""
    while True:
        sockets = []
        for _ in range(200):
            one = socket.socket()
            one.setblocking(False)
            one.bind((ADDRESS, 0))
            one.connect_ex(("127.0.0.1", port))
            sockets.append(one)
        time.sleep(0.05)
        for one in sockets:
            one.close()


def deaf(port):
    """Asks and never reads the answers."""
    while True:
        clients = []
        for _ in range(5):
            tolerant(lambda: clients.append(connect(port)))
        for client in clients:
            client.setblocking(False)
        end = time.monotonic() + 1.5
        while time.monotonic() < end:
            for client in clients:
                tolerant(lambda c=client: c.send(READ * 50))
            time.sleep(0.001)


def noise(port):
    """Bytes that are no frames, and frames of random bytes."""
    while True:
        client = connect(port)
        for _ in range(20):
            body = random.randbytes(random.randrange(254))
            frame = struct.pack(">HHH", random.randrange(65536), 0, len(body)) + body
            tolerant(lambda f=frame: client.send(f if random.random() < 0.9 else random.randbytes(40)))
        client.close()


def second_master(port):
    """Another address that wants to trigger all the time."""
    while True:
        client = connect(port)
        for number in range(1, 200):
            client.sendall(struct.pack(">HHHBBHH", 1, 0, 6, 1, 6, 0, number))
            if receive(client, 9)[7:] != b"\x86\x06":
                raise SystemExit("a second master was let write")
        client.close()


FAULTS = {f.__name__: f for f in (dribble, flood, lengths, disconnect, half_open, crowd, deaf, noise, second_master)}


class Fault:
    """It goes on beside, in a process of its own."""

    def __init__(self, name, port):
        self.process = subprocess.Popen([sys.executable, "-B", os.path.abspath(__file__), name, str(port)], preexec_fn=ends_with_its_maker)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        had_ended = self.process.poll()
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        assert had_ended is None, f"the fault ended by itself with {had_ended}"


def main():
    name, port = sys.argv[1], int(sys.argv[2])
    while True:
        tolerant(lambda: FAULTS[name](port))


if __name__ == "__main__":
    main()
