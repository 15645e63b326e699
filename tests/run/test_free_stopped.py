"""One simulator of a hundred is stopped for a second of a free run in real time: others go on, but for those that touch it.

Prints the rate that the others kept."""

import ctypes
import os
import re
import signal
import sys
import time
import unittest

import program

FAR, RATE, BOUND = 97, 250, .05 # boxes that lie alone; Hz; s, of the lag
SCENE = f"""
ground {{}}
for i = 0, {FAR - 1} do box {{ size = {{.5, .5, .5}}, at = {{1.5 * (i % 10), 1.5 * (i // 10), .25}} }} end
for i = 1, 3 do box {{ size = {{1, 1, 1}}, at = {{-9, 0, i - .5}} }} end
"""
ALONE, LOWER, STOPPED, UPPER = range(1, FAR + 1), FAR + 1, FAR + 2, FAR + 3 # ids


class Universe:
	"""Own times of simulators, read as any program reads them."""

	def __init__(self, name):
		self.library = ctypes.CDLL(os.path.join(os.path.dirname(program.OBSIM), "include/ob/libobsim.so.0"))
		self.library.ob_universe_attach.restype = ctypes.c_void_p
		self.library.ob_universe_get_own_time.restype = ctypes.c_bool
		error = ctypes.create_string_buffer(4096)
		self.at = ctypes.c_void_p(self.library.ob_universe_attach(name.encode(), error))
		assert self.at.value, error.value

	def own_times(self):
		time = ctypes.c_double()

		def of(id):
			assert self.library.ob_universe_get_own_time(self.at, ctypes.c_uint32(id), ctypes.byref(time))
			return time.value
		return {id: of(id) for id in [*ALONE, LOWER, STOPPED, UPPER]}

	def least_advance(self, begin):
		"""Of those that lie alone."""
		now = self.own_times()
		return min(now[id] - begin[id] for id in ALONE)


@unittest.skipIf(program.SANITIZED, "a program without a sanitizer cannot load a library with one")
class Stopped(program.Case):
	def top(self):
		return program.call("top", self.name, "--once", "--interval", ".01").stdout

	def waiting(self):
		return {int(a): int(b) for a, b in re.findall(r"^ +(\d+) .* waits for (\d+)$", self.top(), re.M)}

	def test_end(self):
		"""A run that is ended while a simulator stands takes the ends of others for no deaths."""
		for _ in range(3):
			run = self.start_stepping(program.scene("falling_boxes"), "-D", "n=40", "--sync", "free", "--pace", 1, "--isolation", "process", "--workers", 4,
				"--duration", 3600, "--set", "measure=end")
			pid = int(re.search(r"^ +1 +(\d+) ", self.top(), re.M)[1])
			os.kill(pid, signal.SIGSTOP)
			run.send_signal(signal.SIGTERM)
			self.assertNotIn("before the run was over", run.communicate(timeout=program.PATIENCE)[1])

	def test_a_second(self):
		scene = self.path("scene.lua")
		with open(scene, "w") as f:
			f.write(SCENE)
		run = self.start_stepping(scene, "--sync", "free", "--set", "coupling=own", "--set", f"update_rate={RATE}", "--pace", 1, "--set", f"max_lag={BOUND}", "--isolation", "process", "--workers", "objects", "--duration", 3600, "--set", "measure=end")
		universe = Universe(self.name)
		self.assertTrue(program.wait_until(lambda: min(universe.own_times().values()) > 1))
		pid = int(re.search(rf"^ +{STOPPED} +(\d+) ", self.top(), re.M)[1])
		os.kill(pid, signal.SIGSTOP)
		self.addCleanup(lambda: program.alive(pid) and os.kill(pid, signal.SIGCONT))
		begin, begun = universe.own_times(), time.monotonic()
		self.assertTrue(program.wait_until(lambda: universe.least_advance(begin) >= 1))
		waiting, end = self.waiting(), universe.own_times()
		ended = time.monotonic()
		self.assertEqual(waiting, {LOWER: STOPPED, UPPER: STOPPED})
		self.assertEqual(end[STOPPED], begin[STOPPED])
		for id in LOWER, UPPER:
			self.assertLess(end[id] - end[STOPPED], BOUND + 1.5 / RATE)
		os.kill(pid, signal.SIGCONT)
		self.assertTrue(program.wait_until(lambda: not self.waiting()))
		kept = sorted((end[i] - begin[i]) / (ended - begun) for i in ALONE)
		run.send_signal(signal.SIGINT)
		run.communicate(timeout=program.PATIENCE)
		print(f"{FAR} others kept {100 * kept[0]:.2f} to {100 * kept[-1]:.2f} % of their rate in {ended - begun:.2f} s",
			file=sys.stderr)


if __name__ == "__main__":
	unittest.main()
