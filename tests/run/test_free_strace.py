"""System calls of free simulators: sleeps until a step is due, and waits by the bound of the lag, which are counted."""

import json
import re
import shutil
import subprocess
import unittest

import program

SCENE = """
scene { duration = 1, sync = 'free', coupling = 'own', update_rate = 500 }
ground {}
for i = 1, 4 do box { size = {1, 1, 1}, at = {0, 0, i - .5} } end
"""
FEW = 20 # futexes of all simulating threads while they begin, wait for the host, and end


@unittest.skipUnless(shutil.which("strace"), "strace is not installed")
class Strace(program.Case):
	def traced(self, *words):
		"""System calls of the threads that simulate, in a run in real time, and its report."""
		scene, trace, report = self.path("scene.lua"), self.path("trace"), self.path("r.json")
		with open(scene, "w") as f:
			f.write(SCENE)
		done = subprocess.run(["strace", "-f", "-qq", "-o", trace, program.OBSIM, "run", scene, "--pace", "1", "--set", "measure=end",
			"--json", report, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=program.PATIENCE)
		if done.returncode and "ptrace" in done.stderr.lower():
			self.skipTest("strace may not trace here")
		self.assertEqual(done.returncode, 0, done.stderr)
		with open(trace) as f:
			made = re.findall(r"^(\d+) +(\w+)\(", f.read(), re.M)
		workers = {thread for thread, call in made if call == "clock_nanosleep"} - {made[0][0]} # the first is the host's
		calls = [call for thread, call in made if thread in workers]
		with open(report) as f:
			return calls, json.load(f)

	def test_no_futex_in_a_step(self):
		calls, r = self.traced("--workers", "2", "--set", "max_lag=none")
		self.assertGreaterEqual(r["updates"], 1900)
		self.assertEqual(r["waits"], 0)
		self.assertLess(calls.count("futex"), FEW)
		for lock in "sched_yield", "semop", "flock", "poll", "epoll_wait":
			self.assertNotIn(lock, calls)

	def test_waits_are_counted(self):
		"""By the bound of the lag: a call to wait, and one to wake, for each wait that the report counts."""
		calls, r = self.traced("--workers", "objects", "--set", "max_lag=.002")
		self.assertGreater(r["waits"], 0)
		self.assertLess(calls.count("futex"), 2 * r["waits"] + FEW)


if __name__ == "__main__":
	unittest.main()
