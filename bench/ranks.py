#!/usr/bin/env python3
"""Long test of one universe on several ranks of this machine: every run must end in the bits of one process.

    ranks.py OBSIM kills [N]     N times (50) kills a process of a random rank at a random moment, and resumes the run
    ranks.py OBSIM stops [N]     N times (10) stops all processes of a rank for some seconds, and continues them
    ranks.py OBSIM matrix        scenes, ranks, workers, isolation

kills: 2 to 4 ranks of 1 or 2 workers; the victim is the rank itself, its fork server, its arranger or a simulator. The
run must end within seconds, without leaving a process, universe or other file, and each other rank must have a complete
checkpoint. A random one of them is resumed by a random number of ranks. A run hit before its first checkpoint is
started again. Open MPI's launcher may hang after all its processes have ended (docs/reliability.md); it is then killed,
and counted.

Needs mpirun. Exits with 1 if a hash is wrong, a run fails, or anything is left.
"""

import collections
import glob
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scenes")
RANKS = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
	"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}
KILLED = {"falling_boxes": ["-D", "n=60", "--duration", "4"], "pile": ["--duration", ".5"], "machines": ["--duration", "2"],
	"flock": ["--duration", "2"]}
MATRIX = {"falling_boxes": ["-D", "n=1000", "--duration", "1"], "sparse": ["-D", "n=1000", "--duration", "1"],
	"pile": ["--duration", "1"], "cradle": ["--duration", "2"], "flock": ["--duration", "2"], "machines": ["--duration", "2"]}
PATIENCE = 600 # s, for one run
LAUNCHER_PATIENCE = 30  # s, once all processes that it started have ended


def words_of(scenes, name):
	return [os.path.join(FOLDER, name + ".lua"), *scenes[name], "--set", "measure=end", "--set", "sleeping=off"]


def start(obsim, ranks, words):
	"""The run's launcher, or the run itself."""
	launcher = ["mpirun", "-n", str(ranks)] if ranks else []
	return subprocess.Popen([*launcher, obsim, "run", *map(str, words), "--json", "-"], env=RANKS, stdin=subprocess.DEVNULL,
		stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def hash_of(obsim, ranks, words):
	out, said = start(obsim, ranks, words).communicate(timeout=PATIENCE)
	return json.loads(out)["state_hash"] if out else said


def stat(pid):
	"""Parent and state of a process; None: it has ended."""
	try:
		with open(f"/proc/{pid}/stat", encoding="utf-8") as f:
			words = f.read().rpartition(")")[2].split()
		return int(words[1]), words[0]
	except OSError:
		return None


def name_of(pid):
	try:
		with open(f"/proc/{pid}/comm", encoding="utf-8") as f:
			return f.read().strip()
	except OSError:
		return ""


def below(parent):
	"""All descendants of a process."""
	children = collections.defaultdict(list)
	for path in glob.glob("/proc/[0-9]*"):
		pid = int(os.path.basename(path))
		found = stat(pid)
		if found:
			children[found[0]].append(pid)
	every, ahead = [], [parent]
	while ahead:
		more = children[ahead.pop()]
		every += more
		ahead += more
	return every


def ranks_of(launcher):
	"""Processes of each rank, the rank itself first; in the order of ranks."""
	return [[pid, *below(pid)] for pid in sorted(p for p in below(launcher) if name_of(p) == "obsim")]


def traces(pids):
	"""Files left by these processes unless removed: shared memory, and their launcher's folder."""
	found = {launcher_folder(pids[0])}
	for pid in pids:
		try:
			with open(f"/proc/{pid}/maps", encoding="utf-8") as f:
				found |= {line.split()[-1] for line in f if "/dev/shm/" in line and "(deleted)" not in line}
		except OSError:
			pass
	return found


def alive(pids):
	return [pid for pid in pids if (stat(pid) or (0, "Z"))[1] != "Z"]


def launcher_folder(launcher):
	return f"/tmp/ompi.{os.uname().nodename}.{os.getuid()}/pid.{launcher}"


def end_of(run, pids):
	"""Time at which the launcher had ended, or else the last of its processes, and True if it had to be killed then."""
	began = last = time.monotonic()
	while True:
		try:
			run.communicate(timeout=.05)
			return time.monotonic(), False
		except subprocess.TimeoutExpired:
			now = time.monotonic()
			if now - began > PATIENCE:
				raise
		if alive(pids[1:]):
			last = now
		elif now - last > LAUNCHER_PATIENCE:
			run.kill()
			run.communicate()
			shutil.rmtree(launcher_folder(pids[0]), ignore_errors=True)
			return last, True


def what_is_left(pids, files, folder, ranks, hit):
	"""Leftovers after a minute at most. A process killed while writing cannot remove its unfinished files."""
	kept = {file_of(folder, r) for r in range(ranks)} | {file_of(folder, hit) + ".part"}
	end = time.monotonic() + 60
	while True:
		left = [*alive(pids), *filter(os.path.exists, files), *(set(glob.glob(os.path.join(folder, "*"))) - kept)]
		if not left or time.monotonic() > end:
			return left
		time.sleep(.01)


def file_of(folder, rank):
	return os.path.join(folder, f"run.{rank}" if rank else "run")


def whole(obsim, path):
	return subprocess.run([obsim, "inspect", path], capture_output=True, check=False).returncode == 0


def kill_one(obsim, chance, name, took, folder):
	"""True if the launcher had to be killed; then the victim, the seconds until the end of the run, an error, and the
	checkpoint of a rank that was not hit. None: the run had ended before, or had not begun to step."""
	ranks, workers = chance.randint(2, 4), chance.randint(1, 2)
	run = start(obsim, ranks, [*words_of(KILLED, name), "--workers", workers, "--checkpoint", file_of(folder, 0), "--set", "every=.1"])
	time.sleep(chance.uniform(0, took[name]))
	processes = ranks_of(run.pid)
	if len(processes) < ranks or run.poll() is not None:
		run.communicate(timeout=PATIENCE)
		return False, None
	hit, everyone = chance.randrange(ranks), [run.pid, *below(run.pid)]
	files = traces(everyone)
	victim = chance.choice(processes[hit])
	who, at = name_of(victim), time.monotonic()
	try:
		os.kill(victim, signal.SIGKILL)
	except ProcessLookupError:
		pass
	end, hung = end_of(run, everyone)
	ended, wrong = end - at, []
	left = what_is_left(everyone, files, folder, ranks, hit)
	if left:
		wrong.append(f"left: {left}")
	checkpoints = [file_of(folder, r) for r in range(ranks) if r != hit]
	if run.returncode == 0 or not any(map(os.path.exists, checkpoints)):
		return hung, None
	wrong += [f"no checkpoint: {f}" for f in checkpoints if not whole(obsim, f)]
	who = "arranger" if who == f"sim {ranks * workers}" else "simulator" if who.startswith("sim ") else {"obsim": "rank", "obsim-fork": "fork server"}.get(who, who)
	return hung, (who, ended, wrong, chance.choice(checkpoints))


def kills(obsim, count):
	chance, wrong, dealt, ended, launchers = random.Random(1), 0, collections.Counter(), [], 0
	right = {name: hash_of(obsim, 0, words_of(KILLED, name)) for name in KILLED}
	took = {}
	for name in KILLED:
		began = time.monotonic()
		hash_of(obsim, 3, [*words_of(KILLED, name), "--workers", "1"])
		took[name] = time.monotonic() - began
	while dealt.total() < count:
		name = chance.choice(list(KILLED))
		with tempfile.TemporaryDirectory() as folder:
			hung, found = kill_one(obsim, chance, name, took, folder)
			launchers += hung
			if not found:
				continue
			who, seconds, faults, file = found
			again = chance.randint(1, 4)
			state = hash_of(obsim, again if again > 1 else 0, ["--resume", file, "--workers", chance.randint(1, 2)])
		if state != right[name]:
			faults.append(f"taken up again by {again} it ends in {state}")
		dealt[who] += 1
		ended.append(seconds)
		wrong += len(faults) > 0
		if faults:
			print(f"{name}, {who} killed: {'; '.join(faults)}", flush=True)
	ended.sort()
	print(f"{dealt.total()} kills ({', '.join(f'{who} {n}' for who, n in dealt.items())}), {wrong} wrong; ended after "
		f"{ended[len(ended) // 2]:.2f} s in the median, {ended[-1]:.2f} s at most; {launchers} launchers did not end by themselves")
	return wrong


def stops(obsim, count):
	chance, wrong = random.Random(2), 0
	words = words_of(KILLED, "falling_boxes")
	right = hash_of(obsim, 0, words)
	for _ in range(count):
		run = start(obsim, 3, [*words, "--workers", "1"])
		while len(ranks_of(run.pid)) < 3 and run.poll() is None:
			time.sleep(.01)
		time.sleep(chance.uniform(.5, 1.5))
		stopped = chance.choice(ranks_of(run.pid) or [[]])
		for number, pause in (signal.SIGSTOP, chance.uniform(2, 8)), (signal.SIGCONT, 0):
			for pid in alive(stopped):
				os.kill(pid, number)
			time.sleep(pause)
		out, said = run.communicate(timeout=PATIENCE)
		if not out or json.loads(out)["state_hash"] != right:
			wrong += 1
			print(f"a rank was stopped: {out or said}", flush=True)
	print(f"{count} ranks stopped for 2 to 8 s, {wrong} wrong")
	return wrong


def matrix(obsim):
	wrong = runs = 0
	ways = [(0, isolation, workers) for isolation in ("thread", "process") for workers in (1, 2)]
	ways += [(ranks, "process", workers) for ranks in (1, 2, 3, 4) for workers in (1, 2)]
	for name in MATRIX:
		found = {}
		for ranks, isolation, workers in ways:
			found[ranks, isolation, workers] = hash_of(obsim, ranks, [*words_of(MATRIX, name), "--isolation", isolation, "--workers", workers])
		right = found[ways[0]]
		different = [way for way in ways if found[way] != right]
		wrong += len(different)
		runs += len(ways)
		print(f"{name} {' '.join(MATRIX[name])}: {right}, {len(ways)} runs, {len(different)} different {different or ''}", flush=True)
	print(f"{runs} runs, {wrong} wrong")
	return wrong


def main():
	if len(sys.argv) < 3 or sys.argv[2] not in ("kills", "stops", "matrix"):
		sys.exit(__doc__)
	obsim, what, count = sys.argv[1], sys.argv[2], [int(word) for word in sys.argv[3:]]
	if what == "matrix":
		wrong = matrix(obsim)
	else:
		wrong = kills(obsim, *count or [50]) if what == "kills" else stops(obsim, *count or [10])
	sys.exit(wrong > 0)


main()
