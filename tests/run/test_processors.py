"""A scene ends in the same bits on processors with and without fused multiply-add: here, the C library is told not to
use it."""

import os
import subprocess
import sys
import unittest

import program

OTHER = {**os.environ, "GLIBC_TUNABLES": program.OLDER_PROCESSOR}
VALUES = "import math; print([f(.001 * i) for i in range(1, 20000) for f in (math.sin, math.cos, math.exp, math.atan, math.log)])"
RUNS = [
	("falling_boxes", ["-D", "n=100", "--duration", "2"]),
	("sparse", ["--duration", "2"]),
	("cradle", ["--duration", "1"]),
	("shapes", ["--duration", "1"]),
	("solids", ["--duration", "1"]),
	("machines", ["--duration", "2"]),
	("flock", ["--duration", "2"]),
	("shapes", ["--duration", "1", "--arch", "monolith"]),
	("shapes", ["--duration", "1", "--set", "integrator=ode"]),
	(os.path.join(os.path.dirname(__file__), "scenes", "mathematics.lua"), ["--duration", "1"]),
]


def values(environment):
	"""Results of functions of the C library, as called by Python."""
	return subprocess.run([sys.executable, "-c", VALUES], env=environment, check=True, stdout=subprocess.PIPE).stdout


class Processors(program.Case):
	def test_without_fused_operations(self):
		if values(os.environ) == values(OTHER):
			self.skipTest("the C library of this machine has but one way to compute")
		for name, words in RUNS:
			with self.subTest(scene=name, words=words):
				path = name if os.path.isabs(name) else program.scene(name)
				here, there = (program.report(path, *words, "--set", "measure=end", env=environment)["state_hash"]
					for environment in (None, OTHER))
				self.assertEqual(here, there)


unittest.main()
