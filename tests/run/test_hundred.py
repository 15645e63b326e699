"""A scene with all that joints, compounds and terrain have ends with one hash in a hundred runs, drawn by chance (the first
argument: how many): threads, processes, hardened ones, 1 to 8 workers or one for each object, ranks, workers that are killed,
runs that are saved and resumed in another configuration."""

import os
import random
import re
import shutil
import subprocess
import sys
import unittest

import program

COUNT = int(sys.argv.pop(1)) if len(sys.argv) > 1 and sys.argv[1].isdigit() else 100
SCENE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes", "robots.lua")
DURATION = 2.5
STATE = re.compile(r"^  state +([0-9a-f]{16})$", re.MULTILINE)


def configuration(chance):
	"""Options of a run."""
	workers = chance.choice([1, 2, 3, 4, 5, 6, 7, 8, "objects"])
	words = ["--workers", workers]
	if chance.random() < .5:
		return words + (["--check"] if chance.random() < .2 else [])
	words += ["--isolation", "process"]
	if chance.random() < .3:
		words.append("--harden")
	if chance.random() < .6:
		words += ["--fault", f"kill:p={chance.choice([.001, .003, .01])},seed={chance.randrange(1000)}"]
	return words


class Hundred(program.Case):
	def state(self, *words):
		done = program.call("run", *words, "--set", "measure=end")
		found = STATE.search(done.stdout)
		self.assertTrue(done.returncode == 0 and found, f"{words}: {done.stdout}{done.stderr}")
		deaths = re.search(r"deaths +(\d+)", done.stdout)
		self.deaths += int(deaths.group(1)) if deaths else 0
		return found.group(1)

	def state_of_ranks(self, ranks, workers):
		done = subprocess.run(["mpirun", "--oversubscribe", "-n", str(ranks), program.OBSIM, "run", SCENE, "--workers", str(workers),
			"--set", "measure=end"], env=program.RANKS, capture_output=True, text=True, timeout=program.PATIENCE)
		found = STATE.search(done.stdout)
		self.assertTrue(done.returncode == 0 and found, f"{ranks} ranks: {done.stdout}{done.stderr}")
		return found.group(1)

	def test_one_hash(self):
		chance, kept, self.deaths = random.Random(34), self.path("kept.ck"), 0
		expected = self.state(SCENE, "--workers", 1)
		for i in range(1, COUNT):
			first, second = configuration(chance), configuration(chance)
			kind = chance.random()
			with self.subTest(run=i, first=first, second=second):
				if kind < .1 and shutil.which("mpirun"):
					found = self.state_of_ranks(chance.choice([2, 3, 4]), chance.choice([1, 2]))
				elif kind < .35:
					self.state(SCENE, *first, "--duration", chance.randrange(1, 149) / 60, "--checkpoint", kept)
					found = self.state("--resume", kept, *second, "--duration", DURATION)
				else:
					found = self.state(SCENE, *first)
				self.assertEqual(found, expected)
		print(f"{COUNT} runs, {self.deaths} workers killed: {expected}")
		self.assertTrue(self.deaths > 0 or COUNT < 20)


unittest.main()
