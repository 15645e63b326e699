#!/usr/bin/env python3
"""soak.py OBSIM [KILLS SEGVS ABORTS STOPS]: simulators of runs die in so many ways, and every run must end in the state of an
undisturbed one.

Stack, pyramid, pile and falling boxes, in turns with two workers and with one for each object. A blow comes at a random
moment; SIGSTOP stands for a hang. Prints a line for each kind, and exits with 1
if a hash is wrong, a run fails, or anything is left behind.
"""

import json
import os
import random
import signal
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = {"stack": ["--duration", "20"], "pyramid": ["--duration", "5"], "pile": ["--duration", "3"],
	"falling_boxes": ["-D", "n=60", "--duration", "6"]}
BLOWS = {"killed": signal.SIGKILL, "segfault": signal.SIGSEGV, "abort": signal.SIGABRT, "stopped": signal.SIGSTOP}


def run(obsim, scene, *words):
	return subprocess.Popen([obsim, "run", f"{HERE}/../scenes/{scene}.lua", *SCENES[scene], "--sleeping", "off", "--measure", "end",
		"--json", "-", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def simulators(parent):
	"""Ids of the run's simulators: children of its fork server."""
	found = []
	try:
		for server in children(parent):
			found += children(server)
	except OSError:
		pass
	return found


def children(pid):
	with open(f"/proc/{pid}/task/{pid}/children") as f:
		return [int(word) for word in f.read().split()]


def strike(host, number, pause):
	time.sleep(pause)
	victims = simulators(host.pid)
	if not victims or host.poll() is not None:
		return 0
	try:
		os.kill(random.choice(victims), number)
		return 1
	except ProcessLookupError:
		return 0


def main():
	if len(sys.argv) not in (2, 6):
		sys.exit(__doc__)
	obsim, wanted = sys.argv[1], [int(word) for word in sys.argv[2:]] or [40, 20, 10, 5]
	random.seed(1)
	undisturbed, took = {}, {}
	for scene in SCENES:
		began = time.monotonic()
		undisturbed[scene] = json.loads(run(obsim, scene).communicate()[0])["state_hash"]
		took[scene] = time.monotonic() - began
	wrong = turn = 0
	for (kind, number), count in zip(BLOWS.items(), wanted):
		dealt = deaths = runs = 0
		while dealt < count:
			scene, workers = list(SCENES)[turn % 4], ["2", "objects"][turn // 4 % 2]
			turn += 1
			name = f"soak-{os.getpid()}"
			host = run(obsim, scene, "--isolation", "process", "--workers", workers, "--patience", "1", "--name", name)
			for _ in range(1 if kind == "stopped" else 4):
				dealt += strike(host, number, random.uniform(.1, 1) * took[scene] / 4)
			out, said = host.communicate()
			report = json.loads(out) if host.returncode == 0 else {"state_hash": said, "deaths": 0}
			left = os.path.exists(f"/dev/shm/obsim.{name}")
			if report["state_hash"] != undisturbed[scene] or left:
				wrong += 1
				print(f"{scene}, {workers} workers, {kind}: {report['state_hash']}, left behind: {left}", flush=True)
			deaths += report["deaths"]
			runs += 1
		print(f"{kind}: {dealt} blows in {runs} runs, {deaths} restarts, {wrong} wrong so far", flush=True)
	sys.exit(wrong > 0)


main()
