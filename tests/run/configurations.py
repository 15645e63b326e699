"""Tests of a scene that ends in the same bits however it runs."""

import re
import shutil
import subprocess
import unittest

import program

WAYS = program.ways(["--workers", 1], ["--workers", 3, "--check"], ["--isolation", "process", "--workers", 2],
	["--isolation", "process", "--workers", "objects"], ["--isolation", "process", "--workers", 2, "--harden"])


class SameBits:
	"""Beside a Case with the name of a scene's file, FILE, and its text, TEXT, which runs for a second."""

	def setUp(self):
		super().setUp()
		self.scene = self.path(self.FILE)
		self.write(self.TEXT)

	def write(self, text):
		with open(self.scene, "w", encoding="utf-8") as f:
			f.write(text)

	def state(self, *words):
		"""The state at the end."""
		done = program.call("run", *words, "--set", "measure=end")
		found = re.search(r"^  state +([0-9a-f]{16})$", done.stdout, re.MULTILINE)
		self.assertTrue(done.returncode == 0 and found, f"{words}: {done.stdout}{done.stderr}")
		return found.group(1)

	def test_same_bits(self):
		self.assertEqual(len({self.state(self.scene, *way) for way in WAYS}), 1)

	def test_kills(self):
		killed = self.state(self.scene, "--isolation", "process", "--workers", 2, "--fault", "kill:p=.01,seed=5")
		self.assertEqual(killed, self.state(self.scene))

	def test_resume(self):
		kept = self.path("kept.ck")
		self.state(self.scene, "--duration", .5, "--checkpoint", kept)
		self.assertEqual(self.state("--resume", kept, "--duration", 1), self.state(self.scene))

	@unittest.skipUnless(shutil.which("mpirun"), "no mpirun")
	def test_ranks(self):
		done = subprocess.run(["mpirun", "-n", "2", program.OBSIM, "run", self.scene, "--workers", "1", "--set", "measure=end"],
			env=program.RANKS, capture_output=True, text=True, timeout=program.PATIENCE)
		self.assertIn(self.state(self.scene), done.stdout, done.stderr)
