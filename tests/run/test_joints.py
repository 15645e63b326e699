"""Joined objects end in the same bits in any architecture, after kills and after a resume; what has no joints refuses them."""

import os
import re
import tempfile
import unittest

import program

WAYS = program.ways(["--workers", 1], ["--workers", 3], ["--isolation", "process", "--workers", 2],
	["--isolation", "process", "--workers", "objects"], ["--isolation", "process", "--workers", 2, "--harden"],
	["--check"])


# All kinds of joints, to objects that move as they are told, that die, and that have scripts.
MECHANISMS = """scene { title = "Mechanisms", duration = 2.2 }
ground {}
box { name = "turntable", size = { 1, 1, .2 }, kind = "kinematic", at = { 0, 0, 3 }, spin = { 0, 0, 2 } }
box { name = "arm", size = { 1.5, .1, .1 }, at = { 1.1, 0, 2.8 } }
hinge { "arm", "turntable", at = { .4, 0, 2.85 }, axis = { 0, 1, 0 } }
sphere { name = "tip", radius = .1, at = { 1.9, 0, 2.8 }, dies = 1 }
ball { "tip", "arm", at = { 1.85, 0, 2.8 } }
box { name = "shaker", size = { .3, .3, .3 }, kind = "kinematic", at = { 3, 0, 4 },
	path = { kind = "sine", amplitude = { .5, 0, 0 }, frequency = 1 } }
sphere { name = "bob", radius = .1, at = { 3, 0, 3 }, script = [[ function step(self) self:torque(0, .01, 0) end ]] }
distance { "bob", "shaker" }
box { name = "slide", size = { .2, .2, .2 }, at = { -2, 0, 3 } }
slider { "slide", axis = { 1, 0, -1 } }
box { name = "w1", size = { .2, .2, 1 }, at = { -3, 1, 2 } }
box { name = "w2", size = { 1, .2, .2 }, at = { -2.4, 1, 2.4 } }
fixed { "w1", "w2" }
box { name = "u1", size = { .2, .2, 1 }, at = { -3, -2, 4 } }
box { name = "u2", size = { .2, .2, 1 }, at = { -3, -2, 3 }, spin = { 1, 2, 3 } }
universal { "u1", "u2", at = { -3, -2, 3.5 }, axis = { 1, 0, 0 }, across = { 0, 1, 0 } }
"""


def state(*words):
	done = program.call("run", *words, "--measure", "end")
	found = re.search(r"^  state +([0-9a-f]{16})$", done.stdout, re.MULTILINE)
	if done.returncode or not found:
		raise AssertionError(f"{words}: {done.stdout}{done.stderr}")
	return found.group(1), done.stdout


class Joints(unittest.TestCase):
	# The ball hits the wall in the first second.
	scenes = [[program.scene("wrecking_ball"), "-D", "links=4", "-D", "rows=3", "--duration", 1.4],
		[program.scene("bridge"), "-D", "planks=8", "--duration", 1]]

	def test_same_bits(self):
		for scene in self.scenes:
			self.assertEqual(len({state(*scene, *way)[0] for way in WAYS}), 1, scene)

	def test_mechanisms(self):
		with tempfile.TemporaryDirectory() as folder:
			path = os.path.join(folder, "mechanisms.lua")
			with open(path, "w", encoding="utf-8") as file:
				file.write(MECHANISMS)
			self.assertEqual(len({state(path, *way)[0] for way in WAYS}), 1)

	def test_kills(self):
		scene = self.scenes[0]
		bits, words = state(*scene, "--isolation", "process", "--workers", 2, "--fault", "kill:p=.003,seed=5")
		self.assertRegex(words, r"deaths +[1-9]")
		self.assertEqual(bits, state(*scene)[0])

	def test_resume(self):
		with tempfile.TemporaryDirectory() as folder:
			kept = os.path.join(folder, "kept.ck")
			for scene in self.scenes:
				state(*scene[:-1], .5, "--checkpoint", kept)
				self.assertEqual(state("--resume", kept, *scene[-2:])[0], state(*scene)[0])

	def test_refusals(self):
		for words in (["--arch", "monolith"], ["--sync", "free"], ["--solver", "ghost"], ["--solver", "jacobi"],
			["--integrator", "ode"]):
			done = program.call("run", *self.scenes[0], *words)
			self.assertNotEqual(done.returncode, 0, words)
			self.assertRegex(done.stderr, r"^obsim: \S.* has no joints, as this scene has: take .*\n$")


unittest.main()
