"""The paper's experiment as a program: few and short runs, and all results from them."""

import csv
import json
import os
import signal
import subprocess
import time
import unittest

import program

SCENARIOS = ["common", "common_load", "obs", "obs_load", "obs_obb", "common_obb", "pool", "obs_lockstep"]
CLAIMS = ["runtime", "constant", "frames", "cpu", "load", "kept", "obb", "growth"]
VERDICTS = ["holds", "holds_only_if", "does_not_hold", "cannot_be_told"]


class Paper(program.Case):
	def test_usage(self):
		self.refuse("paper", program.scene("stack"), saying="one scene of its own")
		self.refuse("paper", "--objects", "0", saying="1 to 4096")
		self.refuse("paper", "--object", "8", saying="did you mean --objects?")
		self.assertEqual(os.listdir(self.directory.name), [])
		self.refuse("paper", "--quick", "--out", "/dev/null/x", saying="--out /dev/null/x", code=1)

	def test_quick(self):
		out = self.path("deep/out")
		done = program.call("paper", "--quick", "--json", "--objects", "5", "--out", out)
		self.assertEqual(done.returncode, 0, done.stderr)
		self.assertRegex(done.stderr, r"^obsim: \d+ runs, about \d+ s") # said before it begins
		told = json.loads(done.stdout)
		self.assertEqual([c["claim"] for c in told["claims"]], CLAIMS)
		for claim in told["claims"]:
			self.assertIn(claim["verdict"], VERDICTS)
			self.assertEqual(claim["verdict"] == "holds_only_if", claim["only_if"] is not None)
		self.assertEqual(list(told["means"]), SCENARIOS)

		runs = told["runs"]
		self.assertEqual([r["failed"] for r in runs if r["failed"]], [])
		experiments = [r for r in runs if r["series"] == "experiment"]
		self.assertEqual(sorted(r["scenario"] for r in experiments), sorted(2 * SCENARIOS))
		self.assertEqual({r["objects"] for r in experiments}, {5})
		self.assertEqual({r["objects"] for r in runs if r["series"] == "growth"}, {4, 8, 16})
		for run in runs:
			with self.subTest(scenario=run["scenario"], objects=run["objects"]):
				self.check_figures(run)
		self.assertGreater(os.path.getsize(os.path.join(out, "tables.md")), 1000)
		with open(os.path.join(out, "report.html")) as f:
			self.assertLessEqual({"figure-14", "figure-6-obs"}, {c["name"] for c in program.charts(f.read())})
		with open(os.path.join(out, "results.csv"), newline="") as f:
			kept = list(csv.DictReader(f, strict=True))
		self.assertEqual(len(kept), len(runs))
		self.assertEqual({row["seed"] for row in kept if row["series"] == "experiment"}, {"1", "2"})

		# finished runs are not repeated, and one more experiment differs in the seed alone
		again = program.call("paper", "--quick", "--json", "--objects", "5", "--out", out, "--repeats", "3")
		self.assertEqual(again.returncode, 0, again.stderr)
		more = json.loads(again.stdout)["runs"]
		self.assertEqual(len(more), len(runs) + len(SCENARIOS))
		self.assertEqual([r for r in more if r["seed"] < 3 and r in runs], runs)

	def check_figures(self, run):
		"""Checks the relations of the three runtimes, of CPU and of pace that follow from their definitions."""
		simulators = 1 if run["scenario"].startswith("common") else run["objects"]
		self.assertAlmostEqual(run["cpu_per_simulator_s"] * simulators, run["total_cpu_s"], delta=1e-12)
		self.assertGreater(run["total_cpu_s"], 0)
		self.assertGreater(run["step_s"], 0)
		self.assertGreaterEqual(run["total_cpu_s"] * 1.000001, run["busiest_cpu_s"])
		self.assertLessEqual(run["pace"], 1.000001)
		# over the same stretch: CPU by wall time is CPU by simulated time, times the pace
		self.assertAlmostEqual(run["cpu_share"] / (run["cpu_per_simulated_s"] * run["pace"]), 1, delta=1e-6)
		self.assertAlmostEqual(run["cpu_per_simulated_s"] / (60 * run["total_cpu_s"]), 1, delta=1e-6)
		self.assertGreater(run["memory_bytes"], 1e5)
		if run["fps"] is not None:
			self.assertEqual(run["series"], "experiment")
			self.assertGreater(run["fps"], 0)
			self.assertGreater(run["viewer_cpu_share"], 0)

	def test_interrupt(self):
		run = subprocess.Popen([program.OBSIM, "paper", "--out", self.path("out")], stdout=subprocess.PIPE,
			stderr=subprocess.PIPE, text=True)
		self.addCleanup(lambda: (run.poll() is None and run.kill(), run.wait(), run.stdout.close(), run.stderr.close()))
		self.assertTrue(program.wait_until(lambda: len(program.processes(run.pid)) > 1))
		below = program.processes(run.pid)
		time.sleep(.3)
		run.send_signal(signal.SIGTERM)
		_, said = run.communicate(timeout=program.PATIENCE)
		self.assertEqual(run.returncode, 1)
		self.assertRegex(said, r"obsim: interrupted: \d+ of \d+ runs are done, and the same command goes on from there\n$")
		self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))))
		self.assertFalse(os.path.exists(program.segment(f"obsim-{below[0]}")))


unittest.main()
