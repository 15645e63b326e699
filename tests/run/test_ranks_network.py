"""One universe on two machines: network namespaces of this one, with a cable between them, or a link that takes a millisecond."""

import json
import os
import subprocess
import unittest

import network
import program

WORDS = [program.scene("falling_boxes"), "-D", "n=60", "--duration", "1", "--sleeping", "off", "--measure", "end"]


class Network(program.Case):
	def link(self, delay):
		try:
			link = network.Link(f"obsim{os.getpid()}", delay)
		except (OSError, subprocess.CalledProcessError) as error:
			self.skipTest(f"no two networks can be made here: {error}")
		self.addCleanup(link.close)
		return link

	def command(self, link, words):
		"""mpirun in the one, which starts a rank there and one in the other."""
		agent = self.path("agent") # in the place of ssh, with its words
		with open(agent, "w", encoding="utf-8") as f:
			f.write(f'#!/bin/sh\nshift\nexec {" ".join(link.inside(1))} sh -c "$*"\n')
		os.chmod(agent, 0o700)
		only = [word for part in ("btl", "oob") for word in ("--mca", f"{part}_tcp_if_include", network.NET + ".0/24")]
		return [*link.inside(0), "mpirun", "--mca", "plm_rsh_agent", agent, *only, "--host", ",".join(link.address), "-n", "2",
			program.OBSIM, "run", *words]

	def test_same_bits(self):
		right = program.report(*WORDS, "--workers", "1")["state_hash"]
		for delay in None, .001:
			with self.subTest(delay=delay):
				link = self.link(delay)
				done = subprocess.run(self.command(link, [*WORDS, "--workers", "1", "--json", "-"]), env=program.RANKS,
					stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=program.PATIENCE)
				self.assertEqual(done.returncode, 0, done.stderr)
				report = json.loads(done.stdout)
				self.assertEqual(report["state_hash"], right)
				self.assertGreater(link.packets(), report["steps"])
				link.close()


unittest.main()
