"""Scenes that ask for more than can be computed: one line that names the objects and the step, exit code 1, nothing left
behind; and scenes that are the same in every run."""

import os
import signal
import time
import unittest

import program


def hostile(name):
	return os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes", name + ".lua")


class Limits(program.Case):
	def fail(self, *words, saying):
		"""obsim run WORDS ends with this one line, whoever works."""
		done = program.call("run", *words, "--name", self.name)
		self.assertEqual(done.returncode, 1, done.stderr)
		self.assertRegex(done.stderr, saying)
		self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
		return done.stderr

	@unittest.skipIf(os.environ.get("SANITIZED"), "a budget of 10^8 operations takes minutes with a sanitizer; test_budget has less")
	def test_work(self):
		self.fail(hostile("overworked"), "--duration", ".1", "--isolation", "process",
			saying=r"^obsim: step 1 takes more work .* object 1 \(brick 1\)")
		self.fail(hostile("impacts"), "--duration", ".02", "--narrow", "aabb",
			saying=r"^obsim: step 1 takes more work .* object 1 \(box#1\)")

	def test_crowd(self):
		"""Two hundred thousand spheres in one heap: too many pairs for a step and for a measure, which both hear SIGTERM."""
		run = self.start_universe(hostile("crowd"), "--duration", ".05")
		time.sleep(.5)
		run.send_signal(signal.SIGTERM)
		self.assertEqual(run.wait(program.PATIENCE), 1)
		self.assertNotIn("does not return", run.stderr.read())

	def test_ode(self):
		texts = {self.fail(hostile("ode_gives_up"), "--duration", "1", "--isolation", i, "--workers", w,
				saying=r"^obsim: ODE gave up in step 1 at object 0 \(needle\)")
			for i in ("thread", "process") for w in ("1", "2", "objects")}
		self.assertEqual(len(texts), 1)

	def test_many_substeps(self):
		self.refuse("run", hostile("many_substeps"), "--tolerance", ".1mm", saying="1024 at most")

	def test_address(self):
		self.assertEqual(len({program.report(hostile("address"), "--duration", ".1")["state_hash"] for _ in range(3)}), 1)


unittest.main()
