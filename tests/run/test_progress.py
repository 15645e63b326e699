"""The progress line: on a terminal, for runs of more than two seconds, and gone at the end."""

import os
import re
import signal
import subprocess
import time
import unittest

import program


class Progress(program.Case):
	def run_on_terminal(self, *words, until=None):
		"""Returns the output; interrupts the run once the output matches "until"."""
		leader, terminal = self.open_terminal()
		run = subprocess.Popen([program.OBSIM, "run", *words, "--name", self.name], stdout=subprocess.DEVNULL, stderr=terminal)
		os.close(terminal)
		seen = b""
		try:
			while chunk := os.read(leader, 65536):
				seen += chunk
				if until and re.search(until, seen.decode(errors="replace")):
					run.send_signal(signal.SIGINT)
					until = None
		except OSError: # the other end is closed
			pass
		os.close(leader)
		run.wait(program.PATIENCE)
		return seen.decode()

	def test_long(self):
		seen = self.run_on_terminal(program.scene("stack"), "--duration", program.FOR_EVER, "--set", "measure=end",
			until=r"\] \d+ of \d+, .* left: \d+ steps/")
		self.assertIn("left", seen)
		self.assertTrue(seen.rpartition("left")[2].lstrip().startswith("\r\033[K") or "\r\033[K" in seen.rpartition("left")[2])

	def test_short(self):
		began = time.monotonic()
		seen = self.run_on_terminal(program.scene("cradle"), "--duration", ".2")
		self.assertTrue(seen == "" or time.monotonic() - began > 2, seen)


unittest.main()
