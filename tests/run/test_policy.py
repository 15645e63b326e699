"""Policies for deaths of simulators: all restart, their objects freeze, or the run ends; and the report of each
death."""

import json
import os
import re
import unittest

import program

BOXES = [program.scene("falling_boxes"), "-D", "n=40", "--duration", "2", "--set", "measure=end"]
PROCESS = ["--isolation", "process"]
BRICKS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes", "overworked.lua")
ABORTS = "an assertion failed, as it was to (--fault abort)"


class Policy(program.Case):
	def test_last_words(self):
		"""The failed simulator, its step and its last words: on standard error, in the report, in the trace."""
		trace, whole = self.path("trace.json"), program.report(*BOXES)
		for more in [], ["--harden"]:
			done = program.call("run", *BOXES, *PROCESS, "--workers", "2", "--fault", "abort:p=.004,seed=3", *more, "--json", "-",
				"--trace", trace)
			self.assertEqual(done.returncode, 0, done.stderr)
			report = json.loads(done.stdout)
			self.assertEqual(report["state_hash"], whole["state_hash"])
			self.assertGreater(report["deaths"], 0)
			self.assertEqual(report["frozen"], 0)
			self.assertEqual(len(report["death_list"]), min(16, report["deaths"]))
			self.assertEqual(len(re.findall(f"(?m)^{re.escape(ABORTS)}$", done.stderr)), report["faults"]) # as it was written, too
			for d in report["death_list"]:
				self.assertEqual((d["cause"], d["signal"], d["last_words"], d["frozen"]), ("signal", 6, ABORTS, 0))
				self.assertIn(f"simulator {d['simulator']} (process {d['process']}) was killed by SIGABRT", d["what"])
				self.assertIn(f"after step {d['step'] - 1}", d["what"])
				self.assertIn(d["what"], done.stderr)
			with open(trace) as f:
				events = [e for e in json.load(f)["traceEvents"] if e.get("name") == "why it died"]
			self.assertEqual([e["args"]["step"] for e in events], [d["step"] for d in report["death_list"]])
			self.assertTrue(all(e["args"]["what"].endswith("its last words: " + ABORTS) for e in events))

	def test_keep(self):
		"""Objects that cannot be solved are frozen, while kills restart, freeze nothing, and leave the bits as
		they were."""
		r = program.report(BRICKS, "--duration", ".05", "--on-death", "keep")
		self.assertGreater(r["frozen"], 0)
		r = program.report(*BOXES, *PROCESS, "--workers", "2", "--fault", "kill:p=.004,seed=3", "--on-death", "keep")
		self.assertGreater(r["deaths"], 0)
		self.assertEqual((r["frozen"], r["state_hash"]), (0, program.report(*BOXES)["state_hash"]))

	def test_abort(self):
		done = program.call("run", *BOXES, *PROCESS, "--on-death", "abort", "--fault", "kill:p=.01,seed=2", "--json", self.path("r"))
		self.assertRegex(done.stderr, r"^obsim: simulator \d \(process \d+\) was killed by SIGKILL")
		self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1))
		with open(self.path("r")) as f:
			report = json.load(f)
		self.assertEqual((report["outcome"], report["deaths"], len(report["death_list"])), ("failed", 1, 1))

	def test_restarts(self):
		"""More deaths than allowed: it gives up, and counts the deaths of the simulator."""
		words = [*BOXES, *PROCESS, "--workers", "1", "--fault", "exit:p=.005,seed=5", "--set"]
		done = program.call("run", *words, "restarts=2/1e6", "--name", self.name)
		self.assertEqual(done.returncode, 1)
		self.assertEqual(done.stderr.count("restarting all"), 2)
		self.assertRegex(done.stderr, r"(?m)^obsim: simulator 0 .* left with exit code 99 .*giving up: simulators died more than 2 "
			r"times within 1e\+06 s \(--set restarts\), 3 of the last 3 times this one$")
		self.assertEqual(program.call("run", *words, "restarts=9999/1e6").returncode, 0)

	def test_freeze(self):
		"""The objects of a dead simulator stay, and the run goes on; the step of a second death depends on the
		checkpoints."""
		words = [*BOXES, *PROCESS, "--on-death", "freeze"]
		whole = program.report(*BOXES)
		for workers, fault in ("1", "segv:p=.001"), ("objects", "exit:p=.0001"):
			frozen = 0
			for seed in range(1, 7): # a simulator that dies between two objects freezes none
				done = program.report(*words, "--workers", workers, "--fault", f"{fault},seed={seed}")
				frozen += done["frozen"]
				self.assertEqual(done["bodies"], whole["bodies"] - done["frozen"])
				self.assertEqual(done["objects"], whole["objects"])
			self.assertGreater(frozen, 0, workers)

	def test_freeze_what_fails(self):
		"""An island that takes too much work: the same in threads and processes, with any number of workers."""
		seen, words = set(), (BRICKS, "--duration", ".05", "--on-death", "freeze", "--set", "patience=600") # sanitizers take a minute
		for isolation, workers in program.ways(("thread", "1"), ("thread", "objects"), ("process", "2")):
			r = program.report(*words, "--isolation", isolation, "--workers", workers)
			self.assertEqual([d["cause"] for d in r["death_list"]], ["failure"] * r["deaths"])
			self.assertEqual((r["steps"], r["death_list"][0]["name"]), (3, "brick 1"))
			seen.add((r["state_hash"], r["frozen"]))
		self.assertEqual(len(seen), 1)
		r = program.report(*words, *PROCESS, "--harden", "--workers", "2")
		self.assertEqual(seen, {(r["state_hash"], r["frozen"])})

	def test_freeze_crowd(self):
		"""More pairs of neighbours than there is room for, all found in one step or in time, also where a script waits for its turn: those with most are frozen, the same
		in threads and processes, with any number of workers."""
		scripted = "script('still', 'function on_step() end') sphere { radius = .1, at = { 0, 900, 0 }, script = 'still' }"
		for n, more in (725, ""), (725, scripted), (1200, ""):
			with open(self.path("rods.lua"), "w") as f: # side by side, aslant: their bounds overlap, and none touches another
				f.write(f"""
scene {{ gravity = {{ 0, 0, 0 }}, duration = .05 }}
{more}
for i = 1, {n} do
	box {{ size = {{ .002, .002, 5 }}, rotation = {{ axis = {{ 0, 1, 0 }}, degrees = 45 }}, at = {{ i * .002, 0, -i * .002 }} }}
end""")
			seen = set()
			for words in program.ways(["--workers", "1"], ["--workers", "2"], [*PROCESS, "--workers", "2"], [*PROCESS, "--harden"]):
				r = program.report(self.path("rods.lua"), "--on-death", "keep", *words)
				self.assertGreater(r["frozen"], 500)
				seen.add((r["state_hash"], r["frozen"]))
			self.assertEqual(len(seen), 1)
			done = program.call("run", self.path("rods.lua"))
			self.assertEqual(done.returncode, 1)
			self.assertRegex(done.stderr, r"more than 262144 pairs of neighbours, .*; make object \d+ \(box#\d+\).* smaller or slower")

	def test_frozen_goes_on(self):
		"""Frozen objects stay frozen in a checkpoint, and obsim top shows it."""
		file = self.path("run.ck")
		words = [program.scene("gas"), "-D", "n=40", "--set", "measure=end", *PROCESS, "--workers", "1", "--on-death", "freeze",
			"--set", "restarts=9999/1e6"] # moves for ever
		frozen = 0
		for seed in range(1, 7):
			r = program.report(*words, "--duration", "10", "--fault", f"segv:p=.001,seed={seed}", "--checkpoint", file)
			self.assertEqual(program.report("--resume", file, "--duration", "10.1")["bodies"], r["bodies"])
			frozen += r["frozen"]
		self.assertGreater(frozen, 0)
		run = self.start_universe(*words, "--duration", program.FOR_EVER, "--pace", "10", "--fault", "segv:p=.001,seed=2")
		look = lambda: program.call("top", self.name, "--once").stdout
		self.assertTrue(program.wait_until(lambda: "objects frozen" in look()))
		self.assertRegex(look(), r"deaths \d+, objects frozen \d+; the last: simulator 0 \(process \d+\) was killed by SIGSEGV")
		run.terminate()
		run.wait(program.PATIENCE)

	def test_what_is_refused(self):
		for words, saying in (["--on-death", "retire"], "restart|freeze|abort|keep"), (["--set", "restarts=5"], "as in 5/10"), \
				(["--set", "restarts=0/5"], "restarts"), (["--set", "restarts=5/-1"], "restarts"), \
				(["--set", "restarts=5/10", "--on-death", "abort"], "nothing is restarted"), \
				(["--arch", "monolith", "--on-death", "freeze"], "monolith"):
			self.refuse("run", *BOXES, *words, saying=saying)


unittest.main()
