"""Experiments on several ranks, all of them on this machine: the records of one process except for their times, written
and printed by rank 0 alone; and the remains after a rank dies."""

import csv
import json
import os
import signal
import subprocess
import unittest

import program

SMALL = ["lab", "projectile", "head-on", "apexes", "--engines", "obsim,ode-quick", "--sweep", "substeps=1,4", "--repeats", "2"]
LONG = ["lab", "stack-10", "stack-20", "--engines", "obsim,ode-quick", "--sweep", "substeps=1,2,4"]
TIMES = ["cpu_s", "wall_s", "cpu_s_per_body_and_simulated_s", "took_s", "took_cpu_s"]


def command(*groups):
	"""mpirun with this number of ranks of each group, each with its own words."""
	words = ["mpirun"]
	for ranks, more in groups:
		words += [":"] if len(words) > 1 else []
		words += ["-n", str(ranks), program.OBSIM, *map(str, more)]
	return words


class Spread(program.Case):
	def start(self, *groups):
		run = subprocess.Popen(command(*groups), env=program.RANKS, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
			stderr=subprocess.PIPE, text=True, cwd=self.directory.name)
		self.addCleanup(lambda: (run.poll() is None and run.kill(), run.wait(), run.stdout.close(), run.stderr.close()))
		return run

	def spread(self, *groups, code=0):
		run = self.start(*groups)
		out, said = run.communicate(timeout=program.PATIENCE)
		self.assertEqual(run.returncode, code, said)
		return out, said

	def rows(self, folder, without=()):
		with open(self.path(folder + "/results.csv"), newline="", encoding="utf-8") as f:
			return [{k: v for k, v in row.items() if k not in without} for row in csv.DictReader(f, strict=True)]

	def test_lab(self):
		one = program.call(*SMALL, "--out", self.path("one"))
		self.assertEqual(one.returncode, 0, one.stderr)
		out, _ = self.spread((3, [*SMALL, "--out", "three"]))
		self.assertEqual(self.rows("three", TIMES), self.rows("one", TIMES))
		self.assertEqual(out.count("report.html shows it all"), 1)
		self.assertEqual(sorted(os.listdir(self.path("three"))), sorted(os.listdir(self.path("one"))))
		# another number goes on from there
		before = self.rows("three")
		more = [w if w != "substeps=1,4" else "substeps=1,2,4" for w in SMALL]
		self.spread((2, [*more, "--out", "three"]))
		after = self.rows("three")
		self.assertEqual([r for r in after if r["substeps"] != "2"], before)
		self.assertEqual(len(after) - len(before), 3 * 2 * 2)
		program.call(*more, "--out", self.path("three"))
		self.assertEqual(self.rows("three"), after) # no work was left

	def test_out_of_time(self):
		"""Settings finer than one that ran out of time are not tried: they wait for it, on any rank."""
		words = ["lab", "pile", "pile-elastic", "--engines", "ode-quick", "--sweep", "substeps=1,2,4,8", "--limit", ".01"]
		self.spread((3, [*words, "--out", "three"]))
		for case in {r["case"] for r in self.rows("three")}:
			rows = [r for r in self.rows("three") if r["case"] == case]
			self.assertEqual([r["failure"] for r in rows], 4 * ["time"])
			self.assertEqual(len({r["took_s"] for r in rows}), 1)

	def test_compare(self):
		words = ["compare", program.scene("stack"), "-D", "n=5", "--duration", ".2", "--repeats", "1", "--workers", "2"]
		def point(text):
			runs = json.loads(text)["points"][0]["configurations"]
			return {name: (run["workers"], [r["state_hash"] for r in run["samples"]]) for name, run in runs.items()}
		one = program.call(*words, "--json", "-")
		self.assertEqual(one.returncode, 0, one.stderr)
		out, _ = self.spread((2, [*words, "--json", "-"]))
		self.assertEqual(point(out), point(one.stdout))

	def test_paper(self):
		words = ["paper", "--quick", "--objects", "5"]
		out, _ = self.spread((3, [*words, "--json"]))
		runs = json.loads(out)["runs"]
		self.assertEqual([r["failed"] for r in runs if r["failed"]], [])
		self.assertEqual(len(runs), 2 * 8 + 3 * 2)
		self.assertEqual(len(self.rows("obsim-paper")), len(runs))

	def test_list(self):
		out, _ = self.spread((2, ["lab", "--list"]))
		self.assertEqual(out, program.call("lab", "--list").stdout)

	def test_refused(self):
		words = [*SMALL, "--out", "out"]
		_, said = self.spread((2, words), (1, [*words, "--limit", "7"]), code=1)
		self.assertIn("obsim: rank 2 has other trials: give all ranks the same command", said)

	def under_way(self, run):
		self.assertTrue(program.wait_until(lambda: os.path.exists(self.path("out/results.csv")) and self.rows("out") or
			run.poll() is not None))
		self.assertIsNone(run.poll(), "it ended before it was looked at")

	def rank(self, run, number):
		for pid in program.processes(run.pid):
			try:
				with open(f"/proc/{pid}/environ", "rb") as f:
					said = f.read().split(b"\0")
			except OSError:
				continue
			if program.parent(pid) == run.pid and f"OMPI_COMM_WORLD_RANK={number}".encode() in said:
				return pid
		self.fail(f"no rank {number}")

	def test_ended(self):
		"""The same command goes on after a rank was killed or interrupted, and after mpirun was."""
		for rank, number, says in ((0, signal.SIGKILL, "process rank 0 .* on signal 9"),
				(2, signal.SIGKILL, "process rank 2 .* on signal 9"),
				(2, signal.SIGTERM, r"obsim: rank 2: interrupted: \d+ of 14 runs are done, and the same command goes on from there"),
				(None, signal.SIGTERM, None)): # mpirun gives all one second, which may be too short for rank 0's message
			with self.subTest(rank=rank, number=number):
				run = self.start((3, [*LONG, "--out", "out", "--fresh"]))
				self.under_way(run)
				below = program.processes(run.pid)
				os.kill(run.pid if rank is None else self.rank(run, rank), number)
				_, said = run.communicate(timeout=program.PATIENCE)
				self.assertNotEqual(run.returncode, 0)
				if says:
					self.assertRegex(said, says)
				self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))))
				before = self.rows("out")
				self.assertGreater(len(before), 0)
				self.spread((2, [*LONG, "--out", "out"]))
				after = self.rows("out")
				self.assertEqual(len(after), 14)
				self.assertTrue(all(row in after for row in before))
				os.remove(self.path("out/results.csv"))


unittest.main()
