#!/usr/bin/env python3
"""What breaks is broken on purpose, again and again, and every run must end in the state of an undisturbed one.

    soak.py OBSIM blows [KILLS SEGVS EXITS STOPS]    simulators die in so many ways (40 20 10 5)
    soak.py OBSIM hosts [HOSTS SERVERS BOTH]         hosts and fork servers are killed (40 10 4), and runs taken up again
    soak.py OBSIM hour [HOURS]                       one run of 1000 balls, for hours (1), whose simulators die all the time

blows: stack, pyramid, pile and falling boxes, in turns with two workers and with one for each object. Each comes at a random
moment; SIGSTOP stands for a hang; exits come from within (--fault). hosts: a run writes a checkpoint thirty times a second. When
it has ended, and another has started, no process of it and no universe is left; what is on the disk is a checkpoint, and ends, taken up
again, in the same bits. hour: memory, descriptors and mappings of host and fork server stay what they were after the first tenth.

Prints a line for each kind, and exits with 1 if a hash is wrong, a run fails, or anything is left behind.
"""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = {"stack": ["--duration", "20"], "pyramid": ["--duration", "5"], "pile": ["--duration", "3"],
	"falling_boxes": ["-D", "n=60", "--duration", "6"]}
BLOWS = {"killed": signal.SIGKILL, "segfault": signal.SIGSEGV, "exit": None, "stopped": signal.SIGSTOP}
BLOWS_PER_RUN = 8
WORKERS = ["2", "objects"]
BALLS = """-- A thousand balls between six walls, which never come to rest.
scene { gravity = { 0, 0, 0 }, duration = 1e6 }
for axis = 1, 3 do
	for side = -1, 1, 2 do
		local normal, at = { 0, 0, 0 }, { 0, 0, 0 }
		normal[axis], at[axis] = -side, side * 4
		plane { normal = normal, at = at, restitution = 1, friction = 0 }
	end
end
for i = 0, 999 do
	sphere { radius = .2, at = { i % 10 * .7 - 3.15, i // 10 % 10 * .7 - 3.15, i // 100 * .7 - 3.15 }, restitution = 1, friction = 0,
		velocity = { random(-1, 1), random(-1, 1), random(-1, 1) } }
end
"""


def run(obsim, *words):
	return subprocess.Popen([obsim, "run", *words, "--measure", "end", "--json", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def scene_words(scene):
	return [f"{HERE}/../scenes/{scene}.lua", *SCENES[scene], "--sleeping", "off"]


def children(pid):
	try:
		with open(f"/proc/{pid}/task/{pid}/children") as f:
			return [int(word) for word in f.read().split()]
	except OSError:
		return []


def simulators(host):
	"""Ids of the run's simulators: children of its fork server."""
	return [child for server in children(host) for child in children(server)]


def end(pid, number=signal.SIGKILL):
	try:
		os.kill(pid, number)
		return 1
	except ProcessLookupError:
		return 0


def gone(pids, seconds=120):
	"""Those of the processes that are still there after a while; zombies are not."""
	until = time.monotonic() + seconds
	while True:
		left = []
		for pid in pids:
			try:
				with open(f"/proc/{pid}/stat") as f:
					left += [pid] if f.read().rpartition(")")[2].split()[0] != "Z" else []
			except OSError:
				pass
		if not left or time.monotonic() > until:
			return left
		time.sleep(.01)


class Undisturbed:
	"""How each scene ends, and how long that takes."""

	def __init__(self, obsim):
		self.hash, self.took = {}, {}
		for scene in SCENES:
			began = time.monotonic()
			self.hash[scene] = json.loads(run(obsim, *scene_words(scene)).communicate()[0])["state_hash"]
			self.took[scene] = time.monotonic() - began


def strike(host, number, pause):
	time.sleep(pause)
	victims = simulators(host.pid)
	return end(random.choice(victims), number) if victims and host.poll() is None else 0


def blows(obsim, wanted):
	undisturbed, name = Undisturbed(obsim), f"soak-{os.getpid()}"
	wrong = turn = 0
	for (kind, number), count in zip(BLOWS.items(), wanted):
		dealt = deaths = runs = 0
		while dealt < count:
			scene, workers = list(SCENES)[turn % 4], WORKERS[turn // 4 % 2]
			turn += 1
			faults = [] if number else ["--fault", f"exit:p={.0001 if workers == 'objects' else .001},seed={turn}"]
			host = run(obsim, *scene_words(scene), "--isolation", "process", "--workers", workers, "--patience", "1", "--name", name, *faults)
			for _ in range(0 if not number else 1 if kind == "stopped" else BLOWS_PER_RUN):
				dealt += strike(host, number, random.uniform(.1, 1) * undisturbed.took[scene] / BLOWS_PER_RUN)
			out, said = host.communicate()
			report = json.loads(out) if host.returncode == 0 else {"state_hash": said, "deaths": 0, "faults": 0}
			left = os.path.exists(f"/dev/shm/obsim.{name}")
			if report["state_hash"] != undisturbed.hash[scene] or left:
				wrong += 1
				print(f"{scene}, {workers} workers, {kind}: {report['state_hash']}, left behind: {left}", flush=True)
			dealt += report["faults"]
			deaths += report["deaths"]
			runs += 1
		print(f"{kind}: {dealt} blows in {runs} runs, {deaths} restarts, {wrong} wrong so far", flush=True)
	return wrong


def killed_run(obsim, scene, way, victims, pause, file, name):
	"""A run whose host, fork server, or both are killed: what is wrong afterwards."""
	host = run(obsim, *scene_words(scene), *way, "--checkpoint", file, "--every", ".033", "--name", name)
	time.sleep(pause)
	servers = children(host.pid)
	below = servers + simulators(host.pid)
	hit = {"host": [host.pid], "server": servers, "both": [host.pid, *servers]}[victims]
	if host.poll() is None:
		for pid in hit if victims != "both" else []:
			end(pid)
		if victims == "both": # neither has time to clean up after the other
			for pid in hit:
				end(pid, signal.SIGSTOP)
			for pid in hit:
				end(pid)
	said = host.communicate()[1]
	if victims == "server" and host.returncode not in (0, 1):
		yield f"exit code {host.returncode}: {said}"
	if victims != "both" and gone(below):
		yield f"left: {gone(below, 0)}"


def hosts(obsim, wanted):
	undisturbed, name = Undisturbed(obsim), f"soak-{os.getpid()}"
	wrong = turn = 0
	for victims, count in zip(("host", "server", "both"), wanted):
		resumed = 0
		for _ in range(count):
			scene = list(SCENES)[turn % 4]
			way = [["--isolation", "process", "--workers", "2"], ["--isolation", "process", "--workers", "objects"], ["--workers", "2"]][turn // 4 % 3]
			turn += 1
			with tempfile.TemporaryDirectory() as folder:
				file = os.path.join(folder, "run.ck")
				faults = list(killed_run(obsim, scene, way, victims, random.uniform(0, 1) * undisturbed.took[scene], file, name))
				next_one = run(obsim, f"{HERE}/../scenes/stack.lua", "--duration", ".05")
				next_one.communicate()
				until = time.monotonic() + 120  # a fork server may be about to remove it
				while os.path.exists(f"/dev/shm/obsim.{name}") and time.monotonic() < until:
					time.sleep(.01)
				if os.path.exists(f"/dev/shm/obsim.{name}"):
					faults.append("its universe is left")
				if os.path.exists(file):
					resumed += 1
					if subprocess.run([obsim, "inspect", file], stdout=subprocess.DEVNULL).returncode:
						faults.append("no valid checkpoint")
					out, said = run(obsim, "--resume", file, *random.choice([[], ["--isolation", "process"], ["--workers", "objects"]])).communicate()
					if not out or json.loads(out)["state_hash"] != undisturbed.hash[scene]:
						faults.append(f"resumed, it ends otherwise: {said}")
			wrong += bool(faults)
			if faults:
				print(f"{scene}, {' '.join(way)}, {victims}: {'; '.join(faults)}", flush=True)
		print(f"{victims} killed: {count}, {resumed} taken up again, {wrong} wrong so far", flush=True)
	return wrong


def holdings(pid):
	"""Memory (kB), descriptors, mappings of a process."""
	with open(f"/proc/{pid}/status") as f:
		memory = next(int(line.split()[1]) for line in f if line.startswith("VmRSS"))
	with open(f"/proc/{pid}/maps") as f:
		return memory, len(os.listdir(f"/proc/{pid}/fd")), len(f.readlines())


def hour(obsim, hours):
	with tempfile.TemporaryDirectory() as folder:
		scene = os.path.join(folder, "balls.lua")
		with open(scene, "w") as f:
			f.write(BALLS)
		host = run(obsim, scene, "--isolation", "process", "--workers", "2", "--patience", "20", "--fault", "kill+segv+exit:p=.00002,seed=1", "--name",
			f"soak-{os.getpid()}")
		began, looks = time.monotonic(), []
		with open(os.path.join(folder, "said"), "w") as said:
			pump = subprocess.Popen(["cat"], stdin=host.stderr, stdout=said)  # one line for each death
		while host.poll() is None and time.monotonic() - began < 3600 * hours:
			time.sleep(min(60, 360 * hours))
			looks.append([*holdings(host.pid), *holdings(children(host.pid)[0])])
			print(f"{(time.monotonic() - began) / 60:.0f} min: host {looks[-1][0]} kB, {looks[-1][1]} descriptors, {looks[-1][2]} mappings; "
				f"fork server {looks[-1][3]} kB, {looks[-1][4]}, {looks[-1][5]}", flush=True)
		host.send_signal(signal.SIGTERM)
		report = json.loads(host.stdout.read())
		host.wait()
		pump.wait()
		first, most = looks[len(looks) // 10], [max(column) for column in zip(*looks)]
		same = json.loads(run(obsim, scene, "--duration", repr(report["steps"] * report["step"])).communicate()[0])
		right = (same["steps"], same["state_hash"]) == (report["steps"], report["state_hash"])
		flat = all(m <= 1.1 * f for f, m in zip(first, most))
	print(f"{report['steps']} steps, {report['deaths']} restarts ({report['fault_kinds']}); hash {'right' if right else 'WRONG'}; "
		f"host {first[0]} kB, {first[1]} descriptors, {first[2]} mappings, at most {most[:3]}; {'flat' if flat else 'NOT FLAT'}")
	return not (right and flat)


def main():
	modes = {"blows": (blows, [40, 20, 10, 5]), "hosts": (hosts, [40, 10, 4])}
	if len(sys.argv) < 3 or sys.argv[2] not in (*modes, "hour"):
		sys.exit(__doc__)
	random.seed(1)
	if sys.argv[2] == "hour":
		sys.exit(hour(sys.argv[1], float(sys.argv[3]) if len(sys.argv) > 3 else 1))
	mode, usual = modes[sys.argv[2]]
	sys.exit(mode(sys.argv[1], [int(word) for word in sys.argv[3:]] or usual) > 0)


main()
