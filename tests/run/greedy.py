"""Greedy visitors: each asks for more than a universe can compute, by all that its role permits.

A visit is a served scene, a greedy visitor of each role, and an innocent one, who creates and removes a ball far away, again
and again.
"""

import itertools
import os
import random
import re
import select
import struct
import threading
import time

import program
from server import OPEN, Viewer

ROLES = ("watch", "take part", "operate")
SIZES = ([.3, .3, .3], [1, 1, .002], [.002, .002, 5], [9, 9, .1], [20, 20, 20])
MOTIONS = ({"mass": 1}, {"mass": 1e-12}, {"mass": 1e12}, {"mass": 1, "velocity": [9e4, 0, 0]}, {"mass": 1e3, "velocity": [0, 0, -3e3]},
	{"mass": 1, "spin": [0, 900, 0]}, {"mass": 1e-12, "spin": [9000, 0, 0]}, {"mass": 1e12, "velocity": [300, 300, 0]},
	{"mass": 1, "restitution": 1, "velocity": [0, 500, -500]}, {"mass": 1e6, "friction": 1e3, "spin": [50, 50, 50]})
FAR = 5e4 # m: place of the innocent one


def kinds():
	"""Returns 200 kinds of objects: slender and huge, light and heavy, fast and spinning."""
	for shape, size, motion in itertools.product(("box", "sphere", "capsule", "cylinder"), SIZES, MOTIONS):
		used = {"sphere": 1, "box": 3}.get(shape, 2)
		# a ball takes the least extent, a rod the least and the largest
		yield {"shape": shape, "size": ([min(size)] if used == 1 else [min(size), max(size)] if used == 2 else size) + [0] * (3 - used), **motion}


def piles():
	"""Returns a few kinds, each many times, that have ended universes."""
	yield from [{"shape": "box", "size": [.3, .3, .3], "mass": 1}] * 40
	yield from [{"shape": "box", "size": [.3, .3, .3], "mass": mass} for mass in (1e12, 1e-12)] * 43
	yield from [{"shape": "box", "size": [4.5, 4.5, .05], "mass": 100}] * 40


class Greedy(threading.Thread):
	"""One visitor, who asks for these objects once, or again and again until told to stop."""

	def __init__(self, port, token, role, seed, objects, again):
		super().__init__(daemon=True)
		self.role, self.random, self.objects, self.again, self.stop = role, random.Random(seed), objects, again, threading.Event()
		self.viewer = Viewer(port, path="/universe?token=" + token)
		self.viewer.until(lambda: "welcome" in self.viewer.told and any("p" in o for o in self.viewer.objects.values()))
		moving = [o["p"] for o in self.viewer.objects.values() if "p" in o and not o["static"]]
		self.place = self.random.choice(moving) if moving else (0, 0, 1)
		self.sent = 0

	def send(self, **command):
		self.viewer.send(**command)
		self.sent += 1

	def drain(self, seconds):
		"""Reads all that comes in this time."""
		end = time.monotonic() + seconds
		while (left := end - time.monotonic()) > 0:
			if select.select([self.viewer.socket], [], [], left)[0]:
				self.viewer.receive()

	def meddle(self):
		"""Anything that the page can send about an object that exists, or about the run."""
		r, objects = self.random, self.viewer.objects
		i = r.choice(list(objects))
		to, high = {"id": i, "generation": objects[i]["generation"]}, lambda size: [r.uniform(-size, size) for _ in range(3)]
		self.send(**r.choice([{"do": "drag", "target": high(1e4), **to}, {"do": "push", "force": high(1e6), **to},
			{"do": "turn", "torque": high(1e6), **to}, {"do": "message", "text": "walk 1 0 " * r.randrange(1, 20), **to},
			{"do": "remove", **to}, {"do": "release"}, {"do": "inspect", "id": i}, {"do": "anew"}, {"do": "contacts", "on": True}]))
		if self.role == "operate":
			self.send(**r.choice([{"do": "edit", "velocity": high(9e4), **to}, {"do": "edit", "at": list(self.place), **to},
				{"do": "edit", "spin": high(5e3), **to}, {"do": "kick", "impulse": high(1e6), **to}, {"do": "edit", "friction": 1e3, **to},
				{"do": "edit", "force": high(1e6), **to}, {"do": "rate", "rate": 1}, {"do": "pause"}, {"do": "resume"},
				{"do": "keep"}, {"do": "kill", **to}, {"do": "step", "steps": 3}]))
			self.send(do="resume")

	def run(self):
		"""Raises nothing: a universe that ends is seen by its exit code."""
		try:
			for kind in itertools.cycle(self.objects) if self.again else self.objects:
				if self.stop.is_set():
					return
				self.send(do="create", at=list(self.place), name="greedy", **kind)
				if self.random.randrange(3) == 0:
					self.meddle()
				self.drain(.026) # 40 objects a second
		except (EOFError, OSError, struct.error):
			pass


def innocent(port, token, run, waits):
	"""Adds what each of its wishes took to waits, until the server ends: seconds, and CPU seconds of the server."""
	v = Viewer(port, path="/universe?token=" + token)
	v.until(lambda: "welcome" in v.told)
	for n in itertools.count():
		name = f"innocent {n}"
		mine = lambda: [i for i, o in v.objects.items() if o["name"] == name]
		for wanted in 1, 0:
			began = time.monotonic(), cpu_of(run.pid)
			if wanted:
				v.send(do="create", shape="sphere", size=[.1, 0, 0], mass=1, at=[FAR, FAR, 100 + n], name=name)
			elif mine():
				v.send(do="remove", id=mine()[0], generation=v.objects[mine()[0]]["generation"])
			try:
				while len(mine()) != wanted:
					v.receive()
			finally:
				waits.append((time.monotonic() - began[0], max(0, cpu_of(run.pid) - began[1])))
		time.sleep(.05)


def cpu_of(pid):
	"""CPU seconds of a process and its descendants so far, of those that have ended, too; 0: it has ended."""
	parents, used = {}, {}
	for name in filter(str.isdigit, os.listdir("/proc")):
		try:
			with open(f"/proc/{name}/stat") as f:
				words = f.read().rpartition(")")[2].split()
		except OSError: # it has ended meanwhile
			continue
		parents[int(name)], used[int(name)] = int(words[1]), sum(map(int, words[11:15])) # its children's that have ended, too
	own, before = {pid} & used.keys(), None
	while own != before:
		before, own = own, own | {child for child, parent in parents.items() if parent in own}
	return sum(used[i] for i in own) / os.sysconf("SC_CLK_TCK")


def tokens(run):
	"""Port, and token of each role, of a server that listens at all addresses."""
	where, _, token = run.stdout.readline().rsplit(" ", 1)[1].strip().partition("#token=")
	found = {"operate": token}
	for _ in range(2):
		role, url = run.stdout.readline().split(": ")
		found[role.removeprefix("To ")] = url.strip().rpartition("=")[2]
	return int(where.rstrip("/").rsplit(":", 1)[1]), found


class Visit:
	"""Serves a scene to greedy visitors, and to an innocent one, for some seconds, or until all objects were asked for once."""

	def __init__(self, scene, *words, roles=ROLES, objects=None, seconds=None, seed=1):
		self.run = program.start("serve", scene, "--listen", "0.0.0.0:0", "--name", f"greedy-{os.getpid()}-{seed}", *words)
		self.err, self.waits = [], []
		port, token = tokens(self.run)
		said = threading.Thread(target=lambda: self.err.extend(self.run.stderr), daemon=True)
		said.start()
		greedy = [Greedy(port, token[role], role, seed, list(objects or [*kinds(), *piles()]), seconds) for role in roles]
		other = threading.Thread(target=self.watch, args=(port, token["take part"]), daemon=True)
		for thread in [*greedy, other]:
			thread.start()
		if seconds:
			end = time.monotonic() + seconds
			while time.monotonic() < end and self.run.poll() is None:
				time.sleep(.1)
		for thread in greedy:
			thread.stop.set() if seconds else None
			thread.join(program.PATIENCE)
		self.alive = self.run.poll() is None
		self.sent = sum(g.sent for g in greedy)
		self.run.terminate()
		self.code = self.run.wait(program.PATIENCE)
		other.join(10)
		said.join(program.PATIENCE)
		for file in (self.run.stdout, self.run.stderr, *(g.viewer.socket for g in greedy)):
			file.close()
		self.frozen = sum(1 + (int(more[1]) if (more := re.search(r"frozen: .* and (\d+) more", line)) else 2 * line.count(", object"))
			for line in self.err if "; frozen: " in line)

	def watch(self, port, token):
		try:
			innocent(port, token, self.run, self.waits)
		except (EOFError, OSError, struct.error):
			pass
