#!/usr/bin/env python3
"""Load test of a served universe with many viewers: bench/serve.py OBSIM [--viewers 50] [--objects 1000] [--seconds
60]. With --slow N instead: how soon a new viewer is served while N clients send a request a byte a second.

All viewers are this one program. Staleness is the delay of a message, for its simulated time, relative to the fastest
within a second. So it includes the server's interval, the transport, and the lateness of the stepping itself. A message
has arrived when the kernel has it for the viewer. The delay until this program reads it is reported separately, as is
the delay of the last viewer after the first for the same message, which is the server's alone. Prints one line a
figure.

A slow client that is closed comes again at once. A new viewer, twice a second, has been served when the first message
of the universe has arrived whole, from the moment at which it connects.
"""
import argparse
import atexit
import collections
import json
import math
import os
import pathlib
import random
import selectors
import socket
import struct
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOTIONS, VOID = 1, 1
RATE, LIFE = 20, 10  # 1/s: objects that viewers create; s, lifetime until they remove them
SO_TIMESTAMPNS = 35  # Linux; Python has no name for it
CONTINUED, BINARY, TEXT, CLOSE, PING, PONG = 0, 2, 1, 8, 9, 10  # kinds of frames (RFC 6455, 5.2)


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
        self.socket.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self.socket.setblocking(False)
        selector.register(self.socket, selectors.EVENT_READ, self)
        self.whole, self.bytes, self.came, self.news = b'', 0, [], collections.deque()
        self.read_late = []  # s
        self.created = self.removed = self.told_anew = 0

    def read(self):
        data, more, _, _ = self.socket.recvmsg(1 << 20, socket.CMSG_SPACE(16))
        if not data:
            sys.exit('a viewer was dropped, without a reason')
        now = time.time()
        if more:  # arrival of the last bytes
            seconds, nanoseconds = struct.unpack('qq', more[0][2])
            self.read_late.append(now - seconds - 1e-9 * nanoseconds)
            now -= self.read_late[-1]
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
            first, payload = self.buffer[0], bytes(self.buffer[head:head + n])
            del self.buffer[:head + n]
            self.take(first & 0xf, first & 0x80, payload, now)

    def take(self, kind, last, payload, now):
        if kind == PING:
            self.send(PONG, payload)
        elif kind == CLOSE:
            sys.exit(f'a viewer was dropped: {payload[2:].decode(errors="replace")}')
        elif kind in (CONTINUED, TEXT, BINARY):
            self.whole += payload
            if last:
                self.told(now)
                self.whole = b''

    def told(self, now):
        if self.whole.startswith(b'{"error"'):
            sys.exit(f'a viewer was refused something: {self.whole.decode()}')
        if self.whole[:1] == bytes([MOTIONS]):
            flags, _, simulated, removed, created, _ = struct.unpack_from('<xB2xfdIII', self.whole)
            self.came.append((now, simulated))
            if flags & VOID:
                self.told_anew += len(self.came) > 2  # not at the beginning
                return
            self.removed += removed
            self.created += created
            at = 28 + 4 * removed
            for _ in range(created):  # they include no hulls, which are longer
                *new, name = struct.unpack_from('<II2xB', self.whole, at)
                self.news.append(new)
                at += 48 + name

    def send(self, kind, payload):
        n = len(payload)
        size = bytes([0x80 | n]) if n < 126 else bytes([0x80 | 126]) + struct.pack('>H', n)
        self.socket.sendall(bytes([0x80 | kind]) + size + bytes(4) + payload)  # masked by zeros: unchanged


def serve(obsim, objects):
    run = subprocess.Popen([obsim, 'serve', str(ROOT / 'scenes/gas.lua'), '-D', f'n={objects}', '--listen', '127.0.0.1:0'],
                           stdout=subprocess.PIPE, text=True)
    return run, int(run.stdout.readline().rstrip().rstrip('/').rsplit(':', 1)[1])


def cpu(pid):
    """CPU seconds so far, by simulators, the server, the rest of the program, and this one."""
    spent = dict(simulators=0, server=0, rest=0, viewers=time.process_time())
    for thread in pathlib.Path(f'/proc/{pid}/task').iterdir():
        name, _, words = (thread / 'stat').read_text().partition('(')[2].rpartition(')')
        words = words.split()
        whose = 'simulators' if name.startswith('sim ') else 'server' if name == 'server' else 'rest'
        spent[whose] += (int(words[11]) + int(words[12])) / os.sysconf('SC_CLK_TCK')
    return spent


def watch(obsim, viewers, objects, seconds):
    run, port = serve(obsim, objects)
    atexit.register(run.terminate)  # also if a viewer is dropped
    selector = selectors.DefaultSelector()
    all_ = [Viewer(port, selector) for _ in range(viewers)]
    begin = time.monotonic()
    before, made, gone = cpu(run.pid), 0, 0
    seeded = random.Random(1)
    anywhere = lambda most: [seeded.uniform(-most, most) for _ in range(3)]
    first = None
    while time.monotonic() - begin < seconds:
        for key, _ in selector.select(.1):
            key.data.read()
        if time.monotonic() - begin > made / RATE and made < RATE * (seconds - 2):
            v = all_[made % viewers]
            command = dict(do='create', shape='sphere', size=[.1, 0, 0], at=anywhere(5), velocity=anywhere(3), mass=1, name=f'new {made}')
            v.send(TEXT, json.dumps(command).encode())
            made += 1
            if made > RATE * LIFE and len(all_[0].news) > 0:
                id_, generation = all_[0].news.popleft()
                v.send(TEXT, json.dumps(dict(do='remove', id=id_, generation=generation)).encode())
                gone += 1
        if first is None:
            first = [v.bytes for v in all_]
    spent = {whose: (s - before[whose]) / seconds for whose, s in cpu(run.pid).items()}
    simulated = max((v.came[-1][1] - v.came[0][1] for v in all_ if v.came), default=seconds)
    run.terminate()
    run.wait()
    return all_, spent, simulated, first, made, gone


def drip(port, clients, stop):
    """Sends a byte a second of each client's request, all in one thread."""
    request = b'GET /main.js HTTP/1.1\r\nHost: a\r\nX: ' + b'x' * 10000
    held = [None] * clients
    sent = [0] * clients
    while not stop.is_set():
        for i in range(clients):
            try:
                if held[i] is None:
                    held[i], sent[i] = socket.create_connection(('127.0.0.1', port), timeout=60), 0
                    held[i].setblocking(False)
                sent[i] += held[i].send(request[sent[i]:sent[i] + 1])
            except OSError:  # closed, or pushed out: it comes again at its next turn
                held[i] = None
            if stop.wait(1 / clients):
                break
    for s in filter(None, held):
        s.close()


def serve_among_slow(obsim, slow, seconds):
    """Seconds until each new viewer has its first message."""
    run, port = serve(obsim, 20)
    atexit.register(run.terminate)
    stop = threading.Event()
    dripping = threading.Thread(target=drip, args=(port, slow, stop))
    dripping.start()
    waited, end = [], time.monotonic() + 3 + seconds
    time.sleep(3)  # until all have come
    while time.monotonic() < end:
        selector, began = selectors.DefaultSelector(), time.monotonic()
        viewer = Viewer(port, selector)
        while not viewer.came and time.monotonic() - began < 60:
            selector.select(60)
            viewer.read()
        waited.append(time.monotonic() - began)
        viewer.socket.close()
        time.sleep(.5)
    stop.set()
    dripping.join()
    run.terminate()
    run.wait()
    return waited


def print_times(what, seconds):
    ms = sorted(1e3 * s for s in seconds)
    print(f'{what}_ms p50 {ms[len(ms) // 2]:.1f} p99 {ms[int(.99 * len(ms))]:.1f} max {ms[-1]:.1f}')


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('obsim')
    parser.add_argument('--viewers', type=int, default=50)
    parser.add_argument('--objects', type=int, default=1000)
    parser.add_argument('--seconds', type=float, default=60)
    parser.add_argument('--slow', type=int)
    a = parser.parse_args()
    if a.slow is not None:
        print_times(f'served_among_{a.slow}_slow', serve_among_slow(a.obsim, a.slow, a.seconds))
        return
    alone = watch(a.obsim, 1, a.objects, a.seconds / 3)
    all_, spent, simulated, first, made, gone = watch(a.obsim, a.viewers, a.objects, a.seconds)
    soonest, by_time = {}, collections.defaultdict(list)
    for v in all_:
        for now, t in v.came:
            soonest[int(now)] = min(soonest.get(int(now), math.inf), now - t)
            by_time[t].append(now)
    late = [now - t - min(soonest.get(int(now) + k, math.inf) for k in (-1, 0, 1)) for v in all_ for now, t in v.came]
    traffic = sum(v.bytes - f for v, f in zip(all_, first)) / len(all_) / a.objects / a.seconds
    print_times('staleness', late)
    print_times('last_viewer_after_the_first', [max(a) - min(a) for a in by_time.values() if len(a) == len(all_)])
    print_times('read_after_arrival', [s for v in all_ for s in v.read_late])
    print(f'bytes_per_object_and_second {traffic:.0f} (poses of 28 bytes at 60 Hz: 1680)')
    missed = sum(v.created != made or v.removed != gone for v in all_)
    print(f'created {made}, removed {gone}; viewers that missed one {missed}, that were told anew {sum(v.told_anew > 0 for v in all_)}')
    print(f'simulated_per_second one viewer {alone[2] / (a.seconds / 3):.3f}, {a.viewers} viewers {simulated / a.seconds:.3f}')
    for n, spent in (1, alone[1]), (a.viewers, spent):
        print(f'cpu_s_per_second {n} viewer{"s" * (n > 1)}: ' + ', '.join(f'{whose} {s:.3f}' for whose, s in spent.items()))


if __name__ == '__main__':
    main()
