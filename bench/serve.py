#!/usr/bin/env python3
"""How a served universe fares with many viewers: bench/serve.py OBSIM [--viewers 50] [--objects 1000] [--seconds 60].

All viewers are this one program. Staleness is how much later, for its simulated time, a message comes than the soonest of the
second around it; so it counts the server's interval, the way, and what this program and the stepping are late themselves.
Prints one line a figure.
"""
import argparse
import json
import os
import pathlib
import selectors
import socket
import struct
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOTIONS, VOID = 1, 1


class Viewer:
    def __init__(self, port, selector):
        self.socket = socket.create_connection(('127.0.0.1', port))
        self.socket.sendall((f'GET /universe HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n'
                             'Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\nSec-WebSocket-Version: 13\r\n'
                             'Sec-WebSocket-Protocol: obsim\r\n\r\n').encode())
        self.buffer = bytearray()
        while b'\r\n\r\n' not in self.buffer:
            self.buffer += self.socket.recv(1)
        self.buffer.clear()
        self.socket.setblocking(False)
        selector.register(self.socket, selectors.EVENT_READ, self)
        self.whole, self.bytes, self.came, self.created, self.removed = b'', 0, [], 0, 0

    def read(self):
        data = self.socket.recv(1 << 20)
        now = time.monotonic()
        self.bytes += len(data)
        self.buffer += data
        while len(self.buffer) >= 2:
            n, head = self.buffer[1], 2
            if n == 126:
                head = 4
            elif n == 127:
                head = 10
            if len(self.buffer) < head:
                return
            n = int.from_bytes(self.buffer[2:head], 'big') if head > 2 else n
            if len(self.buffer) < head + n:
                return
            first, self.whole = self.buffer[0], self.whole + bytes(self.buffer[head:head + n])
            del self.buffer[:head + n]
            if first & 0x80:
                if self.whole[:1] == bytes([MOTIONS]):
                    flags, _, simulated, removed, created, _ = struct.unpack_from('<xB2xfdIII', self.whole)
                    self.created += 0 if flags & VOID else created
                    self.removed += removed
                    self.came.append((now, simulated))
                self.whole = b''


def serve(obsim, objects):
    run = subprocess.Popen([obsim, 'serve', str(ROOT / 'scenes/gas.lua'), '-D', f'n={objects}', '--listen', '127.0.0.1:0'],
                           stdout=subprocess.PIPE, text=True)
    return run, int(run.stdout.readline().rstrip().rstrip('/').rsplit(':', 1)[1])


def cpu(pid):
    with open(f'/proc/{pid}/stat') as f:
        words = f.read().rpartition(')')[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf('SC_CLK_TCK')


def send(viewer, **command):
    data = json.dumps(command).encode()
    viewer.socket.sendall(bytes([0x81, 0x80 | 126]) + struct.pack('>H', len(data)) + bytes(4) + data)


def watch(obsim, viewers, objects, seconds):
    run, port = serve(obsim, objects)
    selector = selectors.DefaultSelector()
    all_ = [Viewer(port, selector) for _ in range(viewers)]
    begin = time.monotonic()
    before, made = cpu(run.pid), 0
    first = None
    while time.monotonic() - begin < seconds:
        for key, _ in selector.select(.1):
            key.data.read()
        if viewers and time.monotonic() - begin > .05 * made and made < 20 * (seconds - 2):
            send(all_[made % viewers], do='create', shape='sphere', size=[.1, 0, 0], at=[0, 0, 0], mass=1, name=f'new {made}')
            made += 1
        if first is None:
            first = [v.bytes for v in all_]
    spent = cpu(run.pid) - before
    simulated = max((v.came[-1][1] - v.came[0][1] for v in all_ if v.came), default=seconds)
    run.terminate()
    run.wait()
    return all_, spent, simulated, first, made


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('obsim')
    parser.add_argument('--viewers', type=int, default=50)
    parser.add_argument('--objects', type=int, default=1000)
    parser.add_argument('--seconds', type=float, default=60)
    a = parser.parse_args()
    alone = watch(a.obsim, 1, a.objects, a.seconds / 3)
    all_, spent, simulated, first, made = watch(a.obsim, a.viewers, a.objects, a.seconds)
    late = []
    soonest = {}
    for v in all_:
        for now, t in v.came:
            soonest[int(now)] = min(soonest.get(int(now), 1e9), now - t)
    for v in all_:
        late += [now - t - min(soonest.get(int(now) + k, 1e9) for k in (-1, 0, 1)) for now, t in v.came]
    late.sort()
    traffic = sum(v.bytes - f for v, f in zip(all_, first)) / len(all_) / a.objects / a.seconds
    print(f'staleness_ms p50 {1e3 * late[len(late) // 2]:.1f} p99 {1e3 * late[int(.99 * len(late))]:.1f} max {1e3 * late[-1]:.1f}')
    print(f'bytes_per_object_and_second {traffic:.0f} (poses of 28 bytes at 60 Hz: 1680)')
    print(f'created {made}, seen by all: {all(v.created == made for v in all_)}')
    print(f'simulated_per_second one viewer {alone[2] / (a.seconds / 3):.3f}, {a.viewers} viewers {simulated / a.seconds:.3f}')
    print(f'cpu_s_per_second one viewer {alone[1] / (a.seconds / 3):.3f}, {a.viewers} viewers {spent / a.seconds:.3f}')


if __name__ == '__main__':
    main()
