"""One scene ends in the same bits, whatever runs it: threads or processes, any number of workers. One scene a test
program (the first argument), so that each has its own limit on time."""

import sys
import unittest

import program

SCENES = {
	"falling_boxes": ["-D", "n=100", "--duration", "2.5"],
	"stack": ["--duration", "2"],
	"pile": ["--duration", "1"],
	"cradle": ["--duration", "1.5"],
	"sparse": ["--duration", "2"],
	"shapes": ["--duration", "2"],
	"machines": ["--duration", "1.5"],
	"solids": ["--duration", "1.5"],
}
if program.SANITIZED: # the same questions of fewer bodies
	SCENES["falling_boxes"] = ["-D", "n=50", "--duration", "2.5"]
	SCENES["pile"] = ["-D", "n=4", "--duration", "1"]
NAME = sys.argv.pop(1)


class SameBits(program.Case):
	def hash_of(self, *words):
		"""Hash of all states, and the largest estimate of an error, which the motions carry."""
		found = program.report(program.scene(NAME), *SCENES[NAME], "--set", "measure=end", *words)
		self.assertEqual(found["outcome"], "finished")
		self.assertRegex(found["state_hash"], "^[0-9a-f]{16}$")
		return found["state_hash"], found["deviation_reached"]

	def test_everywhere(self):
		expected = self.hash_of("--workers", "1")
		for isolation in "thread", "process":
			for workers in program.ways("2", "1", "3", "8", "objects"):
				with self.subTest(isolation=isolation, workers=workers):
					self.assertEqual(self.hash_of("--isolation", isolation, "--workers", workers), expected)

	def test_contained(self):
		expected = self.hash_of("--workers", "1")
		for workers in program.ways("2", "1", "3", "objects"):
			with self.subTest(workers=workers):
				found = self.hash_of("--isolation", "process", "--harden", "--workers", workers)
				self.assertEqual(found, expected)

	def test_other_bits(self):
		"""The hash sees a change: another step length is another run."""
		self.assertNotEqual(self.hash_of("--workers", "1"), self.hash_of("--workers", "1", "--step", "1/61"))

	def test_looking_changes_nothing(self):
		words = [program.scene(NAME), *SCENES[NAME]]
		self.assertEqual(program.report(*words, "--set", "measure=step")["state_hash"], self.hash_of()[0])

	def test_verified(self):
		"""The fine solutions of --set verify=on leave no trace, and the sample is the same everywhere."""
		expected, errors = self.hash_of("--workers", "1"), set()
		for isolation, words in ("thread", ["--workers", "1"]), ("thread", ["--workers", "3"]), ("process", ["--harden", "--workers", "2"]):
			found = program.report(program.scene(NAME), *SCENES[NAME], "--set", "verify=on", "--set", "measure=end", "--isolation", isolation, *words)
			self.assertEqual((found["state_hash"], found["deviation_reached"]), expected)
			errors.add((found["verified_steps"], found["verified_p50_m"], found["verified_max_m"], found["verified_second_max_m"]))
		self.assertEqual(len(errors), 1)

	def test_jacobi(self):
		expected = self.hash_of("--set", "solver=jacobi", "--workers", "1")
		for isolation, workers in ("thread", "3"), ("process", "2"), ("process", "objects"):
			with self.subTest(isolation=isolation, workers=workers):
				found = self.hash_of("--set", "solver=jacobi", "--isolation", isolation, "--workers", workers)
				self.assertEqual(found, expected)


unittest.main()
