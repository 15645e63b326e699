"""--trace: a file that importers of the Trace Event Format accept, with all events of the run."""

import collections
import json
import os
import re
import signal
import time
import unittest

import program

WAYS = [["--isolation", i, "--workers", w] for i in ("thread", "process") for w in ("2", "objects")]
HOST, WORKERS, OBJECTS = 1, 2, 3  # "processes" of the file
PHASES = {"gate", "solve", "objects", "schedule", "world"}
STATES = {"flies", "touches", "asleep", "awake"}
FREE = {"steps", "lag", "clock", "host"}  # phases of a free run
PARTS = {"ballistic", "load", "narrowphase", "impacts", "solve", "move", "project", "publish"}


class Trace(program.Case):
	def read(self, path):
		"""The file's events by track; checks the format of each."""
		with open(path) as f:
			whole = json.load(f)
		self.assertEqual(set(whole), {"displayTimeUnit", "traceEvents", "otherData"})
		tracks = collections.defaultdict(list)
		self.names = {}
		self.process_names = {}
		for e in whole["traceEvents"]:
			self.assertLessEqual({"ph", "pid", "name"}, set(e))
			if e["ph"] == "M":
				if e["name"] == "thread_name":
					self.names[e["pid"], e["tid"]] = e["args"]["name"]
				if e["name"] == "process_name":
					self.process_names[e["pid"]] = e["args"]["name"]
				continue
			self.assertIn(e["ph"], "Xi")
			self.assertIsInstance(e["tid"], int)
			self.assertGreaterEqual(e["ts"], 0)
			self.assertEqual(8 * e["ts"] % 1, 0, "no eighth of a microsecond")
			if e["ph"] == "i":
				self.assertEqual(e["s"], "t")
			else:
				self.assertGreaterEqual(e["dur"], 0)
				self.assertEqual(8 * e["dur"] % 1, 0)
			tracks[e["pid"], e["tid"]].append(e)
		self.assertEqual(set(self.process_names), {HOST, WORKERS, OBJECTS})
		self.assertLessEqual(set(tracks), set(self.names), "a track without a name")
		tids = [t for _, t in self.names]
		self.assertEqual(len(set(tids)), len(tids), "two tracks share a number")
		self.other = whole["otherData"]
		return tracks

	def check_nesting(self, events):
		"""After a stable sort by time, as importers do, each span lies in the one around it or after it. Adds
		its depth."""
		around = []
		for e in sorted(events, key=lambda e: e["ts"]):
			while around and around[-1]["ts"] + around[-1].get("dur", 0) <= e["ts"]:
				around.pop()
			if around:
				self.assertLessEqual(e["ts"] + e.get("dur", 0), around[-1]["ts"] + around[-1]["dur"], (e, around[-1]))
			e["depth"] = len(around)
			if e["ph"] == "X":
				around.append(e)

	def check_worker(self, events, deaths, known=PHASES):
		spans = sorted((e for e in events if e["ph"] == "X"), key=lambda e: (e["ts"], e["depth"]))
		phases = [e for e in spans if e["depth"] == 0]
		self.assertLessEqual({e["name"] for e in phases}, known)
		self.assertTrue({e["name"] for e in phases} & {"gate", "host"})
		gaps = [after["ts"] for before, after in zip(phases, phases[1:]) if before["ts"] + before["dur"] != after["ts"]]
		self.assertLessEqual(len(gaps), len(deaths), "a gap between phases, and all were alive")
		for end, death in zip(gaps, deaths):
			self.assertGreater(end, death)
		for e in spans:
			if e["depth"] > 0:
				self.assertIn(e["name"], PARTS | {"chunk", "island", "estimate"})
			if e["name"] == "chunk":
				self.assertEqual(e["depth"], 1)

	def check_object(self, events):
		"""One state after the other, from birth to death or to the end of the run."""
		states = sorted((e for e in events if e["ph"] == "X"), key=lambda e: e["ts"])
		self.assertLessEqual({e["name"] for e in states}, STATES)
		for before, after in zip(states, states[1:]):
			self.assertEqual(before["ts"] + before["dur"], after["ts"], "a gap between states")
			self.assertNotEqual(before["name"], after["name"])
		instants = collections.Counter(e["name"] for e in events if e["ph"] == "i")
		self.assertEqual(instants["birth"], 1)
		asleep = sum(e["name"] == "asleep" for e in states)
		self.assertEqual(instants["falls asleep"], asleep)
		return states

	def check(self, path, steps):
		tracks = self.read(path)
		computed = set()
		deaths = sorted(e["ts"] for events in tracks.values() for e in events if e["name"] == "dies")
		for (pid, tid), events in tracks.items():
			self.check_nesting(events)
			if pid == WORKERS:
				self.check_worker(events, deaths)
				computed |= {e["args"]["step"] for e in events if "step" in e.get("args", {}) and e["name"] != "objects"}
			if pid == OBJECTS:
				self.check_object(events)
		self.assertGreaterEqual(min(computed), 1)
		self.assertLessEqual(max(computed), steps)
		return tracks, computed

	def test_every_way(self):
		words = [program.scene("falling_boxes"), "-D", "n=20", "--duration", "2"]
		plain = program.report(*words)
		self.assertEqual((plain["trace_events"], plain["trace_lost"]), (0, 0))
		for way in WAYS:
			with self.subTest(way=way):
				r = program.report(*words, *way, "--trace", self.path("t.json"))
				self.assertEqual(r["state_hash"], plain["state_hash"], "to be watched must change nothing")
				tracks, computed = self.check(self.path("t.json"), r["steps"])
				self.assertGreater(len(computed), r["steps"] / 2, "all fly for a while: such steps need no one")
				self.assertEqual((r["trace_lost"], self.other["lost"]), (0, 0))
				self.assertEqual(self.other["events"], r["trace_events"])
				workers = sum(pid == WORKERS for pid, _ in tracks)
				self.assertGreaterEqual(workers, 21 if "objects" in way else 2)
				self.assertEqual(sum(pid == OBJECTS for pid, _ in tracks), 21)
				names = collections.Counter(e["name"] for events in tracks.values() for e in events)
				self.assertLessEqual({"gate", "schedule", "objects", "flies", "touches", "snapshot", "measure"} | PARTS,
					set(names) | {"impacts"})
				self.assertEqual(names["measure"], r["steps"] + 1)

	def test_explained(self):
		"""Both read the clock at the same places."""
		done = program.call("run", program.scene("pile"), "--duration", ".5", "--explain", "--report", "full", "--trace", self.path("t.json"))
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		self.check(self.path("t.json"), 1000)
		self.assertRegex(done.stdout, r"trace +\d+ events\n")

	def test_sleep(self):
		r = program.report(program.scene("falling_boxes"), "-D", "n=8", "--duration", "8", "--trace", self.path("t.json"))
		tracks, computed = self.check(self.path("t.json"), r["steps"])
		objects = [events for (pid, _), events in tracks.items() if pid == OBJECTS]
		asleep = sum(any(e["name"] == "falls asleep" for e in events) for events in objects)
		self.assertEqual(asleep, 8)
		self.assertLess(len(computed), r["steps"], "steps in which all sleep are not computed")

	def test_births_and_deaths(self):
		with open(self.path("s.lua"), "w") as f:
			f.write('scene { title = "t", duration = 1 }\nground {}\n'
				'box { name = "first", size = { 1, 1, 1 }, at = { 0, 0, .5 } }\n'
				'box { name = "on it", size = { 1, 1, 1 }, at = { 0, 0, 1.6 }, dies = .5 }\n'
				'box { name = "late", size = { 1, 1, 1 }, at = { 3, 0, .5 }, born = .3 }\n')
		for way in WAYS:
			with self.subTest(way=way):
				r = program.report(self.path("s.lua"), *way, "--trace", self.path("t.json"))
				tracks, _ = self.check(self.path("t.json"), r["steps"])
				by_name = {self.names[t].split(" ", 1)[1]: events for t, events in tracks.items() if t[0] == OBJECTS}
				span = lambda name: (min(e["ts"] for e in by_name[name]),
					max(e["ts"] + e.get("dur", 0) for e in by_name[name]))
				self.assertEqual([e["name"] for e in by_name["on it"]].count("death"), 1)
				self.assertLess(span("on it")[1], span("first")[1])
				self.assertGreater(span("late")[0], span("first")[0])
				self.assertLess(span("late")[0], span("on it")[1])

	def test_free_run(self):
		"""Steps, and who waits for whom: for one that it may touch."""
		words = [program.scene("stack"), "-D", "n=4", "--duration", ".5", "--sync", "free", "--set", "coupling=own", "--set", "update_rate=240"]
		for way in WAYS:
			with self.subTest(way=way):
				r = program.report(*words, *way, "--trace", self.path("t.json"))
				tracks, steps, waits = self.read(self.path("t.json")), 0, 0
				for (pid, _), events in tracks.items():
					self.check_nesting(events)
					if pid == WORKERS:
						self.check_worker(events, [], FREE)
					if pid == OBJECTS:
						self.check_object(events)
					for e in events:
						steps += e["args"]["steps"] if e["name"] == "steps" else 0
						waits += e["name"] == "lag"
						if e["name"] == "lag":
							self.assertEqual(abs(e["args"]["object"] - e["args"]["waits_for"]), 1, "neighbours in the stack")
				self.assertEqual(steps, r["updates"])
				self.assertTrue(waits <= r["waits"] and (waits > 0) == (r["waits"] > 0), (waits, r["waits"]))
				self.assertEqual(self.other["lost"], 0)

	def test_monolith(self):
		r = program.report(program.scene("falling_boxes"), "-D", "n=20", "--duration", "2", "--arch", "monolith", "--trace",
			self.path("t.json"))
		tracks, computed = self.check(self.path("t.json"), r["steps"])
		self.assertEqual(computed, set(range(1, r["steps"] + 1)))
		worlds = [e for events in tracks.values() for e in events if e["name"] == "world"]
		self.assertEqual(len(worlds), r["steps"])

	def test_frames(self):
		done = program.call("run", program.scene("stack"), "--duration", ".2", "--out", self.path("f"), "--size", "64x48",
			"--fps", "30", "--record", self.path("r.h5"), "--trace", self.path("t.json"))
		if "EGL" in done.stderr or "without a renderer" in done.stderr:
			self.skipTest("no EGL")
		self.assertEqual(done.returncode, 0, done.stderr)
		tracks, _ = self.check(self.path("t.json"), 1000)
		spans = [e for (pid, _), events in tracks.items() if pid == HOST for e in events]
		for name in "draw", "encode":
			self.assertEqual([e["args"]["frame"] for e in spans if e["name"] == name], list(range(6)))
		self.assertIn("record", {e["name"] for e in spans})

	def successor_events(self, path):
		"""How many events the file has, so far, of a dead simulator's successor."""
		with open(path, encoding="utf-8", errors="replace") as f:
			text = f.read()
		events = [(m[1], float(m[2])) for m in re.finditer(r'"tid":(\d+),.*?"ts":([\d.]+)', text)]
		death = re.search(r'"tid":(\d+),.*?"ts":([\d.]+),"name":"dies"', text)
		return sum(track == death[1] and ts > float(death[2]) for track, ts in events)

	def says(self, path, what):
		with open(path, encoding="utf-8", errors="replace") as f:
			return what in f.read()

	def test_killed(self):
		"""The file has a simulator's events before it was killed, the kill, and its successor's events."""
		for workers in "2", "objects":
			with self.subTest(workers=workers):
				path = self.path(workers + ".json")
				run = self.start_universe(program.scene("falling_boxes"), "-D", "n=20", "--duration", program.FOR_EVER, "--set", "sleeping=off", "--isolation", "process", "--workers", workers, "--trace", path)
				grown = lambda: os.path.exists(path) and os.path.getsize(path) > 400000 # a hundred events for each worker
				self.assertTrue(program.wait_until(grown, program.PATIENCE))
				os.kill(max(program.simulators(run.pid)), signal.SIGKILL)
				self.assertTrue(program.wait_until(lambda: self.says(path, '"dies"'), program.PATIENCE))
				self.assertTrue(program.wait_until(lambda: self.successor_events(path) > 20, program.PATIENCE))
				run.send_signal(signal.SIGINT)
				self.assertEqual(run.wait(program.PATIENCE), 1)
				tracks, computed = self.check(path, 10**9)
				self.assertGreater(len(computed), 10)
				dead = [(t, e) for t, events in tracks.items() for e in events if e["name"] == "dies"]
				self.assertEqual([e["args"] for _, e in dead], [{"signal": "KILL"}])
				ends = [e["ts"] + e.get("dur", 0) - dead[0][1]["ts"] for e in tracks[dead[0][0]]]
				self.assertGreater(sum(t < 0 for t in ends), 10)
				self.assertGreater(sum(t > 0 for t in ends), 10)

	def test_host_killed(self):
		"""A host that is killed ends no span, and the file is whole all the same, except after a kill between
		two pages of a write (trace_file.h), which is rare: then only the last events are missing."""
		torn = 0
		for i in range(8):
			path = self.path(f"{i}.json")
			run = self.start_universe(program.scene("falling_boxes"), "-D", "n=20", "--duration", program.FOR_EVER, "--set", "sleeping=off", "--isolation", "thread", "--trace", path)
			self.assertTrue(program.wait_until(lambda: os.path.exists(path) and os.path.getsize(path) > 20000 * i))
			run.kill()
			run.wait(program.PATIENCE)
			self.assertTrue(program.wait_until(lambda: not os.path.exists(program.segment(self.name))))
			with open(path) as f:
				text = f.read()
			try:
				whole = json.loads(text)
				self.assertEqual(whole["otherData"], {"unfinished": True})
			except json.JSONDecodeError:
				whole = json.loads(text[:text.rindex(",\n{")] + "]}")
				torn += 1
			self.assertGreaterEqual(len(whole["traceEvents"]), 1)
		self.assertLessEqual(torn, 1)

	def test_pipe(self):
		"""A file that cannot be overwritten gets its end once."""
		os.mkfifo(self.path("pipe"))
		run = program.start("run", program.scene("stack"), "--duration", ".1", "--trace", self.path("pipe"))
		with open(self.path("pipe")) as f:
			whole = json.load(f)
		self.assertEqual(run.wait(program.PATIENCE), 0)
		run.stdout.close()
		run.stderr.close()
		self.assertEqual(set(whole["otherData"]), {"events", "lost"})

	def test_interrupted(self):
		run = self.start_stepping(program.scene("falling_boxes"), "-D", "n=20", "--duration", program.FOR_EVER, "--set", "sleeping=off",
			"--trace", self.path("t.json"))
		time.sleep(.3)
		run.send_signal(signal.SIGINT)
		self.assertEqual(run.wait(program.PATIENCE), 1)
		self.check(self.path("t.json"), 10**9)

	def test_refused(self):
		stack = program.scene("stack")
		self.refuse("run", stack, "--trace", "no/such/t.json", saying="--trace no/such/t.json")
		self.refuse("run", stack, "--trace", "-", saying="--trace: cannot write to standard output")
		self.refuse("run", stack, "--trace", "a", "--json", "a", saying="both write a")
		self.refuse("compare", stack, "--trace", "a", saying="--trace")
		done = program.call("run", stack, "--duration", ".1", "--trace", "/dev/full")
		self.assertEqual(done.returncode, 1)
		self.assertIn("/dev/full: No space left", done.stderr)


unittest.main()
