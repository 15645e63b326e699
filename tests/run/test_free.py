"""obsim run --sync free: simulators at times of their own."""

import json
import os
import re
import signal
import time
import unittest

import program

STACK = """
local n = param('n', 4)
scene { duration = .5, sync = 'free', coupling = 'own', update_rate = 500 }
ground {}
for i = 1, n do box { size = {1, 1, 1}, at = {0, 0, i - .5 + .01 * i} } end
"""
FLIGHT = """
scene { duration = 1 }
sphere { radius = .1, at = {0, 0, 20}, velocity = {1, 2, 3} }
box { size = {1, 2, 3}, at = {5, 0, 20}, velocity = {0, 0, 1}, spin = {1, 2, 3} }
"""


class Free(program.Case):
	def scene(self, text):
		path = self.path("scene.lua")
		with open(path, "w") as f:
			f.write(text)
		return path

	def run_free(self, scene, *words):
		done = program.call("run", scene, "--sync", "free", "--json", self.path("r.json"), *words)
		self.assertEqual(done.returncode, 0, done.stderr)
		with open(self.path("r.json")) as f:
			return json.load(f), done

	def test_flight_is_exact(self):
		"""Bodies that touch nothing end where they do in lockstep, whatever their rates."""
		scene = self.scene(FLIGHT)
		expected = program.report(scene)
		own = "--set", "coupling=own"
		for more in (), own, (*own, "--set", "update_rate=37"), ("--isolation", "process", "--workers", "objects"), (*own, "--set", "jitter=.3"):
			r, _ = self.run_free(scene, *more)
			self.assertAlmostEqual(r["energy_end"] / expected["energy_end"], 1, delta=1e-9)
			self.assertEqual(r["steps"], 60)
			self.assertEqual(r["sync"], "free")

	def test_scene_key_and_report(self):
		done = program.call("run", self.scene(STACK), "--json", self.path("r.json"), "--report", "full")
		self.assertEqual(done.returncode, 0, done.stderr)
		self.assertRegex(done.stdout, r"free +500 Hz, coupling own")
		with open(self.path("r.json")) as f:
			r = json.load(f)
		self.assertEqual((r["sync"], r["coupling"], r["update_rate"]), ("free", "own", 500))
		self.assertGreaterEqual(r["updates"], 4 * 240) # a step ends at a boundary near it
		again = program.call("run", self.scene(STACK), "--sync", "lockstep")
		self.assertNotIn("free ", again.stdout)

	def test_killed_simulators_go_on(self):
		"""A simulator that is killed goes on where it had published: the common time reaches the end."""
		for coupling, *more in ("own", "--set", "update_rate=500"), ("group",):
			r, done = self.run_free(self.scene(STACK.replace(", coupling = 'own', update_rate = 500", "")), "--isolation", "process",
				"--workers", "objects", "--fault", "kill:p=.02,seed=3", "--set", f"coupling={coupling}", *more)
			self.assertGreater(r["deaths"], 0)
			self.assertEqual((r["steps"], r["coupling"]), (30, coupling))
			self.assertIn("goes on where it had published", done.stderr)
			self.assertIn("each simulator went on where it had published", done.stdout)

	def test_groups_are_the_default(self):
		"""They end in lockstep's bits, and the report has what they have, and nothing else."""
		scene = self.scene(STACK.replace(", coupling = 'own', update_rate = 500", ""))
		r, done = self.run_free(scene, "--report", "full", "--tolerance", ".5mm", "--set", "sleeping=on")
		self.assertRegex(done.stdout, r"free +60 Hz, coupling group; \d+ updates, \d+ waits")
		self.assertEqual(r["coupling"], "group")
		self.assertEqual([r[k] for k in ("max_lag", "jitter", "delay", "wait_s", "lag_mean_s", "lag_max_s")], 6 * [None])
		expected = program.report(scene, "--sync", "lockstep", "--tolerance", ".5mm", "--set", "sleeping=on")
		self.assertEqual(r["state_hash"], expected["state_hash"])

	def test_stopped_simulator(self):
		"""Only those that touch a stopped simulator wait, at the bound, and obsim top says so; it goes on later."""
		name = f"free-stop-{os.getpid()}"
		run = program.start("run", self.scene(STACK + "sphere { radius = .1, at = {9, 0, 1} }"), "--isolation", "process",
			"--workers", "objects", "--pace", 1, "--set", "max_lag=.02", "--duration", 3600, "--name", name, "--set", "measure=end")
		self.addCleanup(run.wait)
		self.addCleanup(run.kill)

		def top():
			return program.call("top", name, "--once", "--interval", ".01").stdout
		self.wait_until(lambda: "box#2" in top())
		pid = int(re.search(r"^ +2 +(\d+) ", top(), re.M).group(1))
		os.kill(pid, signal.SIGSTOP)
		self.wait_until(lambda: re.search(r"^ +[13] .* waits for 2$", top(), re.M))
		self.assertFalse(re.search(r"^ +5 .* waits for", top(), re.M))
		os.kill(pid, signal.SIGCONT)
		self.wait_until(lambda: not re.search(r" waits for 2$", top(), re.M))
		self.assertIsNone(run.poll())

	def wait_until(self, condition):
		end = time.monotonic() + program.PATIENCE
		while not condition():
			self.assertLess(time.monotonic(), end)
			time.sleep(.05)

	def test_births_and_deaths(self):
		scene = self.scene("""
scene { duration = 1 }
ground {}
for i = 1, 5 do sphere { radius = .1, at = {i, 0, 1}, born = i * .1, dies = i * .1 + .35 } end
sphere { radius = .1, at = {9, 0, 1} }
""")
		for more in (), ("--workers", "objects"), ("--isolation", "process"):
			for coupling in ("--set", "coupling=own", "--set", "update_rate=240"), ():
				r, _ = self.run_free(scene, *coupling, *more)
				self.assertEqual((r["steps"], r["objects"]), (60, 2))

	def test_rates_of_objects(self):
		"""Objects step at rates of their own; --set update_rate is for the others."""
		scene = self.scene("""
scene { duration = 1, sync = 'free', coupling = 'own', update_rate = 100 }
material "fast" { update_rate = 400 }
sphere { radius = .1, at = {0, 0, 20}, material = "fast" }
sphere { radius = .1, at = {9, 0, 20}, material = "fast", update_rate = 250 }
sphere { radius = .1, at = {19, 0, 20} }
""")
		for more, expected in ((), 750), (("--set", "update_rate=50"), 700), (("--workers", "objects"), 750):
			r, _ = self.run_free(scene, *more)
			self.assertTrue(.95 * expected <= r["updates"] < 1.3 * expected, r["updates"])

	def test_frames_of_the_common_time(self):
		series = self.path("series.csv")
		self.run_free(self.scene(FLIGHT), "--set", "coupling=own", "--set", "update_rate=111", "--series", series)
		with open(series) as f:
			self.assertEqual(len(f.readlines()), 62)

	def test_paced(self):
		r, _ = self.run_free(self.scene(FLIGHT), "--pace", 4, "--set", "coupling=own", "--set", "update_rate=100")
		self.assertEqual(r["max_lag"], None)
		self.assertGreater(r["elapsed_s"], .2)

	def test_refusals(self):
		scene = self.scene(FLIGHT)
		for words, named in [
			(["--set", "coupling=own", "--tolerance", "1mm"], "tolerance"), (["--harden", "--isolation", "process"], "harden"),
			(["--arch", "monolith"], "arch"), (["--set", "coupling=own", "--set", "lag=1", "--set", "solver=lagged"], "lag"),
			(["--checkpoint", self.path("c")], "checkpoint"), (["--set", "coupling=own", "--set", "sleeping=on"], "sleeping"),
			(["--explain"], "explain"), (["--check"], "check"),
			(["--on-death", "freeze"], "on-death"), (["--set", "solver=jacobi"], "solver"),
			(["--set", "measure=profile"], "profile"),
		]:
			done = program.call("run", scene, "--sync", "free", *words)
			self.assertEqual(done.returncode, 2, words)
			self.assertIn(named, done.stderr)
		for setting in "update_rate=.5", "max_lag=.5", "jitter=.5", "delay=.5", "coupling=own":
			done = program.call("run", scene, "--set", setting)
			self.assertEqual((done.returncode, "is for --sync free" in done.stderr), (2, True), done.stderr)
		scripted = self.scene("ground {}\nbox { size = {1, 1, 1}, at = {0, 0, 1}, script = [[function on_step(self) end]] }")
		done = program.call("run", scripted, "--sync", "free")
		self.assertEqual((done.returncode, "scripts" in done.stderr), (2, True), done.stderr)
		joined = self.scene("box { size = {1, 1, 1}, at = {0, 0, 1}, name = 'bob' }\n"
			"hinge { 'bob', at = { 0, 0, 2 }, axis = { 0, 1, 0 } }")
		done = program.call("run", joined, "--sync", "free")
		self.assertEqual((done.returncode, "joints" in done.stderr), (2, True), done.stderr)


if __name__ == "__main__":
	unittest.main()
