"""obsim top: from another process, once and on a terminal."""

import fcntl
import glob
import os
import re
import select
import signal
import struct
import subprocess
import termios
import time
import unittest

import program

LONG = ["--duration", program.FOR_EVER, "--set", "measure=end", "--set", "sleeping=off"]


def read_screen(fd, until, seconds=program.PATIENCE):
	"""Output to a terminal, until the text comes or the time is over."""
	seen, end = "", time.monotonic() + seconds
	while until not in seen and time.monotonic() < end:
		if select.select([fd], [], [], .1)[0]:
			try:
				seen += os.read(fd, 65536).decode(errors="replace")
			except OSError:
				break
	return seen


def in_line(pid, thread):
	"""Seconds for which the process's thread of this name has waited for a core so far."""
	for task in glob.glob(f"/proc/{pid}/task/*"):
		try:
			with open(task + "/comm") as name, open(task + "/schedstat") as times:
				if name.read().strip() == thread:
					return 1e-9 * int(times.read().split()[1])
		except OSError:  # gone, or a kernel without these counters
			continue
	return 0


class Top(program.Case):
	def run_universe(self, *words):
		run = self.start_universe(*words, *LONG)
		self.addCleanup(lambda: program.wait_until(lambda: not os.path.exists(program.segment(self.name))))
		return run

	def end(self, run):
		run.send_signal(signal.SIGINT)
		run.wait(program.PATIENCE)

	def test_once(self):
		run = self.run_universe(program.scene("stack"), "--isolation", "process", "--workers", "2")
		done = program.call("top", self.name, "--once")
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		self.assertIn(self.name + ": running", done.stdout)
		rate = re.search(r"([0-9.]+) steps/s", done.stdout)
		self.assertGreater(float(rate[1]), 0)
		self.assertEqual(len(re.findall(r"^ *\d+ .* box +(awake|free|asleep) ", done.stdout, re.M)), 10)
		self.assertEqual(len(re.findall(r"^ *\d+ .* plane +static ", done.stdout, re.M)), 1)
		workers = re.findall(r"^ +(\d) +(\d+) +(\d+) +\S+ +\d+ +([0-9.]+|-) +[0-9.]+$", done.stdout, re.M)
		self.assertEqual([w[0] for w in workers], ["0", "1"])
		below = program.processes(run.pid)
		self.assertTrue(all(int(w[1]) in below for w in workers))
		self.end(run)

	def test_busy(self):
		"""A worker that always has work is shown as busy."""
		run = self.run_universe(program.scene("pile"), "--workers", "1")
		began, waited = time.monotonic(), in_line(run.pid, "sim 0")
		done = program.call("top", self.name, "--once", "--interval", "2")
		waited = (in_line(run.pid, "sim 0") - waited) / (time.monotonic() - began)
		share = re.search(r"^ +0 +\d+ +\d+ +\S+ +\d+ +([0-9.]+) ", done.stdout, re.M)
		self.assertGreater(float(share[1]), 20 * (1 - waited))
		self.assertLess(float(share[1]), 140)
		self.end(run)

	def test_pipe(self):
		"""No terminal: as --once, with all objects."""
		run = self.run_universe(program.scene("falling_boxes"), "-D", "n=60")
		done = program.call("top", self.name, "--interval", ".3")
		self.assertEqual(len(re.findall(" box ", done.stdout)), 60)
		self.assertNotIn("\033", done.stdout)
		self.end(run)

	def test_missing(self):
		run = self.run_universe(program.scene("stack"))
		done = program.call("top", "nonesuch")
		self.assertEqual(done.returncode, 1)
		self.assertIn(self.name, done.stderr) # the existing universes
		near = program.call("top", self.name + "x")
		self.assertIn("did you mean obsim top " + self.name, near.stderr)
		self.end(run)

	def test_terminal(self):
		leader, terminal = self.open_terminal()
		run = self.run_universe(program.scene("falling_boxes"), "-D", "n=60")
		fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
		before = termios.tcgetattr(terminal)
		top = subprocess.Popen([program.OBSIM, "top", self.name, "--interval", ".2"], stdin=terminal, stdout=terminal,
			stderr=terminal)
		seen = read_screen(leader, "steps/s")
		self.assertIn("\033[?1049h", seen) # the alternate screen
		self.assertIn("running", seen)
		os.write(leader, b"w")
		self.assertIn("WORKER", read_screen(leader, "WORKER"))
		os.write(leader, b"w\033[6~\033[B")
		read_screen(leader, "nothing such", .5)
		fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 100, 0, 0))
		top.send_signal(signal.SIGWINCH)
		self.assertIn("objects", read_screen(leader, "objects"))
		os.write(leader, b"q")
		seen = read_screen(leader, "\033[?1049l")
		self.assertIn("\033[?1049l", seen)
		self.assertEqual(top.wait(program.PATIENCE), 0)
		self.assertEqual(termios.tcgetattr(terminal), before)
		os.close(leader)
		os.close(terminal)
		self.end(run)

	def test_universe_ends(self):
		"""The screen stays, and shows the end."""
		leader, terminal = self.open_terminal()
		run = self.run_universe(program.scene("stack"))
		top = subprocess.Popen([program.OBSIM, "top", self.name, "--interval", ".2"], stdin=terminal, stdout=terminal,
			stderr=terminal)
		self.assertIn("running", read_screen(leader, "running"))
		self.end(run)
		self.assertIn("gone", read_screen(leader, "gone"))
		top.send_signal(signal.SIGTERM)
		read_screen(leader, "\033[?1049l")
		self.assertEqual(top.wait(program.PATIENCE), 0)
		os.close(leader)
		os.close(terminal)


unittest.main()
