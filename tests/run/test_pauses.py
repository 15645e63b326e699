"""A run that is stopped by a signal for longer than its patience goes on as if it had not been."""

import os
import signal
import time
import unittest

import program

PATIENCE = 1  # s that a step may take
LONG = [program.scene("falling_boxes"), "-D", "n=60", "--duration", "40", "--set", "sleeping=off", "--set", "measure=end",
	"--set", f"patience={PATIENCE}"]


class Pauses(program.Case):
	def test_stopped_and_continued(self):
		"""As by Ctrl-Z and fg: the host alone is the terminal's, simulators that are processes have a session of their own."""
		for way in ["thread"], ["process"], ["process", "--workers", "objects"]:
			with self.subTest(way=way):
				words = [*LONG, "--isolation", *way]
				run = program.start("run", *words, "--name", self.name, "--json", self.path("r.json"))
				for _ in range(2):
					time.sleep(.2)
					self.stop_for_a_while([run.pid])
				self.check(run)

	def test_all_stopped(self):
		"""As when a machine is suspended."""
		run = program.start("run", *LONG, "--isolation", "process", "--name", self.name, "--json", self.path("r.json"))
		time.sleep(.3)
		self.stop_for_a_while([run.pid, *program.processes(run.pid)])
		self.check(run)

	def stop_for_a_while(self, pids):
		for pid in pids:
			os.kill(pid, signal.SIGSTOP)
		time.sleep(1.5 * PATIENCE)
		for pid in reversed(pids):
			os.kill(pid, signal.SIGCONT)

	def check(self, run):
		out, said = run.communicate(timeout=program.PATIENCE)
		self.assertEqual(run.returncode, 0, said)
		self.assertNotIn("was not complete", said)


unittest.main()
