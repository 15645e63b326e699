"""The comparison: five ways, one table, the same bits; and what it says where it cannot."""

import json
import os
import signal
import time
import unittest

import program

SOLO = ["monolith", "threads", "processes", "threads_each", "processes_each"]
OTHER = ["monolith_other", "threads_other"]


class Compare(program.Case):
	def compare(self, *words):
		done = program.call("compare", *words, "--json", self.path("c.json"))
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		with open(self.path("c.json")) as f:
			return done.stdout, json.load(f)

	def test_table(self):
		said, c = self.compare(program.scene("stack"), "-D", "n=5", "--duration", ".5", "--workers", "2", "--repeats", "2")
		for text in "wall per simulated s", "CPU per simulated s", "CPU per body and step", "memory", "start-up", \
			"step, median", "step, 99 %", "critical path", "at the gate", "penetration, worst", "energy, largest gain", \
			"state", "the same bits", "Thread or process?", "boxes along the axes":
			self.assertIn(text, said)
		self.assertLessEqual(max(len(line) for line in said.splitlines() if "  " in line), 120)
		section, = c["sections"]
		self.assertTrue(section["hashes_agree"])
		self.assertEqual(list(section["runs"]), ["monolith", "thread_1", *SOLO[1:], *OTHER])
		self.assertEqual((list(section["skipped"]), section["failed"]), (["threads_2", "process_groups"], {}))
		runs = section["runs"]
		self.assertEqual(len({r["state_hash"] for w in SOLO[1:] for r in runs[w]["samples"]}), 1)
		self.assertEqual([len(runs[w]["samples"]) for w in SOLO], [2] * 5)
		self.assertEqual([runs[w]["samples"][0]["workers"] for w in SOLO[:3]], [1, 2, 2])
		self.assertGreaterEqual(runs["processes_each"]["workers"], 6)
		self.assertEqual({runs[w]["narrow"] for w in OTHER}, {"aabb"})
		for way in SOLO + OTHER:
			figures = runs[way]["figures"]
			# measured along a run of its own, and put in
			for key in "worst_penetration_m", "energy_gain_max", "critical_s_per_step", "switches_per_step":
				self.assertIsNotNone(figures[key]["median"], (way, key))
			cost = figures["cpu_s_per_body_and_step"]
			self.assertLessEqual(cost["low"], cost["median"])
			self.assertLessEqual(cost["median"], cost["high"])
			self.assertGreater(figures["explained"]["low"], .9)
			self.assertLess(figures["explained"]["high"], 1.1)

	def test_json_to_a_pipe(self):
		done = program.call("compare", program.scene("cradle"), "--duration", ".2", "--repeats", "1", "--json", "-")
		self.assertEqual(done.returncode, 0)
		self.assertEqual(len(json.loads(done.stdout)["sections"]), 1)
		self.assertIn("wall per simulated s", done.stderr)

	def test_options_reach_whom_they_concern(self):
		_, c = self.compare(program.scene("stack"), "-D", "n=2", "--duration", ".1", "--solver", "jacobi", "--iterations", "3",
			"--step", "1/120", "--narrow", "aabb", "--load", "5", "--repeats", "1")
		runs = {way: run["samples"][0] for way, run in c["sections"][0]["runs"].items()}
		self.assertEqual({runs[w]["solver"] for w in SOLO[1:]}, {"jacobi"})
		self.assertEqual({runs[w]["iterations"] for w in SOLO}, {3})
		self.assertEqual({runs[w]["steps"] for w in SOLO}, {12})
		self.assertEqual({runs[w]["narrow"] for w in SOLO}, {"aabb"})
		self.assertEqual({runs[w]["narrow"] for w in OTHER}, {"obb"})
		self.assertEqual({r["load"] for r in runs.values()}, {5})

	def test_varied(self):
		said, c = self.compare(program.scene("stack"), "--vary", "n=2,70", "--duration", ".05", "--repeats", "1", "--out",
			self.path("out"))
		self.assertEqual([s["objects"] for s in c["sections"]], [3, 71])
		self.assertIn("process_groups", c["sections"][1]["runs"])
		with open(self.path("out/report.html")) as f:
			page = f.read()
		for text in "Thread or process?", "<svg", "71 objects", "3 objects":
			self.assertIn(text, page)
		self.assertNotIn("{{", page)
		with open(self.path("out/results.csv")) as f:
			lines = f.read().splitlines()
		self.assertEqual(len({line.count(",") for line in lines}), 1)
		for name in "cost-3.svg", "cost-71.png", "latency-71.svg", "growth-71.svg":
			self.assertTrue(os.path.getsize(self.path("out/plots/" + name)) > 500, name)

	def test_too_many_for_one_each(self):
		said, c = self.compare(program.scene("sparse"), "-D", "n=1100", "--duration", ".05", "--repeats", "1")
		self.assertIn("process each: skipped", said)
		self.assertIn("processes_each", c["sections"][0]["skipped"])
		self.assertIn("threads_each", c["sections"][0]["runs"])

	def test_refused(self):
		for words in ["--vary", "n"], ["--vary", "=3"], ["--vary", "n="], ["--repeats", "0"], ["--vary", "nix=3"]:
			done = program.call("compare", program.scene("stack"), *words)
			self.assertEqual(done.returncode, 2, words)
			self.assertTrue(done.stderr.startswith("obsim: "), done.stderr)

	def test_interrupt(self):
		run = program.start("compare", program.scene("falling_boxes"), "-D", "n=50", "--duration", program.FOR_EVER)
		time.sleep(1)
		below = program.processes(run.pid)
		self.assertTrue(below)
		os.kill(run.pid, signal.SIGTERM)
		self.assertEqual(run.wait(program.PATIENCE), 1)
		self.assertIn("interrupted", run.stderr.read())
		run.stdout.close()
		run.stderr.close()
		self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))))

	def test_killed(self):
		run = program.start("compare", program.scene("falling_boxes"), "-D", "n=50", "--duration", program.FOR_EVER)
		time.sleep(1)
		below = program.processes(run.pid)
		run.kill()
		run.wait(program.PATIENCE)
		run.stdout.close()
		run.stderr.close()
		self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))))


unittest.main()
