"""Simulators are killed at random, and the run ends in the same bits as an undisturbed one."""

import json
import random
import time
import unittest

import program

SCENES = {
	"stack": ["--duration", "20"],
	"pyramid": ["--duration", "5"],
	"pile": ["--duration", "3"],
	"falling_boxes": ["-D", "n=60", "--duration", "6"],
}
BLOWS = 4


class Deaths(program.Case):
	def struck(self, words, took):
		"""A run during which simulators die: its report, and the number of kills."""
		run = program.start("run", *words, "--isolation", "process", "--json", "-", "--name", self.name)
		struck = 0
		for _ in range(BLOWS):
			time.sleep(random.uniform(.2, 1) * took / BLOWS)
			victims = program.simulators(run.pid)
			if victims and run.poll() is None:
				struck += program.end(random.choice(victims))
		out, said = run.communicate(timeout=program.PATIENCE)
		self.assertEqual(run.returncode, 0, said)
		report = json.loads(out)
		# a simulator that dies after the last step is not restarted
		restarts = said.count("restarting all simulators from the checkpoint of step")
		self.assertIn(report["deaths"] - restarts, (0, 1), said)
		return report, struck

	def test_same_bits(self):
		random.seed(25)
		dead = 0
		for name, words in SCENES.items():
			words = [program.scene(name), *words, "--set", "sleeping=off", "--set", "measure=end"]
			began = time.time()
			expected = program.report(*words)
			self.assertEqual(expected["deaths"], 0)
			for workers in "2", "objects":
				with self.subTest(scene=name, workers=workers):
					found, struck = self.struck([*words, "--workers", workers], time.time() - began)
					self.assertEqual(found["state_hash"], expected["state_hash"])
					self.assertEqual(found["steps"], expected["steps"])
					self.assertLessEqual(found["deaths"], struck)
					dead += found["deaths"]
		self.assertGreater(dead, len(SCENES))


unittest.main()
