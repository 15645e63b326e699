"""Injected faults: simulators fail, the report counts the failures, and the run ends in the same bits."""

import re
import unittest

import program

BOXES = [program.scene("falling_boxes"), "-D", "n=40", "--duration", "2", "--set", "measure=end"]


class Fault(program.Case):
	def faulty(self, *words):
		"""The report of a run with faults, and their number by kind."""
		done = program.report(*BOXES, *words)
		kinds = {kind: int(n) for kind, n in re.findall(r"(\w+) (\d+)", done["fault_kinds"])}
		self.assertEqual(sum(kinds.values()), done["faults"])
		return done, kinds

	def test_deaths(self):
		"""Includes deaths of simulators that schedule, while all others wait for the schedule."""
		whole = program.report(*BOXES)
		self.assertEqual((whole["faults"], whole["fault_kinds"]), (0, ""))
		seen = {}
		for seed in range(1, 9):
			workers = ["1", "2", "3", "objects"][seed % 4]
			p = .0002 if workers == "objects" else .0015
			done, kinds = self.faulty("--isolation", "process", "--workers", workers, "--fault", f"kill+segv+exit:p={p},seed={seed}")
			self.assertEqual(done["state_hash"], whole["state_hash"], (seed, workers))
			self.assertLessEqual(done["deaths"], done["faults"])
			self.assertGreaterEqual(done["deaths"], done["faults"] > 0)
			seen = {k: seen.get(k, 0) + kinds.get(k, 0) for k in ("kill", "segv", "exit")}
		self.assertTrue(all(seen.values()), seen)

	def test_stopped(self):
		whole = program.report(*BOXES)
		done, kinds = self.faulty("--isolation", "process", "--workers", "2", "--set", "patience=1", "--fault", "stop:p=.0005,seed=2")
		self.assertEqual(done["state_hash"], whole["state_hash"])
		self.assertGreater(kinds["stop"], 0)
		self.assertGreater(done["deaths"], 0)

	def test_slow(self):
		whole = program.report(*BOXES)
		for isolation in "thread", "process":
			done, kinds = self.faulty("--isolation", isolation, "--workers", "2", "--fault", "slow:p=.01,ms=5")
			self.assertEqual(done["state_hash"], whole["state_hash"])
			self.assertGreater(kinds["slow"], 0)
			self.assertEqual(done["deaths"], 0)

	def test_same_faults(self):
		"""One worker fails at the same random instants each time."""
		words = "--workers", "1", "--fault", "slow:p=.02,ms=1,seed=5"
		self.assertEqual(self.faulty(*words)[1], self.faulty(*words)[1])

	def test_scribbling(self):
		"""After random writes the host ends in order: the run goes on, or explains its end."""
		for seed in range(1, 4):
			done = program.call("run", *BOXES, "--isolation", "process", "--workers", "2", "--set", "patience=1", "--fault",
				f"scribble:p=.003,words=5,seed={seed}", "--name", self.name)
			self.assertIn(done.returncode, (0, 1), done.stderr)
			self.assertEqual(done.returncode == 1, bool(re.search("^obsim: (?!warning|note)", done.stderr, re.M)), done.stderr)

	def test_full_disk(self):
		file = self.path("run.ck")
		done = program.call("run", *BOXES, "--checkpoint", file, "--set", "every=.1", "--fault", "nospace:p=.5", "--json", self.path("r.json"))
		self.assertIn("No space left on device", done.stderr)
		self.assertEqual(program.call("inspect", file).returncode, 0)
		whole = program.report(*BOXES)
		self.assertEqual(program.report("--resume", file)["state_hash"], whole["state_hash"])

	def test_no_pages(self):
		"""The universe cannot grow: at its start or in a step that is the same in every run, one line, and nothing left behind."""
		for isolation in ["thread"], ["process"], ["process", "--harden"]:
			said = set()
			for _ in range(2):
				done = program.call("run", *BOXES, "--isolation", *isolation, "--fault", "nopages:p=1", "--name", self.name)
				self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
				said.add(done.stderr)
			self.assertEqual(len(said), 1)
			self.assertIn("/dev/shm is full", said.pop())
		failed = 0
		for seed in range(1, 9):
			done = program.call("run", program.scene("pile"), "--duration", ".5", "--isolation", "process", "--fault",
				f"nopages:p=.1,seed={seed}", "--name", self.name)
			self.assertIn(done.returncode, (0, 1), done.stderr)
			self.assertEqual(done.returncode, "/dev/shm is full" in done.stderr, done.stderr)
			failed += done.returncode
		self.assertGreater(failed, 0)

	def test_what_is_refused(self):
		for text, saying in ("kil:p=.1", "expected some of kill|segv"), ("kill", "expected the probability"), ("kill:p", "expected p="), ("kill:p=2", "at most 1"), \
				("kill:p=.1,word=3", "expected p=, seed="), ("kill+:p=.1", "expected some of"), ("nospace:p=.1", "is for --checkpoint"):
			self.refuse("run", *BOXES, "--isolation", "process", "--fault", text, saying=saying)
		self.refuse("run", *BOXES, "--fault", "kill:p=.1", saying="--isolation process")


unittest.main()
