"""Random free runs: births, deaths, kills, stops by a signal for longer than the run's patience and for less, simulators that
sleep, every coupling and bound. Each comes to its end.

Arguments: the number of runs, or the first seed and the number of runs."""

import json
import os
import random
import signal
import sys
import time
import unittest

import program

NUMBERS = [int(a) for a in sys.argv[1:] if a.isdigit()]
FIRST, RUNS = [[1, 12], [1] + NUMBERS, NUMBERS][len(NUMBERS)]
STEP = 1 / 60
PATIENCE, LONG = .4, 1.2 # s


class Random(program.Case):
	def scene(self, draw):
		"""Boxes and balls that meet, some of which come and go."""
		lines = [f"scene {{ duration = {draw.choice([.1, .2, .3])} }}", "ground {}"]
		for i in range(draw.randint(2, 8)):
			life = draw.choice(["", "", f", born = {draw.uniform(0, .2):.3f}", f", dies = {draw.uniform(.05, .2):.3f}"])
			at = f"{{ {draw.uniform(-1, 1):.3f}, {draw.uniform(-1, 1):.3f}, {.6 * i + .4:.3f} }}"
			velocity = f"{{ {draw.uniform(-5, 5):.3f}, {draw.uniform(-5, 5):.3f}, 0 }}"
			shape = draw.choice(["box { size = { .5, .5, .5 }", "sphere { radius = .25"])
			lines.append(f"{shape}, at = {at}, velocity = {velocity}{life} }}")
		if draw.random() < .3:
			lines.append("box { size = { 1, .2, .2 }, at = { 0, 0, .3 }, kind = 'kinematic', spin = { 0, 0, 5 } }")
		path = self.path("scene.lua")
		with open(path, "w") as f:
			f.write("\n".join(lines) + "\n")
		return path

	def options(self, draw, seed):
		words = ["--sync", "free", "--seed", seed, "--set", "measure=end", "--workers", draw.choice([1, 2, 3, "objects"])]
		if draw.random() < .5:
			words += ["--set", "coupling=own", "--set", f"update_rate={draw.choice([60, 100, 333, 1000])}",
				"--set", f"jitter={draw.choice([0, .3, .9])}"]
			words += draw.choice([[], ["--set", "max_lag=none"], ["--set", "max_lag=.0005"], ["--set", "max_lag=.05"]])
			words += draw.choice([[], ["--set", "delay=.002"]])
		words += draw.choice([[], [], ["--pace", 2]])
		isolation = draw.choice(["thread", "process"])
		faults = [None, f"slow:p=.01,ms=3,seed={seed}"]
		faults += [f"kill:p=.004,seed={seed}"] * 2 if isolation == "process" else []
		fault = draw.choice(faults)
		return words + ["--isolation", isolation] + (["--fault", fault] if fault else [])

	def stop_now_and_then(self, draw, run, longest):
		"""Stops simulators, or all that are threads, one at a time until the run's end; one of them for the longest time (s), if
		there is one. Returns the number of stops."""
		stops, left = 0, longest
		while run.poll() is None:
			pids = program.simulators(run.pid) or [run.pid]
			pid = draw.choice(pids)
			try:
				os.kill(pid, signal.SIGSTOP)
				time.sleep(left.pop() if left and pid != run.pid else draw.choice([.001, .01, .1]))
				os.kill(pid, signal.SIGCONT)
				stops += 1
			except ProcessLookupError:
				pass # it was killed, or has ended
			time.sleep(draw.uniform(0, .02))
		return stops

	def test_each_ends(self):
		deaths = stalls = stops = 0
		for seed in range(FIRST, FIRST + RUNS):
			draw = random.Random(seed)
			scene, words = self.scene(draw), self.options(draw, seed)
			kill = draw.random() < .5 and "process" in words # a thread cannot be killed
			words += ["--set", f"patience={PATIENCE}"] + ([] if "--pace" in words else ["--pace", .5]) if kill else [] # or it ends at once
			run = program.start("run", scene, *words, "--json", self.path("r.json"))
			stops += self.stop_now_and_then(draw, run, [LONG] if kill else []) if kill or draw.random() < .5 else 0
			_, errors = run.communicate(timeout=program.PATIENCE)
			self.assertEqual(run.returncode, 0, (seed, words, errors))
			with open(self.path("r.json")) as f:
				r = json.load(f)
			self.assertEqual(r["outcome"], "finished", (seed, words))
			self.assertAlmostEqual(r["simulated_s"], r["steps"] * STEP, delta=1e-9)
			deaths += r["deaths"]
			stalls += sum(d["cause"] == "stall" for d in r.get("death_list", []))
		print(f"{RUNS} runs from seed {FIRST} on, {deaths} deaths, {stalls} of stalls, {stops} stops", file=sys.stderr)


if __name__ == "__main__":
	unittest.main(argv=sys.argv[:1])
