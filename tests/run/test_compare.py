"""The comparison: five ways, one table, the same bits; and what it says where it cannot."""

import json
import os
import signal
import time
import unittest

import program

WAYS = ["monolith", "threads", "processes", "threads_each", "processes_each"]


class Compare(program.Case):
	def test_table(self):
		done = program.call("compare", program.scene("stack"), "-D", "n=5", "--duration", ".5", "--workers", "2", "--json",
			self.path("c.json"))
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		for text in "wall per simulated s", "CPU per simulated s", "CPU per body and step", "memory", "start-up", \
			"step, median", "step, 99 %", "penetration, worst", "energy, largest gain", "state", "the same bits":
			self.assertIn(text, done.stdout)
		self.assertLessEqual(max(map(len, done.stdout.splitlines())), 120)
		with open(self.path("c.json")) as f:
			c = json.load(f)
		self.assertTrue(c["hashes_agree"])
		self.assertEqual((list(c["runs"]), c["skipped"], c["failed"]), (WAYS, {}, {}))
		runs = c["runs"]
		self.assertEqual(len({runs[w]["state_hash"] for w in WAYS[1:]}), 1)
		self.assertNotEqual(runs["monolith"]["state_hash"], runs["threads"]["state_hash"])
		self.assertEqual([runs[w]["workers"] for w in WAYS[:3]], [1, 2, 2])
		self.assertGreaterEqual(runs["processes_each"]["workers"], 6)
		self.assertEqual(runs["monolith"]["substeps"], 1)
		for way in WAYS:
			self.assertEqual(runs[way]["steps"], 30)
			# measured along a run of its own, and put in
			self.assertIsNotNone(runs[way]["worst_penetration_m"], way)
			self.assertIsNotNone(runs[way]["energy_gain_max"], way)

	def test_json_to_a_pipe(self):
		done = program.call("compare", program.scene("cradle"), "--duration", ".2", "--json", "-")
		self.assertEqual(done.returncode, 0)
		self.assertEqual(list(json.loads(done.stdout)["runs"]), WAYS)
		self.assertIn("wall per simulated s", done.stderr)

	def test_options_reach_whom_they_concern(self):
		done = program.call("compare", program.scene("stack"), "-D", "n=2", "--duration", ".1", "--exchange", "jacobi", "--passes",
			"3", "--iterations", "7", "--step", "1/120", "--json", "-")
		self.assertEqual(done.returncode, 0, done.stderr)
		runs = json.loads(done.stdout)["runs"]
		self.assertEqual({runs[w]["exchange"] for w in WAYS[1:]}, {"jacobi"})
		self.assertEqual({runs[w]["passes"] for w in WAYS[1:]}, {3})
		self.assertEqual({runs[w]["steps"] for w in WAYS}, {12})

	def test_too_many_for_one_each(self):
		done = program.call("compare", program.scene("sparse"), "-D", "n=1100", "--duration", ".05", "--json", self.path("c.json"))
		self.assertEqual(done.returncode, 0, done.stderr)
		self.assertIn("process each: skipped", done.stdout)
		with open(self.path("c.json")) as f:
			c = json.load(f)
		self.assertEqual(list(c["skipped"]), ["processes_each"])
		self.assertIn("threads_each", c["runs"])

	def test_interrupt(self):
		run = program.start("compare", program.scene("falling_boxes"), "-D", "n=50", "--duration", "100000")
		time.sleep(1)
		below = program.processes(run.pid)
		self.assertTrue(below)
		os.kill(run.pid, signal.SIGTERM)
		self.assertEqual(run.wait(20), 1)
		self.assertIn("interrupted", run.stderr.read())
		run.stdout.close()
		run.stderr.close()
		self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below)), 1))

	def test_killed(self):
		run = program.start("compare", program.scene("falling_boxes"), "-D", "n=50", "--duration", "100000")
		time.sleep(1)
		below = program.processes(run.pid)
		run.kill()
		run.wait(5)
		run.stdout.close()
		run.stderr.close()
		self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below)), 3))


unittest.main()
