"""Ctrl-C and similar signals: the run ends at once, its files are whole, its report says so, nothing is left."""

import json
import os
import shutil
import signal
import subprocess
import time
import unittest

import program

# The tests may run under nohup, where obsim would rightly ignore hang-ups, too.
signal.signal(signal.SIGHUP, signal.SIG_DFL)

HEAVY = [program.scene("falling_boxes"), "-D", "n=2000", "--duration", program.FOR_EVER]
LONG = [program.scene("falling_boxes"), "-D", "n=30", "--duration", program.FOR_EVER, "--set", "sleeping=off"]


class Interrupt(program.Case):
	def interrupt(self, *words, number=signal.SIGINT, when=lambda: True):
		"""The report of a run that is interrupted a moment after the condition holds."""
		run = self.start_stepping(*LONG, "--json", self.path("r.json"), *words)
		self.assertTrue(program.wait_until(when))
		time.sleep(.3)
		below = program.processes(run.pid)
		run.send_signal(number)
		self.assertEqual(run.wait(program.PATIENCE), 1)
		self.assertIn("interrupted", run.stderr.read())
		self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))), "processes are left")
		with open(self.path("r.json")) as f:
			report = json.load(f)
		self.assertEqual(report["outcome"], "interrupted")
		self.assertGreater(report["steps"], 0)
		return report

	def test_signals(self):
		for number in signal.SIGINT, signal.SIGTERM, signal.SIGHUP:
			for isolation in "thread", "process":
				with self.subTest(number=number, isolation=isolation):
					self.interrupt("--isolation", isolation, number=number)

	def test_one_leg(self):
		"""A run without measures on its way also reports its progress."""
		report = self.interrupt("--set", "measure=end")
		self.assertGreater(report["simulated_s"], 0)

	def test_at_start(self):
		run = self.start_universe(*LONG, "--isolation", "process", "--workers", "objects")
		run.send_signal(signal.SIGINT)
		self.assertEqual(run.wait(program.PATIENCE), 1)

	def test_at_any_time(self):
		"""Also while it starts. Before it handles signals there is nothing to clean up, and it dies of them."""
		for number in signal.SIGTERM, signal.SIGINT:
			for words in ["--isolation", "process", "--workers", "objects"], []:
				for delay in 0, .01, .02, .03, .05:
					with self.subTest(number=number, words=words, delay=delay):
						run = program.start("run", *HEAVY, *words, "--name", self.name)
						time.sleep(delay)
						run.send_signal(number)
						out, said = run.communicate(timeout=program.PATIENCE)
						self.assertIn(run.returncode, (1, -number), said)
						self.assertFalse(os.path.exists(program.segment(self.name)))

	def test_record(self):
		report = self.interrupt("--record", self.path("r.h5"), "--series", self.path("s.csv"))
		if shutil.which("h5dump"):
			said = subprocess.run(["h5dump", "-H", self.path("r.h5")], stdout=subprocess.PIPE, text=True, check=True).stdout
			self.assertIn("position", said)
		with open(self.path("r.h5"), "rb") as f:
			self.assertEqual(f.read(8), b"\x89HDF\r\n\x1a\n")
		with open(self.path("s.csv")) as f:
			lines = f.read().splitlines()
		self.assertGreaterEqual(len(lines), report["steps"])
		self.assertTrue(all(line.count(",") == 9 for line in lines))

	def test_frames(self):
		if "no EGL" in program.call("--version").stdout:
			self.skipTest("no EGL")
		video = ["--out", self.path("v.mp4")] if shutil.which("ffmpeg") and shutil.which("ffprobe") else []
		report = self.interrupt("--out", self.path("f"), "--size", "64x48", "--set", "samples=1", *video,
			when=lambda: os.path.exists(self.path("f/frame-000002.png")))
		names = sorted(os.listdir(self.path("f")))
		self.assertEqual(names, [f"frame-{i:06}.png" for i in range(report["frames"])])
		for name in names:
			with open(os.path.join(self.path("f"), name), "rb") as f:
				self.assertTrue(f.read().endswith(b"IEND\xaeB`\x82"))
		if video:
			probe = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames", "-of",
				"csv=p=0", self.path("v.mp4")], stdout=subprocess.PIPE, text=True, check=True, timeout=60)
			self.assertEqual(int(probe.stdout.strip().rstrip(",")), report["frames"])

	def test_terminal(self):
		"""At a terminal Ctrl-C reaches the whole group: ffmpeg and the simulators, too."""
		words = ["--isolation", "process"]
		if shutil.which("ffmpeg") and "no EGL" not in program.call("--version").stdout:
			words += ["--out", self.path("v.mp4"), "--out", self.path("f"), "--size", "64x48", "--set", "samples=1"]
		run = program.start("run", *LONG, "--name", self.name, *words, start_new_session=True)
		self.assertTrue(program.wait_until(lambda: program.steps(self.name) > 0))
		self.assertTrue("--out" not in words or program.wait_until(lambda: os.path.exists(self.path("f/frame-000002.png"))))
		os.killpg(run.pid, signal.SIGINT)
		self.assertEqual(run.wait(program.PATIENCE), 1)
		self.assertIn("interrupted", run.stderr.read())
		run.stdout.close()
		run.stderr.close()
		if "--out" in words:
			subprocess.run(["ffmpeg", "-v", "error", "-i", self.path("v.mp4"), "-f", "null", "-"], check=True, timeout=60)


unittest.main()
