"""Scenes that exceed the limits of computation: one line that names the objects and the step, exit code 1, nothing left
behind; and scenes that are the same in every run."""

import json
import os
import resource
import signal
import time
import unittest

import program


def hostile(name):
	return os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes", name + ".lua")


class Limits(program.Case):
	def fail(self, *words, saying):
		"""obsim run WORDS ends with this one line, in each configuration."""
		done = program.call("run", *words, "--name", self.name)
		self.assertEqual(done.returncode, 1, done.stderr)
		self.assertRegex(done.stderr, saying)
		self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
		return done.stderr

	@unittest.skipIf(program.SANITIZED, "a budget of 10^8 operations takes minutes with a sanitizer; test_budget has less")
	def test_work(self):
		self.fail(hostile("overworked"), "--duration", ".1", "--isolation", "process",
			saying=r"^obsim: step 1 takes more work .* object 1 \(brick 1\)")
		self.fail(hostile("busy_scripts"), "--duration", ".02", saying=r"^obsim: step 1 takes more work .* object \d+ \(sphere#\d+\) would need millions of instructions of scripts")

	def test_idle_workers(self):
		"""As many workers are started as objects may exist, however many are asked for."""
		words = program.scene("falling_boxes"), "-D", "n=10", "--duration", ".5"
		one, many = program.report(*words, "--workers", "1"), program.report(*words, "--workers", "4096")
		self.assertEqual((many["state_hash"], many["workers"]), (one["state_hash"], 11 + 64))
		run = self.start_stepping(program.scene("falling_boxes"), "-D", "n=10", "--duration", program.FOR_EVER, "--workers", "500",
			"--isolation", "process")
		self.assertEqual(len(program.simulators(run.pid)), 11 + 64)
		run.terminate()
		run.wait(program.PATIENCE)

	def test_crowd(self):
		"""Two hundred thousand spheres in one heap: too many pairs for a step and for a measure, which both
		react to SIGTERM."""
		run = self.start_universe(hostile("crowd"), "--duration", ".05")
		time.sleep(.5)
		run.send_signal(signal.SIGTERM)
		self.assertEqual(run.wait(program.PATIENCE), 1)
		self.assertNotIn("does not return", run.stderr.read())

	@unittest.skipIf(program.SANITIZED, "a measure of 10^5 pairs takes minutes with a sanitizer")
	def test_too_much_to_measure(self):
		"""Penetration is left out, with one warning, and the rest of the run is there: its series, its
		checkpoint, and its resumption."""
		series, checkpoint = self.path("s.csv"), self.path("c")
		done = program.call("run", hostile("rods"), "--duration", ".05", "--series", series, "--checkpoint", checkpoint, "--json", "-", "--name", self.name)
		self.assertEqual(done.returncode, 0, done.stderr)
		self.assertRegex(done.stderr, r"^obsim: warning: penetration is not measured from here on: step 0: .* alone overlaps 739 others: move them apart\n")
		self.assertEqual(done.stderr.count("warning"), 1, done.stderr)
		report = json.loads(done.stdout)
		for figure in "penetration_max_m", "penetration_mean_m", "worst_penetration_m", "worst_penetration_time_s":
			self.assertIsNone(report[figure], figure)
		self.assertEqual((report["outcome"], report["steps"], report["energy_end"]), ("finished", 3, 0))
		with open(series, encoding="utf-8") as f:
			self.assertEqual([line.split(",")[6] for line in f][1:], 4 * ["nan"])
		done = program.call("run", "--resume", checkpoint, "--duration", ".1", "--json", "-", "--name", self.name)
		self.assertEqual((done.returncode, done.stderr.count("warning")), (0, 0), done.stderr)
		self.assertIsNone(json.loads(done.stdout)["worst_penetration_m"])

	def test_few_descriptors(self):
		"""With any limit of open files: one line, or it runs."""
		ran = set()
		for files in [*range(3, 24), 28, 32, 40]:
			for isolation in ["thread"], ["process"], ["process", "--harden"]:
				done = program.call("run", program.scene("stack"), "--duration", ".05", "--workers", "2", "--isolation", *isolation,
					"--series", self.path("s.csv"), "--trace", self.path("t.json"), "--checkpoint", self.path("c"), "--json", self.path("j"),
					"--name", self.name, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (files, files)))
				if files == 3 and not done.stderr: # the loader cannot open libraries, and prints nothing
					continue
				ran.add((done.returncode, *isolation))
				self.assertIn(done.returncode, (0, 1, 2, 127), (files, done.stderr)) # 127: the loader's
				said = [line for line in done.stderr.split("\n") if line and not line.startswith("obsim: warning: ")]
				self.assertEqual(len(said), 1 if done.returncode else 0, (files, isolation, done.stderr))
				self.assertFalse(done.returncode == 1 and "open files" not in said[0], (files, done.stderr))
		self.assertLessEqual({(c, *i) for c in (0, 1) for i in (["thread"], ["process"], ["process", "--harden"])}, ran)

	def test_nothing_touches(self):
		"""A crash that the sanitizers found."""
		program.report(hostile("no_contacts"), "--duration", ".1")

	def test_many_substeps(self):
		self.refuse("run", hostile("many_substeps"), "--tolerance", ".1mm", saying="1024 at most")

	def test_address(self):
		self.assertEqual(len({program.report(hostile("address"), "--duration", ".1")["state_hash"] for _ in range(3)}), 1)


unittest.main()
