#!/usr/bin/env python3
"""Breaks parts on purpose, again and again; every run must end in the state of an undisturbed one.

    soak.py OBSIM blows [KILLS SEGVS EXITS STOPS]    simulators die in these ways (40 20 10 5)
    soak.py OBSIM hosts [HOSTS SERVERS BOTH]         hosts and fork servers are killed (40 10 4), and runs resumed
    soak.py OBSIM scribble [RUNS]                    simulators store random words, hardened and not (60 runs of each)
    soak.py OBSIM hour [HOURS]                       one run of 1000 balls, for hours (1), with simulators that keep dying

blows: a stack and a pyramid on a shaking table, a pile, falling boxes, boxes with scripts, alternately with two workers
and with one for each object. Blows come at random moments, one or two at once; SIGSTOP emulates a hang; exits come from
within (--fault).

hosts: a run writes a checkpoint thirty times a second. When it has ended, and another has started, none of its
processes and universes may be left. The checkpoint on disk must be valid, and a resumed run must end in the same bits.

scribble: 1, 10 or 500 words at a time. A hardened run ends in the same bits. Without hardening it may be wrong, or give
up with one line, but its host survives.

hour: in real time, so that as many steps without faults, by one thread, take minutes; memory, descriptors and mappings
of host and fork server stay at their values after the first tenth.

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
SCENES = {"stack": ([], 6), "pyramid": ([], 3), "pile": (["-D", "n=3"], 3), "falling_boxes": (["-D", "n=20"], 6), "scripted": ([], 4)}  # s
BLOWS = {"killed": signal.SIGKILL, "segfault": signal.SIGSEGV, "exit": None, "stopped": signal.SIGSTOP}
BLOWS_PER_RUN = {"killed": 12, "segfault": 12, "exit": 0, "stopped": 3}
WORKERS = ["2", "objects"]
STACK = """-- Ten cubes on a shaking table: what rests would not be solved again.
box { kind = "kinematic", size = { 30, 30, 1 }, at = { 0, 0, -.5 }, path = { kind = "sine", amplitude = { .01, 0, 0 }, frequency = 1.5 } }
for i = 1, 10 do
	box { size = { 1, 1, 1 }, at = { random(-.01, .01), random(-.01, .01), i - .5 }, mass = 1000, friction = .5 }
end
"""
PYRAMID = """-- A wall of 21 cubes on a shaking table.
box { kind = "kinematic", size = { 30, 30, 1 }, at = { 0, 0, -.5 }, path = { kind = "sine", amplitude = { .02, 0, 0 }, frequency = 1.5 } }
for row = 1, 6 do
	for i = 1, 7 - row do
		box { size = { 1, 1, 1 }, at = { (i - (8 - row) / 2) * 1.05, 0, row - .5 } }
	end
end
"""
SCRIPTED = """-- Boxes that keep together, hop where they touch something, tell what they hit, and count.
scene { room = 0 } -- else each object that they might create has a worker, too
ground {}
script("hop", [[
function on_start() self.state.hops = 0 end
function on_contact(other)
	self.state.hops = self.state.hops + 1
	self:push((random() - .5) * 2, (random() - .5) * 2, 6 * self:mass() * random())
	if other then send(other, "hit", self.state.hops) end
end
function on_step(dt)
	local x, y = self:position()
	self:force(-4 * x, -4 * y, 0)
end
function on_message(from, word, hops) self:twist(0, 0, .01 * hops) end
]])
for i = 1, 10 do
	box { size = { .4, .4, .4 }, at = { .5 * (i % 4), .5 * (i // 4), .5 + .1 * i }, mass = 1, script = "hop" }
end
"""
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


WRITTEN = {"stack": STACK, "pyramid": PYRAMID, "scripted": SCRIPTED, "balls": BALLS}
folder = tempfile.TemporaryDirectory()


def path(scene):
	"""Path of one of obsim's scenes, or of those here."""
	if scene not in WRITTEN:
		return f"{HERE}/../scenes/{scene}.lua"
	file = os.path.join(folder.name, f"{scene}.lua")
	with open(file, "w") as f:
		f.write(WRITTEN[scene])
	return file


def run(obsim, *words):
	return subprocess.Popen([obsim, "run", *words, "--set", "measure=end", "--json", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def scene_words(scene, part=1):
	define, seconds = SCENES[scene]
	return [path(scene), *define, "--duration", str(part * seconds), "--set", "sleeping=off"]


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
	"""Those of the processes that remain after a while; zombies do not count."""
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
	"""Final state of each scene, and its duration with so many workers."""

	def __init__(self, obsim, scenes=tuple(SCENES), part=1):
		self.hash, self.took = {}, {}
		for scene in scenes:
			for workers in WORKERS:
				began = time.monotonic()
				out, said = run(obsim, *scene_words(scene, part), "--isolation", "process", "--workers", workers).communicate()
				ended = json.loads(out)["state_hash"] if out else sys.exit(said)
				if self.hash.setdefault(scene, ended) != ended:
					sys.exit(f"{scene}: other bits with {workers} workers, and nothing has happened to it")
				self.took[scene, workers] = time.monotonic() - began


def strike(host, number, pause):
	"""Hits one simulator, or two at once. Returns their number."""
	time.sleep(pause)
	victims = simulators(host.pid)
	if host.poll() is not None:
		return 0
	return sum(end(victim, number) for victim in random.sample(victims, min(len(victims), random.randint(1, 2))))


def blows(obsim, wanted):
	undisturbed, name = Undisturbed(obsim), f"soak-{os.getpid()}"
	wrong = turn = 0
	for (kind, number), count in zip(BLOWS.items(), wanted):
		dealt = deaths = runs = 0
		while dealt < count:
			scene, workers = list(SCENES)[turn % len(SCENES)], WORKERS[turn // len(SCENES) % 2]
			turn += 1
			faults = [] if number else ["--fault", f"exit:p={.0005 if workers == 'objects' else .004},seed={turn}"]
			host = run(obsim, *scene_words(scene), "--isolation", "process", "--workers", workers, "--set", "patience=1", "--name", name, *faults)
			for _ in range(BLOWS_PER_RUN[kind]):
				dealt += strike(host, number, random.uniform(.1, 2) * undisturbed.took[scene, workers] / BLOWS_PER_RUN[kind])
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
	"""Runs with host, fork server, or both killed; returns the errors found afterwards."""
	host = run(obsim, *scene_words(scene), *way, "--checkpoint", file, "--set", "every=.033", "--name", name)
	time.sleep(pause)
	servers = children(host.pid)
	below = servers + simulators(host.pid)
	hit = {"host": [host.pid], "server": servers, "both": [host.pid, *servers]}[victims]
	if host.poll() is None:
		for pid in hit if victims != "both" else []:
			end(pid)
		if victims == "both":  # neither has time to clean up after the other
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
			scene, workers = list(SCENES)[turn % len(SCENES)], WORKERS[turn // len(SCENES) % 2]
			way = ["--workers", workers, "--isolation", "thread" if turn // len(SCENES) % 3 == 2 else "process"]
			turn += 1
			with tempfile.TemporaryDirectory() as kept:
				file = os.path.join(kept, "run.ck")
				faults = list(killed_run(obsim, scene, way, victims, random.uniform(0, 1) * undisturbed.took[scene, workers], file, name))
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


def scribble(obsim, wanted):
	scenes, name, part = [scene for scene in SCENES if scene != "scripted"], f"soak-{os.getpid()}", .25
	undisturbed, bad = Undisturbed(obsim, scenes, part), 0
	for more in ["--harden"], []:
		stores = deaths = other = gave_up = 0
		for turn in range(wanted[0]):
			scene, workers, words = scenes[turn % 4], WORKERS[turn // 4 % 2], (1, 10, 500)[turn % 3]
			host = run(obsim, *scene_words(scene, part), "--isolation", "process", "--workers", workers, "--set", "patience=1", "--name", name, *more,
				"--fault", f"scribble:p={.0003 if workers == 'objects' else .003},words={words},seed={turn + 1}")
			out, said = host.communicate()
			report = json.loads(out) if host.returncode == 0 else {"state_hash": None, "deaths": 0, "faults": 0}
			wrong = report["state_hash"] != undisturbed.hash[scene]
			failed = host.returncode == 1
			left = os.path.exists(f"/dev/shm/obsim.{name}")
			if host.returncode not in (0, 1) or left or (more and wrong):
				bad += 1
				print(f"{scene}, {workers} workers, {words} words, seed {turn + 1} {more}: exit {host.returncode}, left: {left}, "
					f"wrong: {wrong}: {said}", flush=True)
			stores += words * report["faults"]
			deaths += report["deaths"]
			gave_up += failed
			other += wrong and not failed
		print(f"{'hardened' if more else 'not hardened'}: {wanted[0]} runs, {stores} words in those that ended, {deaths} restarts, "
			f"{gave_up} gave up, {other} ended otherwise, {bad} bad so far", flush=True)
	return bad


def holdings(pid):
	"""Memory (kB), descriptors, mappings of a process."""
	with open(f"/proc/{pid}/status") as f:
		memory = next(int(line.split()[1]) for line in f if line.startswith("VmRSS"))
	with open(f"/proc/{pid}/maps") as f:
		return memory, len(os.listdir(f"/proc/{pid}/fd")), len(f.readlines())


def hour(obsim, hours):
	with tempfile.TemporaryFile("w") as said:
		scene = path("balls")
		host = run(obsim, scene, "--isolation", "process", "--workers", "2", "--set", "patience=20", "--pace", "realtime", "--fault",
			"kill+segv+exit:p=.00005,seed=1", "--name", f"soak-{os.getpid()}")
		began, looks = time.monotonic(), []
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
		same = json.loads(run(obsim, scene, "--workers", "1", "--duration", repr(report["steps"] * report["step"])).communicate()[0])
		right = (same["steps"], same["state_hash"]) == (report["steps"], report["state_hash"])
		flat = all(m <= 1.1 * f for f, m in zip(first, most))
	print(f"{report['steps']} steps, {report['deaths']} restarts ({report['fault_kinds']}); hash {'right' if right else 'WRONG'}; "
		f"host {first[0]} kB, {first[1]} descriptors, {first[2]} mappings, at most {most[:3]}; {'flat' if flat else 'NOT FLAT'}")
	return not (right and flat)


def main():
	modes = {"blows": (blows, [40, 20, 10, 5]), "hosts": (hosts, [40, 10, 4]), "scribble": (scribble, [60])}
	if len(sys.argv) < 3 or sys.argv[2] not in (*modes, "hour"):
		sys.exit(__doc__)
	random.seed(1)
	if sys.argv[2] == "hour":
		sys.exit(hour(sys.argv[1], float(sys.argv[3]) if len(sys.argv) > 3 else 1))
	mode, usual = modes[sys.argv[2]]
	sys.exit(mode(sys.argv[1], [int(word) for word in sys.argv[3:]] or usual) > 0)


main()
