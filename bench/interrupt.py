#!/usr/bin/env python3
"""Delay of a run of many objects from SIGTERM to its end, at any point: its start, steps, measurements.

    interrupt.py OBSIM [OBJECTS [TIMES]] [OBSIM'S OPTION ...]

For each run: the CPU time before the signal, the time until the program ended, and the CPU time that it used meanwhile
(over all threads; on a busy machine that is more reliable than the clock).
"""

import os
import random
import signal
import statistics
import subprocess
import sys
import time

SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scenes")


def cpu_ms(pid):
	"""CPU time of all threads so far."""
	sum_ns = 0
	for task in os.listdir(f"/proc/{pid}/task"):
		try:
			with open(f"/proc/{pid}/task/{task}/schedstat") as f:
				sum_ns += int(f.read().split()[0])
		except OSError:
			continue
	return 1e-6 * sum_ns


def once(words, after_ms):
	run = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
	while run.poll() is None and cpu_ms(run.pid) < after_ms:
		time.sleep(.002)
	before, at = cpu_ms(run.pid), time.monotonic()
	run.send_signal(signal.SIGTERM)
	said = run.stderr.read()
	_, status, used = os.wait4(run.pid, 0)
	run.returncode = status
	wall = 1e3 * (time.monotonic() - at)
	cpu = 1e3 * (used.ru_utime + used.ru_stime) - before
	print(f"after {before:5.0f} ms of CPU: lived on for {wall:4.0f} ms, {cpu:4.0f} ms of CPU; {said.strip() or 'before it could clean up'}",
		flush=True)
	return wall, cpu


def main():
	more = sys.argv[2:]
	objects, times = [int(more.pop(0)) if more and more[0].isdigit() else default for default in (20000, 15)]
	words = [sys.argv[1], "run", os.path.join(SCENES, "falling_boxes.lua"), "-D", f"n={objects}", "--duration", "1000", *more]
	random.seed(4)
	seen = [once(words, 50 + 1000 * random.random()) for _ in range(times)]
	for i, what in enumerate(("lived on", "CPU")):
		print(f"{what}: median {statistics.median(s[i] for s in seen):.0f} ms, at most {max(s[i] for s in seen):.0f} ms")


if __name__ == "__main__":
	main()
