"""FMUs that misbehave at any moment: their object alone fails, it is named, and the hash of all others is that of a calm run.

test_wild.py [all]    all: each deed at each moment in each way of running; else a few of each
"""

import itertools
import json
import os
import random
import signal
import sys
import time
import unittest

import program
import test_fmu

ALL = False

# Objects: one whose FMU misbehaves, and has no effect otherwise; another with the same FMU; two with others.
SCENE = """
scene { title = "one is wild", duration = .5, step = 1/60, gravity = { 0, 0, -9.81 } }
sphere { name = "bad", radius = .2, at = { 0, 0, 9 }, mass = 1, fmu = "%(wild)s" }
if param("peer", 0) == 1 then
	sphere { name = "peer", radius = .2, at = { 0, 2, 9 }, mass = 1, fmu = "%(wild)s", outputs = { force = "force.x" },
		parameters = { how = 0 } }
end
for i = 1, 4 do
	sphere { radius = .2, at = { 2 * i, 0, 3 }, density = 300, fmu = i %% 2 == 0 and "hover2.fmu" or "hover3.fmu",
		inputs = { z = "position.z", vz = "velocity.z", mass = "mass" }, outputs = { force = "force.z" } }
end
"""

EARLY = "load", "instantiate", "initialize"
MOMENTS = EARLY + ("step", "state")
NEVER = "free", "unload"  # no FMU comes to them: its process is killed
CODES = [*range(0, 21), 64, 77, 126, 127, 137, 255]
SIGNALS = [signal.SIGSEGV, signal.SIGBUS, signal.SIGFPE, signal.SIGILL, signal.SIGABRT, signal.SIGTERM, signal.SIGALRM,
	signal.SIGKILL]
PATIENCE = "it did not return within the run's patience"
OTHERS = r"its process was ended by SIGSYS \(Bad system call\).*: it starts no process, and sends no signal to others"
# Deeds, and what is said of them; None: they do no harm.
EXITS = {**{f"exit {code}": f"exit code {code}" for code in CODES}, "_exit 3": "exit code 3"}
if program.SANITIZED:  # its leak detector starts a process at exit
	EXITS = {deed: f"{said}|SIGSYS" for deed, said in EXITS.items()}
DEEDS = {
	**EXITS,
	**{f"signal {int(s)}": f"its process was ended by {s.name}" for s in SIGNALS},
	f"signal {int(signal.SIGSTOP)}": PATIENCE,
	"hang": PATIENCE,
	"sleep": PATIENCE,
	"fork": OTHERS,
	"system": OTHERS,
	"kill": OTHERS,
	"overflow": "its process was ended by SIGSEGV",
	"flood": None,
	"close": None,
	"handlers": None,
}
FEW = ["exit 0", f"signal {int(signal.SIGSEGV)}", "flood", "hang", "fork"]
WAYS = {"threads": ["--isolation", "thread"], "processes": ["--isolation", "process"], "hardened": ["--harden"],
	"one each": ["--workers", "objects"]}


class Wild(program.Case):
	def setUp(self):
		super().setUp()
		for model in "hover", "wild":
			for standard in 2, 3:
				test_fmu.pack(self.path(f"{model}{standard}.fmu"), model, standard)
		self.tag = f"obsim-test-{os.getpid()}-{id(self)}"
		self.calm = {}

	def scene(self, wild):
		name = self.path(wild + ".lua")
		if not os.path.exists(name):
			with open(name, "w") as f:
				f.write(SCENE % {"wild": wild})
		return name

	def run_scene(self, wild, peer, *words, env=None):
		path = self.path("report.json")
		done = program.call("run", self.scene(wild), "-D", f"peer={peer}", "--json", path, *words,
			env={**os.environ, "WILD_TAG": self.tag, **(env or {})}, errors="replace")
		self.assertEqual(done.returncode, 0, done.stderr)
		with open(path) as f:
			return done, json.load(f)

	def calm_hash(self, wild, peer):
		if (wild, peer) not in self.calm:
			self.calm[wild, peer] = self.run_scene(wild, peer)[1]["state_hash"]
		return self.calm[wild, peer]

	def check_remains(self):
		"""No process of an FMU has outlived its run."""
		for pid in filter(str.isdigit, os.listdir("/proc")):
			try:
				with open(f"/proc/{pid}/environ", "rb") as f:
					self.assertFalse(self.tag.encode() in f.read() and program.alive(pid), program.comm(pid))
			except OSError:
				pass

	def check(self, moment, deed, said, way, standard):
		peer = 0 if moment in EARLY else 1
		wild = f"wild{standard}.fmu"
		done, report = self.run_scene(wild, peer, *way, "--set", "patience=1", env={"WILD": f"{moment} {deed}"})
		self.assertEqual(report["state_hash"], self.calm_hash(wild, peer), done.stderr)
		self.assertEqual(report["deaths"], 0)
		self.assertEqual(report["scripts_stopped"], 1 if said else 0, done.stderr)
		if said:
			self.assertRegex(done.stderr, rf"the script of object 0 \(bad\) was stopped at [0-9.]+ s: {wild}: .*({said})")
			self.assertEqual([(e["object"], e["name"]) for e in report["script_errors"]], [(0, "bad")])
			self.assertRegex(report["script_errors"][0]["what"], rf"{wild}: .*({said})")
			if moment == "load":
				self.assertIn("while its library was loaded", done.stderr)
		self.assertLess(len(done.stderr), 12000)
		self.assertTrue(done.stderr.replace("\n", "").isprintable(), done.stderr)
		if deed == "flood" and moment not in NEVER:
			self.assertIn(f"{wild}: ", done.stderr)
			self.assertIn("the rest of its output is left out", done.stderr)
		self.check_remains()

	def test_moments(self):
		cases = itertools.product(MOMENTS + NEVER, DEEDS if ALL else FEW, WAYS, (2, 3))
		if not ALL:  # each deed and each moment at least twice
			ways, deeds = itertools.cycle(itertools.product(WAYS, (2, 3))), itertools.cycle(FEW)
			cases = [(moment, next(deeds), *next(ways)) for moment in MOMENTS + NEVER for _ in range(2)]
		for moment, deed, way, standard in cases:
			said = None if moment in NEVER else DEEDS[deed]
			with self.subTest(moment=moment, deed=deed, way=way, standard=standard):
				self.check(moment, deed, said, WAYS[way], standard)

	def test_thread_of_its_own(self):
		"""A thread that ends the process later ends that of other turns, too: they are tried again."""
		for way in list(WAYS.values())[:None if ALL else 1]:
			done, report = self.run_scene("wild2.fmu", 1, *way, env={"WILD": "step thread"})
			self.assertEqual(report["state_hash"], self.calm_hash("wild2.fmu", 1), done.stderr)
			self.assertLessEqual(report["scripts_stopped"], 1)
			self.check_remains()

	def test_killed_from_outside(self):
		"""Whoever kills processes of FMUs changes nothing."""
		words = "--duration", 4
		expected = self.run_scene("wild2.fmu", 1, *words)[1]["state_hash"]
		for way in list(WAYS.values())[:None if ALL else 1]:
			run = program.start("run", self.scene("wild2.fmu"), "-D", "peer=1", *words, *way, "--pace", "1", "--json",
				self.path("report.json"))
			kills = 0
			while run.poll() is None:
				for pid in program.processes(run.pid):
					if program.comm(pid) == "obsim-fmu":
						try:
							os.kill(pid, signal.SIGKILL)
							kills += 1
						except ProcessLookupError:
							pass
				time.sleep(.05)
			self.assertEqual(run.returncode, 0, run.communicate()[1])
			self.assertGreater(kills, 3)
			with open(self.path("report.json")) as f:
				report = json.load(f)
			self.assertEqual((report["state_hash"], report["scripts_stopped"]), (expected, 0))
			run.communicate()

	def test_damaged_library(self):
		"""A library that is cut short, or of which some bytes are others, and one that is none."""
		with open(os.path.join(test_fmu.FMUS, "wild2.so"), "rb") as f:
			whole = f.read()
		chance = random.Random(1)
		expected = self.calm_hash("wild2.fmu", 0)
		for i in range(100 if ALL else 4):
			library = bytearray(whole)
			if i % 2 == 0:
				del library[chance.randrange(len(whole)):]
			for _ in range(chance.randrange(1, 40) if i % 2 else 0):
				library[chance.randrange(len(library))] = chance.randrange(256)
			name = f"mutant{i}.fmu"
			test_fmu.pack(self.path(name), "wild", 2, bytes(library))
			way = [*WAYS.values()][i // 2 % len(WAYS)]
			with self.subTest(i=i, way=way):
				done, report = self.run_scene(name, 0, *way, "--set", "patience=2")
				self.assertEqual(report["state_hash"], expected, done.stderr)
				self.assertEqual(report["scripts_stopped"], len([line for line in done.stderr.splitlines() if name in line and
					"object 0 (bad) was stopped at" in line]), done.stderr)
				self.check_remains()


if __name__ == "__main__":
	if len(sys.argv) > 1 and sys.argv[1] == "all":
		ALL = sys.argv.pop(1)
	unittest.main()
