"""The comparison: all configurations, one verdict and one table, the same bits; and its errors."""

import csv
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
			"Latency of a step", "99 %", "critical path", "at the gate", "penetration, worst", "energy, largest gain", \
			"state", "the same bits", "boxes along the axes":
			self.assertIn(text, said)
		self.assertTrue(said.startswith("Thread or process? "), said[:100]) # the verdict comes first
		self.assertLessEqual(max(map(len, said.splitlines())), 100)
		point, = c["points"]
		self.assertTrue(point["hashes_agree"])
		self.assertEqual(list(point["configurations"]), ["monolith", "thread_1", *SOLO[1:], *OTHER])
		self.assertEqual((list(point["skipped"]), point["failed"]), (["threads_2", "process_groups"], {}))
		runs = point["configurations"]
		self.assertEqual(len({r["state_hash"] for w in SOLO[1:] for r in runs[w]["samples"]}), 1)
		self.assertEqual([len(runs[w]["samples"]) for w in SOLO], [2] * 5)
		self.assertEqual([runs[w]["samples"][0]["workers"] for w in SOLO[:3]], [1, 2, 2])
		self.assertGreaterEqual(runs["processes_each"]["workers"], 6)
		self.assertEqual({runs[w]["narrow"] for w in OTHER}, {"aabb"})
		for key in SOLO + OTHER:
			metrics = runs[key]["metrics"]
			# measured along a run of its own, and merged
			for metric in "worst_penetration_m", "energy_gain_max", "critical_s_per_step", "switches_per_step":
				self.assertIsNotNone(metrics[metric]["median"], (key, metric))
			told = key not in ("threads_each", "processes_each")
			self.assertEqual(metrics["speedup_of_16"]["median"] is not None, told, key)
			cost = metrics["cpu_s_per_body_and_step"]
			self.assertLessEqual(cost["low"], cost["median"])
			self.assertLessEqual(cost["median"], cost["high"])
			self.assertGreater(metrics["explained"]["low"], .9)
			self.assertLess(metrics["explained"]["high"], 1.1)

	def test_json_to_a_pipe(self):
		done = program.call("compare", program.scene("cradle"), "--duration", ".2", "--repeats", "1", "--json", "-")
		self.assertEqual(done.returncode, 0)
		point, = json.loads(done.stdout)["points"]
		self.assertIn("wall per simulated s", done.stderr)
		# a single run has no interval
		self.assertNotIn(" to ", done.stderr)
		self.assertNotIn("interval", done.stderr)
		for run in point["configurations"].values():
			self.assertEqual({(m["low"], m["high"]) for m in run["metrics"].values()}, {(None, None)})

	def test_options_reach_whom_they_concern(self):
		_, c = self.compare(program.scene("stack"), "-D", "n=2", "--duration", ".1", "--set", "solver=jacobi", "--set", "iterations=3",
			"--step", "1/120", "--set", "narrow=aabb", "--set", "load=5", "--repeats", "1")
		# each names its command: the same commands, by themselves, show the effect of the options
		commands = {key: run["command"] for key, run in c["points"][0]["configurations"].items()}
		self.assertEqual({run["samples"][0]["steps"] for run in c["points"][0]["configurations"].values()}, {12})
		runs = {key: program.report(*[word for word in commands[key][2:] if word != "--json=-"][:-2], commands[key][-1])
			for key in [*SOLO[:3], *OTHER]}
		self.assertEqual({runs[w]["solver"] for w in SOLO[1:3]}, {"jacobi"})
		self.assertEqual({runs[w]["iterations"] for w in SOLO[:3]}, {3})
		self.assertEqual({runs[w]["steps"] for w in SOLO[:3]}, {12})
		self.assertEqual({runs[w]["narrow"] for w in SOLO[:3]}, {"aabb"})
		self.assertEqual({runs[w]["narrow"] for w in OTHER}, {"obb"})
		self.assertEqual({r["load"] for r in runs.values()}, {5})
		for key, r in runs.items():
			self.assertEqual(r["state_hash"], c["points"][0]["configurations"][key]["samples"][0]["state_hash"])

	def test_varied(self):
		said, c = self.compare(program.scene("stack"), "--vary", "n=2,70", "--duration", ".05", "--repeats", "1", "--out",
			self.path("out"))
		self.assertEqual([p["objects"] for p in c["points"]], [3, 71])
		self.assertIn("process_groups", c["points"][1]["configurations"])
		with open(self.path("out/report.html")) as f:
			page = f.read()
		for text in "Thread or process?", "71 objects", "3 objects":
			self.assertIn(text, page)
		self.assertNotIn("{{", page)
		with open(self.path("out/results.csv")) as f:
			rows = list(csv.DictReader(f))
		self.assertEqual({row["objects"] for row in rows}, {"3", "71"})
		self.assertEqual({row["configuration"] for row in rows if row["renderer_cpu_s_per_simulated_s"] or row["failure"]},
			{key + ", with frames" for key in c["points"][1]["configurations"]})
		self.assertEqual({chart["name"] for chart in program.charts(page)},
			{"cost-n=2", "latency-n=2", "cost-n=70", "latency-n=70", "growth"})

	def rows(self, folder):
		with open(self.path(folder + "/results.csv")) as f:
			return list(csv.DictReader(f))

	def test_resumed(self):
		with open(program.scene("cradle")) as f:
			scene = f.read()
		with open(self.path("own.lua"), "w") as f:
			f.write(scene)
		words = ["compare", self.path("own.lua"), "--duration", ".1", "--workers", "2", "--out", self.path("out")]
		self.assertEqual(program.call(*words, "--repeats", "1").returncode, 0)
		first = self.rows("out")
		self.assertEqual(program.call(*words, "--repeats", "2").returncode, 0)
		second = self.rows("out")
		took = lambda rows: {(r["configuration"], r["repeat"], r["seed"]): r["took_s"] for r in rows}
		self.assertGreater(len(second), len(first))
		self.assertLessEqual(took(first).items(), took(second).items()) # no run was repeated
		self.assertEqual(program.call(*words, "--repeats", "2", "--fresh").returncode, 0)
		third = self.rows("out")
		self.assertEqual(took(third).keys(), took(second).keys())
		self.assertFalse(took(third).items() & took(second).items())
		# a changed scene is another run
		with open(self.path("own.lua"), "a") as f:
			f.write("-- another\n")
		self.assertEqual(program.call(*words, "--repeats", "1").returncode, 0)
		self.assertEqual(len(self.rows("out")), len(third) + len(first))

	def test_seeds(self):
		said, c = self.compare(program.scene("falling_boxes"), "-D", "n=4", "--duration", ".1", "--repeats", "1", "--seeds",
			"3", "--seed", "7")
		point, = c["points"]
		self.assertTrue(point["hashes_agree"])
		for run in point["configurations"].values():
			self.assertEqual([s["seed"] for s in run["samples"]], [7, 8, 9])
			self.assertEqual(len({s["state_hash"] for s in run["samples"]}), 3)
			self.assertEqual(run["metrics"]["worst_penetration_m"]["runs"], 3)
		self.assertIn("1 run of each of 3 seeds", " ".join(said.split()))

	def test_hardened(self):
		said, c = self.compare(program.scene("stack"), "-D", "n=5", "--duration", ".2", "--repeats", "1", "--harden")
		point, = c["points"]
		self.assertTrue(point["hashes_agree"])
		for key in "processes_hardened", "processes_each_hardened":
			self.assertIn("--harden", point["configurations"][key]["command"])
		self.assertIn("hardened pool", said)
		measures = ["outbox", "checksum", "pages", "privileges", "limits", "calls"]
		for measure in measures:
			self.assertIn("--harden=" + measure, point["configurations"]["processes_" + measure]["command"])
		self.assertEqual([*point["prices"]], ["processes_" + m for m in measures] + ["processes_hardened", "processes_each_hardened"])
		for price in point["prices"].values():
			self.assertIn(price["over"], point["configurations"])
			self.assertGreater(price["cpu"]["median"], 0)
			self.assertGreater(price["wall"]["median"], 0)
		self.assertIn("What containment costs", said)

	def test_some_measures(self):
		said, c = self.compare(program.scene("stack"), "-D", "n=5", "--duration", ".2", "--repeats", "1", "--harden=pages,limits")
		self.assertEqual({*c["points"][0]["prices"]}, {"processes_outbox", "processes_pages", "processes_limits", "processes_hardened",
			"processes_each_hardened"})
		self.assertEqual(c["options"], " -D n=5 --duration .2")
		self.assertNotIn("with checksum", said)

	def test_too_many_for_one_each(self):
		said, c = self.compare(program.scene("sparse"), "-D", "n=1100", "--duration", ".05", "--repeats", "1")
		self.assertIn("process each: skipped", said)
		self.assertIn("processes_each", c["points"][0]["skipped"])
		self.assertIn("threads_each", c["points"][0]["configurations"])

	def test_refused(self):
		for words in ["--vary", "n"], ["--vary", "=3"], ["--vary", "n="], ["--repeats", "0"], ["--vary", "nix=3"], ["--seeds", "0"], \
			["--repeats", "50", "--seeds", "2"], ["--fresh"], ["--workers", "objects"], ["--harden=all"]:
			done = program.call("compare", program.scene("stack"), *words)
			self.assertEqual(done.returncode, 2, words)
			self.assertTrue(done.stderr.startswith("obsim: "), done.stderr)

	def test_interrupt(self):
		run = program.start("compare", program.scene("falling_boxes"), "-D", "n=50", "--duration", program.FOR_EVER)
		self.assertTrue(program.wait_until(lambda: program.processes(run.pid)))
		time.sleep(.3)
		below = program.processes(run.pid)
		os.kill(run.pid, signal.SIGTERM)
		self.assertEqual(run.wait(program.PATIENCE), 1)
		said = run.stderr.read()
		self.assertRegex(said, r"obsim: \d+ runs, about ") # before the first run
		self.assertIn("interrupted", said)
		run.stdout.close()
		run.stderr.close()
		self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))))

	def test_killed(self):
		run = program.start("compare", program.scene("falling_boxes"), "-D", "n=50", "--duration", program.FOR_EVER)
		self.assertTrue(program.wait_until(lambda: program.processes(run.pid)))
		time.sleep(.3)
		below = program.processes(run.pid)
		run.kill()
		run.wait(program.PATIENCE)
		run.stdout.close()
		run.stderr.close()
		self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))))


unittest.main()
