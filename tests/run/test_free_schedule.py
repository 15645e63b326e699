"""obsim run --record-schedule, --replay-schedule: a free run repeats to the bit, in one thread, kills included."""

import os
import random
import struct
import sys
import unittest

import program

RUNS = int(sys.argv.pop()) if sys.argv[-1].isdigit() else 4
SCENE = """
scene { duration = .3 }
ground {}
for i = 1, 4 do box { size = {1, 1, 1}, at = {.1 * (i % 2), 0, i - .5 + .01 * i} } end
sphere { radius = .3, at = {3, 0, 2}, born = .1, velocity = {-9, 0, 0} }
sphere { radius = .3, at = {-2, 0, 1}, dies = .2, velocity = {9, 0, 0} }
box { size = {1, .2, .2}, at = {0, 1.2, .5}, kind = "kinematic", velocity = {0, -1, 0}, spin = {0, 1, 0} }
"""


class Schedule(program.Case):
	def scene(self):
		path = self.path("scene.lua")
		with open(path, "w") as f:
			f.write(SCENE)
		return path

	def record(self, scene, file, *words):
		return program.report(scene, "--sync", "free", "--update-rate", 400, "--jitter", .3, "--record-schedule", file, *words)

	def test_same_bits(self):
		scene, file, deaths = self.scene(), self.path("s"), 0
		draw = random.Random(1)
		for k in range(RUNS):
			words = ["--coupling", draw.choice(["own", "ledger"]), "--seed", k]
			words += draw.choice([[], ["--delay", .004], ["--max-lag", "none"], ["--max-lag", .02]])
			words += [["--workers", 2], ["--workers", "objects"],
				["--isolation", "process", "--workers", "objects", "--fault", f"kill:p=.002,seed={k}"],
				["--isolation", "process", "--workers", 2, "--fault", f"kill:p=.001,seed={k}"]][k % 4]
			recorded = self.record(scene, file, *words)
			again = program.report(scene, "--replay-schedule", file, "--seed", k)
			self.assertEqual(again["state_hash"], recorded["state_hash"], words)
			self.assertEqual((again["workers"], again["coupling"], again["jitter"]), (1, words[1], .3))
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
			done = program.call("run", scene, "--replay-schedule", broken)
			self.assertEqual(done.returncode, 2, done.stderr)
			self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
			self.assertIn(broken, done.stderr)

	def test_forged(self):
		"""A version that nobody published is found, even with a right checksum: it would take all memory."""
		scene, file = self.scene(), self.path("s")
		self.record(scene, file)
		with open(file, "rb") as f:
			data = bytearray(f.read())
		at = data.index(struct.pack("<I", 0x70657473))
		while struct.unpack_from("<I", data, at + 36)[0] == 0: # a step that reads
			at += 48 + 4 * struct.unpack_from("<I", data, at + 4)[0]
		struct.pack_into("<I", data, at + 52, 0xfffffff0)
		end, digest = at + 48 + 4 * struct.unpack_from("<I", data, at + 4)[0], 0xcbf29ce484222325
		for byte in data[at + 16:end]:
			digest = (digest ^ byte) * 0x100000001b3 % 2 ** 64
		struct.pack_into("<Q", data, at + 8, digest)
		with open(file, "wb") as f:
			f.write(data)
		done = program.call("run", scene, "--replay-schedule", file)
		self.assertEqual((done.returncode, "nobody published" in done.stderr), (2, True), done.stderr)

	def test_refusals(self):
		scene, file = self.scene(), self.path("s")
		self.record(scene, file)
		for words, named in [(["--workers", 2], "workers"), (["--coupling", "own"], "coupling"), (["--pace", 1], "pace"),
			(["--isolation", "process"], "isolation"), (["--sync", "lockstep"], "sync free"), (["-D", "n=3"], "n"),
			(["--substeps", 3], "another scene"), (["--duration", 1], "another scene"), (["--seed", 9], "another scene")]:
			done = program.call("run", scene, "--replay-schedule", file, *words)
			self.assertEqual((done.returncode, named in done.stderr), (2, True), done.stderr)
		missing = os.path.join(self.path("none"), "s")
		done = program.call("run", scene, "--sync", "free", "--record-schedule", missing)
		self.assertEqual((done.returncode, "record-schedule" in done.stderr), (2, True), done.stderr)
		done = program.call("run", scene, "--replay-schedule", missing)
		self.assertEqual((done.returncode, missing in done.stderr), (2, True), done.stderr)


if __name__ == "__main__":
	unittest.main()
