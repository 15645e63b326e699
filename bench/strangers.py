#!/usr/bin/env python3
"""Viewers that only create and remove objects, pause and go on, must not end the universe of all.

    strangers.py OBSIM [RUNS [SECONDS [SEED [TOGETHER]]]]

Each run serves scenes/falling_boxes.lua (40 boxes, two simulators in processes) with --check and five viewers at a time, for
SECONDS (30). In runs with an odd seed a simulator is also killed about every two seconds. TOGETHER runs (4) share the machine.
The requests of each run are logged and replayed with --check, in one thread: that must come to the same states.

Prints a line for each run: what was asked for, kills, restarts, frozen objects. Exits with 1 if a universe has ended, or if a
replay differs.

    strangers.py OBSIM greedy [SECONDS [SCENE...]]

Greedy visitors instead (tests/run/greedy.py), of each role for SECONDS (60) in each installed scene, or in those named. Prints
how long another visitor has waited for a change, in seconds and in CPU seconds of the server, and how many objects were frozen.
"""

import base64
import concurrent.futures
import json
import os
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

SCENE = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "scenes", "falling_boxes.lua")
VIEWERS = 5
KILL_INTERVAL = 2  # s, on average


class Viewer:
	"""A WebSocket client that reads nothing of what it is sent."""

	def __init__(self, port):
		self.socket = socket.create_connection(("127.0.0.1", port), 5)
		key = base64.b64encode(os.urandom(16)).decode()
		self.socket.sendall((f"GET /universe HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
			f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Protocol: obsim\r\n\r\n").encode())
		answer = self.socket.recv(4096)
		if b" 101 " not in answer.split(b"\r\n")[0]:
			raise OSError(answer[:60])

	def send(self, **command):
		data, mask = json.dumps(command).encode(), os.urandom(4)
		size = bytes([0x80 | len(data)]) if len(data) < 126 else bytes([0xfe]) + struct.pack(">H", len(data))
		self.socket.sendall(b"\x81" + size + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

	def drain(self):
		self.socket.settimeout(.01)
		try:
			while self.socket.recv(1 << 16):
				pass
		except TimeoutError:
			pass


def random_object(r):
	shape = r.choice(["box", "sphere", "capsule", "cylinder"])
	size = [r.uniform(.01, .3), 0 if shape == "sphere" else r.uniform(.01, .3), r.uniform(.01, .3) if shape == "box" else 0]
	return {"shape": shape, "size": size, "at": [r.uniform(-25, 25), r.uniform(-25, 25), r.uniform(.5, 6)],
		"mass": 10 ** r.uniform(-3, 3), "velocity": [r.uniform(-30, 30)] * 3, "friction": r.random(), "restitution": r.random()}


def ask(v, r, count):
	"""One random command."""
	kind = r.randrange(9)
	if kind < 4:
		v.send(do="create", **random_object(r))
		count["create"] += 1
	elif kind < 7:
		v.send(do="remove", id=r.randrange(300), generation=r.randrange(1, 6))
		count["remove"] += 1
	elif kind == 7:
		v.send(do="pause")
		v.send(do="resume")
	else:
		v.send(do="contacts", on=bool(r.randrange(2)))


def visit(port, r, stop, count):
	"""Connects again and again, until told to stop."""
	while not stop.is_set():
		try:
			v = Viewer(port)
			count["connections"] += 1
			end = time.monotonic() + r.choice([0, .05, .5, 2])
			while time.monotonic() < end and not stop.is_set():
				ask(v, r, count)
				time.sleep(.01)
				v.drain()
			v.socket.close()
		except OSError:
			time.sleep(.02)


def simulators(host):
	"""Ids of the host's simulators: children of its fork server."""
	def children(pid):
		try:
			with open(f"/proc/{pid}/task/{pid}/children") as f:
				return [int(word) for word in f.read().split()]
		except OSError:
			return []
	return [child for server in children(host) for child in children(server)]


def watch(run, seconds, r, count):
	"""Lets the universe live for so long; r: kills simulators on the way."""
	end, next_kill = time.monotonic() + seconds, time.monotonic() + KILL_INTERVAL
	while time.monotonic() < end and run.poll() is None:
		time.sleep(.1)
		living = simulators(run.pid) if r and time.monotonic() > next_kill else []
		if living:
			os.kill(r.choice(living), signal.SIGKILL)
			count["kills"] += 1
			next_kill = time.monotonic() + r.uniform(0, 2 * KILL_INTERVAL)
	return run.poll() is None


def replay(obsim, log):
	"""What a replay of the requests differs in; "": in nothing."""
	done = subprocess.run([obsim, "run", SCENE, "-D", "n=40", "--workers", "1", "--check", "--replay-requests", log],
		stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
	return "" if done.returncode == 0 else f"replayed with {done.returncode}: " + "\n".join(done.stderr.splitlines()[-3:])


def live(obsim, seconds, seed):
	"""One run. Returns whether its universe was alive at the end and is replayed, and what is to be said of it."""
	count, stop = dict.fromkeys(("connections", "create", "remove", "kills"), 0), threading.Event()
	with tempfile.TemporaryFile("w+") as errors, tempfile.TemporaryDirectory() as folder:
		log = os.path.join(folder, "asked")
		run = subprocess.Popen([obsim, "serve", SCENE, "-D", "n=40", "--isolation", "process", "--workers", "2", "--check",
			"--listen", "127.0.0.1:0", "--log-requests", log], stdout=subprocess.PIPE, stderr=errors, text=True)
		port = int(re.search(r":(\d+)/", run.stdout.readline())[1])
		viewers = [threading.Thread(target=visit, args=(port, random.Random(seed * 1000 + i), stop, count)) for i in range(VIEWERS)]
		for v in viewers:
			v.start()
		alive = watch(run, seconds, random.Random(seed) if seed % 2 else None, count)
		stop.set()
		for v in viewers:
			v.join()
		run.terminate()
		code = run.wait()
		errors.seek(0)
		lines = [line for line in errors.read().splitlines() if "was not added" not in line]
		differs = replay(obsim, log)
	alive = alive and code == 0 and count["create"] > 0
	count["restarts"] = sum("restarting all" in line for line in lines)
	count["freezes"] = sum("; frozen:" in line for line in lines)
	said = f"seed {seed}: {count} " + ("alive" if alive else f"ended with {code}:\n" + "\n".join(lines[-5:]))
	return alive and not differs, said + (", " + differs if differs else ", replayed")


def greedy(obsim, seconds=60, *names):
	"""Greedy visitors in each scene. Returns whether a universe has ended."""
	os.environ.update(OBSIM=obsim, SCENES=os.path.dirname(SCENE))
	sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "tests", "run"))
	import greedy as visitors # pylint: disable=import-outside-toplevel # it reads the environment
	ended = 0
	for name in names or sorted(file[:-4] for file in os.listdir(os.path.dirname(SCENE)) if file.endswith(".lua")):
		for role in visitors.ROLES:
			visit = visitors.Visit(os.path.join(os.path.dirname(SCENE), name + ".lua"), roles=[role], seconds=float(seconds))
			alive = visit.alive and visit.code == 0
			ended += not alive
			wall, cpu = (max(times, default=0) for times in (zip(*visit.waits) if visit.waits else ([], [])))
			print(f"{name}, {role}: {visit.sent} sent, {visit.frozen} frozen, {len(visit.waits)} waits of up to {wall:.2f} s, "
				f"{cpu:.2f} s of CPU; {'alive' if alive else 'ended with %d: %s' % (visit.code, visit.err[-1:])}", flush=True)
	return ended > 0


def main():
	if sys.argv[2:3] == ["greedy"]:
		return greedy(sys.argv[1], *sys.argv[3:])
	obsim, runs, seconds, seed, together = (sys.argv[1:] + [None] * 5)[:5]
	runs, seconds, seed, together = int(runs or 8), float(seconds or 30), int(seed or 1), int(together or 4)
	ended = 0
	with concurrent.futures.ThreadPoolExecutor(together) as pool:
		for future in concurrent.futures.as_completed([pool.submit(live, obsim, seconds, seed + i) for i in range(runs)]):
			alive, text = future.result()
			ended += not alive
			print(text, flush=True)
	print(f"{runs - ended} of {runs} universes alive and replayed")
	return ended > 0


if __name__ == "__main__":
	sys.exit(main())
