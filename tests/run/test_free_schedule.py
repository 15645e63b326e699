"""obsim run --set record_schedule, replay_schedule: a free run repeats to the bit, in one thread, kills included."""

import os
import random
import struct
import sys
import unittest

import program

HEAD, STEP, STEP_MARK, END_MARK = 368, 48, 0x70657473, 0x2e646e65 # free/schedule.c
RUNS = int(sys.argv.pop()) if sys.argv[-1].isdigit() else 4
SCENE = """
scene { duration = .3 }
ground {}
for i = 1, 4 do box { size = {1, 1, 1}, at = {.1 * (i % 2), 0, i - .5 + .01 * i} } end
sphere { radius = .3, at = {3, 0, 2}, born = .1, velocity = {-9, 0, 0} }
sphere { radius = .3, at = {-2, 0, 1}, dies = .2, velocity = {9, 0, 0} }
box { size = {1, .2, .2}, at = {0, 1.2, .5}, kind = "kinematic", velocity = {0, -1, 0}, spin = {0, 1, 0} }
"""


def digest(data):
	"""FNV-1a (base/hash.h)."""
	out = 0xcbf29ce484222325
	for byte in data:
		out = (out ^ byte) * 0x100000001b3 % 2 ** 64
	return out


class Schedule(program.Case):
	def scene(self):
		path = self.path("scene.lua")
		with open(path, "w") as f:
			f.write(SCENE)
		return path

	def record(self, scene, file, *words):
		return program.report(scene, "--sync", "free", "--set", "coupling=own", "--set", "update_rate=400", "--set", "jitter=.3", "--set", f"record_schedule={file}", *words)

	def test_same_bits(self):
		scene, file, deaths = self.scene(), self.path("s"), 0
		draw = random.Random(1)
		for k in range(RUNS):
			words = ["--seed", k]
			words += draw.choice([[], ["--set", "delay=.004"], ["--set", "max_lag=none"], ["--set", "max_lag=.02"]])
			words += [["--workers", 2], ["--workers", "objects"],
				["--isolation", "process", "--workers", "objects", "--fault", f"kill:p=.002,seed={k}"],
				["--isolation", "process", "--workers", 2, "--fault", f"kill:p=.001,seed={k}"]][k % 4]
			recorded = self.record(scene, file, *words)
			again = program.report(scene, "--set", f"replay_schedule={file}", "--seed", k)
			self.assertEqual(again["state_hash"], recorded["state_hash"], words)
			self.assertEqual((again["workers"], again["coupling"], again["jitter"]), (1, "own", .3))
			deaths += recorded["deaths"]
		self.assertGreater(deaths, 0)

	def test_damaged(self):
		"""Each damage is one error that names the file, before the run begins."""
		scene, file, broken = self.scene(), self.path("s"), self.path("broken")
		self.record(scene, file)
		with open(file, "rb") as f:
			whole = f.read()
		draw = random.Random(2)
		cuts = [whole[:n] for n in (0, 10, 500, len(whole) // 2, len(whole) - 1, len(whole) - 48)]
		flips = [whole[:n] + bytes([whole[n] ^ 1 << draw.randrange(8)]) + whole[n + 1:]
			for n in [0, 9, 20, 100] + [draw.randrange(len(whole)) for _ in range(12)]]
		for damaged in cuts + flips + [whole + b"more", whole[:600] + whole[700:], b"\0" * 4096]:
			with open(broken, "wb") as f:
				f.write(damaged)
			done = program.call("run", scene, "--set", f"replay_schedule={broken}")
			self.assertEqual(done.returncode, 2, done.stderr)
			self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
			self.assertIn(broken, done.stderr)

	def steps(self, data):
		"""Offsets of all steps, and of the end."""
		at, out = HEAD, []
		while at < len(data):
			out.append(at)
			at += STEP + 4 * struct.unpack_from("<I", data, at + 4)[0]
		return out

	def seal(self, data):
		"""Gives the head and all steps their checksums, and the end its place."""
		steps = self.steps(data)
		struct.pack_into("<Q", data, steps[-1] + 16, steps[-1])
		for at in steps:
			struct.pack_into("<Q", data, at + 8, digest(data[at + 16:at + STEP + 4 * struct.unpack_from("<I", data, at + 4)[0]]))
		struct.pack_into("<Q", data, 16, digest(data[24:HEAD]))
		return data

	def refuse(self, scene, file, data, *words):
		"""One line, exit 1 or 2, in bounded memory and without a wait that does not end."""
		with open(file, "wb") as f:
			f.write(data)
		code, error, megabytes = program.peak("run", scene, "--set", f"replay_schedule={file}")
		self.assertIn(code, (1, 2), error)
		self.assertEqual(len(error.strip().split("\n")), 1, error)
		self.assertIn(file, error)
		self.assertLess(megabytes, 400 if not program.SANITIZED else 4000, error)
		for word in words:
			self.assertIn(word, error)

	def test_head(self):
		"""Each bit of the head counts."""
		scene, file = self.scene(), self.path("s")
		self.record(scene, file)
		with open(file, "rb") as f:
			whole = f.read()
		draw = random.Random(5)
		for n in [*range(32), *draw.sample(range(32, HEAD), 24)]:
			self.refuse(scene, file, whole[:n] + bytes([whole[n] ^ 1 << draw.randrange(8)]) + whole[n + 1:])

	def test_order(self):
		"""Steps that are missing, twice there, or in another order do not fit the scene."""
		scene, file = self.scene(), self.path("s")
		self.record(scene, file)
		with open(file, "rb") as f:
			whole = f.read()
		steps, draw = self.steps(whole), random.Random(6)
		def made(order):
			return self.seal(bytearray(whole[:HEAD] + b"".join(whole[steps[k]:steps[k + 1]] for k in order) + whole[steps[-1]:]))
		all_of_them = list(range(len(steps) - 1))
		half, tail = len(all_of_them) // 2, all_of_them[:-1]
		some = [k for k in all_of_them if draw.random() < .9]
		swapped = all_of_them[:half - 30] + all_of_them[half:half + 30] + all_of_them[half - 30:half] + all_of_them[half + 30:]
		shuffled = draw.sample(all_of_them, len(all_of_them))
		one = struct.unpack_from("<I", whole, steps[half] + 32)[0] # all steps of one object are missing
		without = [k for k in all_of_them if struct.unpack_from("<I", whole, steps[k] + 32)[0] != one]
		for order in ([], all_of_them[:1], all_of_them[:half], tail, some, swapped, shuffled, without, all_of_them[::-1]):
			self.refuse(scene, file, made(order), "does not fit the scene")

	def test_hostile(self):
		"""Right checksums around numbers that nobody recorded: one line, or a replay in the same or in other bits."""
		scene, file = self.scene(), self.path("s")
		self.record(scene, file)
		with open(file, "rb") as f:
			whole = f.read()
		steps, draw = self.steps(whole), random.Random(7)
		for _ in range(5 * RUNS):
			data = bytearray(whole)
			for _ in range(draw.choice([1, 1, 3])):
				k = draw.randrange(len(steps) - 1)
				first, end = draw.choice([(24, HEAD - 256), (steps[k] + 16, steps[k + 1])])
				at, size = draw.randrange(first, end - 8) & ~3, draw.choice([4, 8])
				new = draw.choice([0, 1, 2, 7, 255, 2 ** 16, 2 ** 31 - 1, 2 ** 31, 2 ** 32 - 1, 2 ** 63, 2 ** 64 - 1, draw.getrandbits(64)])
				if size == 8 and draw.random() < .3:
					new = struct.unpack("<Q", struct.pack("<d", draw.choice([0., -1., 1e-300, 1e300, float("nan"), float("inf"), .1])))[0]
				data[at:at + size] = struct.pack("<Q", new)[:size]
			with open(file, "wb") as f:
				f.write(self.seal(data))
			code, error, megabytes = program.peak("run", scene, "--set", f"replay_schedule={file}")
			self.assertIn(code, (0, 1, 2), error)
			self.assertLessEqual(len(error.strip().split("\n")), 2, error)
			self.assertLess(megabytes, 400 if not program.SANITIZED else 4000, error)

	def test_claims(self):
		"""Memory is taken for what is there, not for what it says: reads of versions far apart, of all objects."""
		file = self.path("s")
		scene = self.path("many.lua")
		with open(scene, "w") as f:
			f.write("scene { duration = .01 } for i = 1, 4000 do sphere { radius = .1, at = { i, 0, 0 } } end")
		self.record(scene, file)
		with open(file, "rb") as f:
			data = bytearray(f.read()[:HEAD])
		for id in range(4000):
			word = struct.pack("<2I", id, 2 * (65000 + id))
			data += struct.pack("<2IQQd4I", STEP_MARK, 2, 0, 1, .001, id, 1, 0, 0) + word
		data += struct.pack("<2IQQd4I", END_MARK, 0, 0, 0, 0, 0, 0, 0, 0)
		self.refuse(scene, file, self.seal(data), "does not fit the scene")

	def test_forged(self):
		"""A version that nobody published is found, even with a right checksum."""
		scene, file = self.scene(), self.path("s")
		self.record(scene, file)
		with open(file, "rb") as f:
			data = bytearray(f.read())
		for at in self.steps(data):
			if struct.unpack_from("<I", data, at + 36)[0]: # a step that reads
				struct.pack_into("<I", data, at + 52, 0xfffffff0)
				break
		self.refuse(scene, file, self.seal(data), "does not fit the scene")

	def test_refusals(self):
		scene, file = self.scene(), self.path("s")
		self.record(scene, file)
		for words, named in [(["--workers", 2], "workers"), (["--set", "coupling=own"], "coupling"), (["--pace", 1], "pace"),
			(["--isolation", "process"], "isolation"), (["--sync", "lockstep"], "sync free"), (["-D", "n=3"], "n"),
			(["--set", "substeps=3"], "another scene"), (["--duration", 1], "another scene"), (["--seed", 9], "another scene")]:
			done = program.call("run", scene, "--set", f"replay_schedule={file}", *words)
			self.assertEqual((done.returncode, named in done.stderr), (2, True), done.stderr)
		missing = os.path.join(self.path("none"), "s")
		done = program.call("run", scene, "--sync", "free", "--set", "coupling=own", "--set", f"record_schedule={missing}")
		self.assertEqual((done.returncode, "record_schedule" in done.stderr), (2, True), done.stderr)
		done = program.call("run", scene, "--set", f"replay_schedule={missing}")
		self.assertEqual((done.returncode, missing in done.stderr), (2, True), done.stderr)


if __name__ == "__main__":
	unittest.main()
