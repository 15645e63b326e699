"""Joined objects end in the same bits in any architecture, after kills and after a resume; what has no joints refuses them."""

import os
import re
import tempfile
import unittest

import program

WAYS = program.ways(["--workers", 1], ["--workers", 3], ["--isolation", "process", "--workers", 2],
	["--isolation", "process", "--workers", "objects"], ["--isolation", "process", "--workers", 2, "--harden"],
	["--check"])


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
