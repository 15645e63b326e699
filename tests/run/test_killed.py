"""Kills without warning: the host, a simulator, the fork server. Nothing is left."""

import glob
import os
import signal
import time
import unittest

import program

LONG = [program.scene("falling_boxes"), "-D", "n=30", "--duration", program.FOR_EVER, "--set", "sleeping=off", "--set", "measure=end"]
WAYS = [["--isolation", i, "--workers", w] for i in ("thread", "process") for w in ("2", "objects")]


class Killed(program.Case):
	def check_nothing_left(self, below):
		gone = program.wait_until(lambda: not os.path.exists(program.segment(self.name)) and not any(map(program.alive, below)))
		self.assertTrue(gone, [p for p in below if program.alive(p)] + glob.glob("/dev/shm/obsim.*"))

	def test_host(self):
		for way in WAYS:
			with self.subTest(way=way):
				run = self.start_stepping(*LONG, *way)
				below = program.processes(run.pid)
				self.assertGreaterEqual(len(below), 31 if way == WAYS[-1] else 1)
				run.send_signal(signal.SIGKILL)
				run.wait(program.PATIENCE)
				self.check_nothing_left(below)

	def test_host_at_any_time(self):
		"""Also while it starts. If it had a name and no fork server yet, the next start clears it away."""
		for delay in 0, .001, .002, .005, .01, .02, .05, .1:
			with self.subTest(delay=delay):
				run = program.start("run", *LONG, "--isolation", "process", "--workers", "objects", "--name", self.name)
				time.sleep(delay)
				below = program.processes(run.pid)
				run.send_signal(signal.SIGKILL)
				run.wait(program.PATIENCE)
				run.stdout.close()
				run.stderr.close()
				self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))))
				program.report(program.scene("stack"), "--duration", ".1")
				self.check_nothing_left(below)

	def test_simulator_of_a_monolith(self):
		"""There is no checkpoint: the run fails, names the simulator that died, and ends in order."""
		run = self.start_stepping(*LONG, "--isolation", "process", "--arch", "monolith")
		below = program.processes(run.pid)
		os.kill(program.simulators(run.pid)[0], signal.SIGKILL)
		self.assertEqual(run.wait(program.PATIENCE), 1)
		self.assertRegex(run.stderr.read(), r"^obsim: simulator 0 .*killed")
		self.check_nothing_left(below)

	def test_stopped_fork_server(self):
		"""A stopped fork server is killed: the run ends in order, with all simulators."""
		for way in WAYS:
			with self.subTest(way=way):
				run = self.start_stepping(*LONG, *way)
				below = program.processes(run.pid)
				os.kill(program.fork_server(run.pid), signal.SIGSTOP)
				run.send_signal(signal.SIGTERM)
				self.assertEqual(run.wait(program.PATIENCE), 1)
				self.assertRegex(run.stderr.read(), r"fork server \(process \d+, stopped by a signal\) does not end: killed")
				self.check_nothing_left(below)

	def test_stranger_under_a_name(self):
		"""A FIFO with a universe's name, which any user can create, blocks no run, and is an error for that
		name."""
		os.mkfifo(program.segment(self.name))
		self.addCleanup(lambda: os.path.exists(program.segment(self.name)) and os.unlink(program.segment(self.name)))
		program.report(program.scene("stack"), "--duration", ".1")
		self.refuse("run", program.scene("stack"), "--name", self.name, saying=program.segment(self.name), code=1)
		looked = program.call("top", self.name, "--once") # it lists what else lives on the machine
		self.assertEqual((looked.returncode, looked.stdout), (1, ""))
		self.assertTrue(looked.stderr.startswith("obsim: "), looked.stderr)
		os.unlink(program.segment(self.name))

	def test_stale_is_cleared(self):
		"""The next run removes the remains of a killed host and fork server."""
		run = self.start_stepping(*LONG)
		below = program.processes(run.pid)
		for pid in [run.pid, *below]:
			os.kill(pid, signal.SIGSTOP)
		for pid in [run.pid, *below]:
			os.kill(pid, signal.SIGKILL)
		run.wait(program.PATIENCE)
		self.assertTrue(os.path.exists(program.segment(self.name)))
		program.report(program.scene("stack"), "--duration", ".1")
		self.assertFalse(os.path.exists(program.segment(self.name)))

	def test_name_is_taken(self):
		run = self.start_universe(*LONG)
		other = program.call("run", program.scene("stack"), "--name", self.name)
		self.assertEqual(other.returncode, 1)
		self.assertIn(self.name, other.stderr)
		self.assertIsNone(run.poll())
		run.send_signal(signal.SIGINT)
		run.wait(program.PATIENCE)


unittest.main()
