"""One universe on two machines: two network namespaces, with a cable between them, or a link that takes a millisecond;
and a cut cable."""

import json
import os
import subprocess
import unittest

import network
import program

WORDS = [program.scene("falling_boxes"), "-D", "n=60", "--set", "sleeping=off", "--set", "measure=end"]
SOON = {"oob_tcp_keepalive_time": 5, "oob_tcp_keepalive_intvl": 1, "oob_tcp_keepalive_probes": 5} # s, s: as in docs/obsim.1


class Network(program.Case):
	def link(self, delay):
		try:
			link = network.Link(f"obsim{os.getpid()}", delay)
		except (OSError, subprocess.CalledProcessError) as error:
			self.skipTest(f"no two networks can be made here: {error}")
		self.addCleanup(link.close)
		return link

	def start(self, link, *words):
		"""mpirun in one namespace; it starts a rank there and one in the other."""
		agent = self.path("agent") # replaces ssh, with the same arguments
		with open(agent, "w", encoding="utf-8") as f:
			f.write(f'#!/bin/sh\nshift\nexec {" ".join(link.inside(1))} sh -c "$*"\n')
		os.chmod(agent, 0o700)
		settings = {"plm_rsh_agent": agent, "btl_tcp_if_include": network.NET + ".0/24", "oob_tcp_if_include": network.NET + ".0/24", **SOON}
		launcher = ["mpirun", *(word for name, value in settings.items() for word in ("--mca", name, str(value)))]
		running = subprocess.Popen([*link.inside(0), *launcher, "--host", ",".join(link.address), "-n", "2", program.OBSIM, "run", *words],
			env=program.RANKS, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
		self.addCleanup(lambda: (running.poll() is None and running.terminate(), running.wait(), running.stdout.close(), running.stderr.close()))
		return running

	def test_same_bits(self):
		right = program.report(*WORDS, "--duration", "1", "--workers", "1")["state_hash"]
		for delay in None, .001:
			with self.subTest(delay=delay):
				link = self.link(delay)
				running = self.start(link, *WORDS, "--duration", "1", "--workers", "1", "--json", "-")
				out, said = running.communicate(timeout=program.PATIENCE)
				self.assertEqual(running.returncode, 0, said)
				report = json.loads(out)
				self.assertEqual(report["state_hash"], right)
				self.assertGreater(link.packets(), report["steps"])
				link.close()

	def test_a_machine_goes_silent(self):
		"""A cut cable sends no error; packets just stop. Both ranks end, and have their checkpoints."""
		right = program.report(*WORDS, "--duration", "4", "--workers", "1")["state_hash"]
		link, kept = self.link(None), self.path("kept")
		running = self.start(link, *WORDS, "--duration", "4", "--pace", "1", "--workers", "1", "--checkpoint", kept, "--set", "every=.1")
		stepping = lambda: sum(program.steps(f"obsim-{pid}") > 0 for pid in link.processes()) == 2
		self.assertTrue(program.wait_until(lambda: stepping() or running.poll() is not None))
		link.cut()
		_, said = running.communicate(timeout=program.PATIENCE)
		self.assertNotEqual(running.returncode, 0)
		self.assertIn(f"obsim run --resume {kept}\n", said)
		self.assertTrue(program.wait_until(lambda: not link.processes()))
		for file in kept, kept + ".1":
			self.assertEqual(program.report("--resume", file, "--workers", "1")["state_hash"], right)


unittest.main()
