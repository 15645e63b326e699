"""A run that is interrupted and resumed ends in the same bits and the same figures, in any configuration of either
part, after any kind of end of the first. A checkpoint on disk is whole at any instant, or refused in one line."""

import csv
import json
import math
import os
import random
import resource
import signal
import struct
import subprocess
import time
import unittest

import program

# Figures of one process, or of its configuration; all others of a resumed run equal those of an uninterrupted one.
OWN = {"isolation", "workers", "wall_s", "cpu_s", "total_s", "body_step_cpu_us", "startup_s", "step_p50_s", "step_p90_s",
	"step_p99_s", "step_max_s", "elapsed_s", "host_cpu_s", "renderer_cpu_s", "switches", "worker_memory_bytes", "memory_bytes",
	"resumed_s", "faults", "fault_kinds", "checkpoints", "checkpoint_bytes", "checkpoint_s", "box_tests"}
WAYS = [["--isolation", i, "--workers", w] for i in ("thread", "process") for w in ("1", "2", "3", "objects")]

COME_AND_GO = """scene { title = "Come and go", duration = 2, step = 1/100 }
ground { friction = .6 }
for i = 1, 25 do
	box { size = { .3, .2, .25 }, at = { .4 * (i % 3) + .03 * i, .35 * (i % 2), .3 + .4 * (i // 6) }, born = .06 * i,
		dies = i % 3 == 0 and .06 * i + .5 or nil, restitution = i % 4 == 0 and .5 or 0, density = 100 * i }
end
sphere { radius = .3, at = { -3, 0, 1 }, velocity = { 6, .3, 1 }, born = .4 }
"""
SCENES = {
	"falling_boxes": ["-D", "n=40", "--duration", "2"],
	"pile": ["--duration", ".5"],
	"cradle": ["--duration", "1"],
	"shapes": ["--duration", "1.2"],
	"machines": ["--duration", "1.2"],
	"solids": ["--duration", "1.2"],
	"come_and_go": [],
}


def figures(report):
	"""Figures that must be equal. Each worker sums its energy, so the total differs in the last bits."""
	energy = report["energy_recovered"]
	return {k: f"{energy:.9g}" if k == "energy_recovered" else v for k, v in report.items() if k not in OWN}


class Resume(program.Case):
	def setUp(self):
		super().setUp()
		self.file = self.path("run.ck")
		with open(self.path("come_and_go.lua"), "w") as f:
			f.write(COME_AND_GO)

	def words(self, name):
		return [self.path("come_and_go.lua") if name == "come_and_go" else program.scene(name), *SCENES[name]]

	def inspect(self, file=None):
		done = program.call("inspect", file or self.file, "--json")
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		return json.loads(done.stdout)

	def finish(self, *words, file=None):
		return program.report("--resume", file or self.file, *words)

	def test_same_end(self):
		"""Interrupted at two random moments, and resumed in other configurations."""
		chance = random.Random(1)
		for name in SCENES:
			whole = program.report(*self.words(name))
			steps = [chance.randrange(1, whole["steps"]) for _ in range(2)]
			ways = chance.sample(WAYS, 3)
			with self.subTest(scene=name, steps=steps, ways=ways):
				begin = ["--checkpoint", self.file, "--duration", whole["step"] * min(steps)]
				words = [w for w in self.words(name) if w != "--duration"][:3 if name == "falling_boxes" else 1]
				first = program.report(*words, *ways[0], *begin)
				self.assertEqual(first["steps"], min(steps))
				seen = self.inspect()
				self.assertEqual((seen["steps"], seen["state_hash"], seen["objects"]), (min(steps), first["state_hash"], first["objects"]))
				middle = self.finish(*ways[1], "--checkpoint", self.file, "--duration", whole["step"] * max(steps))
				self.assertEqual(middle["resumed_s"], first["simulated_s"])
				end = self.finish(*ways[2], "--duration", whole["simulated_s"])
				self.assertEqual(figures(end), figures(whole))

	def test_knows_as_much(self):
		"""A step after a resume, at any step, the run's whole state is that of an uninterrupted one, including
		the results of narrow-phase checks. So a repeated check changes nothing."""
		scene, other = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes", "kicked.lua"), self.path("other.ck")
		for step in range(1, 16):
			words = [scene, "--set", "measure=end", "--duration"]
			program.report(*words, step / 15, "--checkpoint", self.file)
			self.finish("--duration", (step + 1) / 15, *WAYS[step % len(WAYS)], "--checkpoint", self.file)
			program.report(*words, (step + 1) / 15, "--checkpoint", other)
			self.assertEqual(program.checkpoint_areas(self.file), program.checkpoint_areas(other), step)

	def test_varying_forces(self):
		"""A sine in flight, a pulse in flight, one on a rough floor where a box has slept, and one born late: the closed form's
		momentum, and the same bits for any workers, after a resume in the middle of each pulse, and after kills."""
		scene = self.path("forces.lua")
		with open(scene, "w") as f:
			f.write("""scene { duration = 3.5, step = 1/100 }
				ground { friction = .5 }
				box { size = { 1, 1, .5 }, mass = 2, at = { 5, 0, .25 },
					varying_force = { kind = "pulse", force = { 0, 30, 0 }, from = 2.503, to = 2.807 } }
				box { size = { 1, 1, .5 }, mass = 2, at = { 5, 2, .25 } } -- is hit
				for i = 1, 8 do
					box { size = { .2, .2, .1 }, mass = 2, at = { 0, 2 * i, 50 }, force = { 0, 0, 2 * 9.81 }, born = i == 8 and 1 or 0,
						varying_force = { kind = "sine", force = { i, 0, 0 }, frequency = .5, phase = .1 * i } }
				end
				sphere { radius = .2, mass = 2, at = { -9, 0, 50 }, force = { 0, 0, 2 * 9.81 },
					varying_force = { kind = "linear", points = { { 0, 0, 0, 0 }, { 1, 0, 4, 0 }, { 1.5, 0, -4, 0 }, { 2, 0, 0, 0 } } } }""")
		whole = program.report(scene)
		self.assertIsNone(whole["energy_gain_max"])
		for way in program.ways(*WAYS):
			self.assertEqual(program.report(scene, *way)["state_hash"], whole["state_hash"], way)
		for at in ".5", "1.3", "2.5", "2.6", "2.9":
			program.report(scene, "--duration", at, "--checkpoint", self.file)
			self.assertEqual(figures(self.finish("--duration", "3.5")), figures(whole), at)
		deaths = 0
		for seed in 7, 8:
			killed = program.report(scene, "--isolation", "process", "--workers", "2", "--fault", f"kill:p=.01,seed={seed}")
			self.assertEqual(killed["state_hash"], whole["state_hash"])
			deaths += killed["deaths"]
		self.assertGreater(deaths, 0)

	def test_momentum_of_varying_forces(self):
		"""The program's own series against the integrals of the forces, at each step."""
		scene, series = self.path("forces.lua"), self.path("forces.csv")
		with open(scene, "w") as f:
			f.write("""scene { duration = 3, step = 1/100, gravity = { 0, 0, 0 } }
				box { size = { .2, .2, .1 }, mass = 2, at = { 0, 0, 0 },
					varying_force = { kind = "sine", force = { 3, 0, 0 }, frequency = .5, phase = .4 } }
				box { size = { .2, .2, .1 }, mass = 3, at = { 0, 9, 0 }, force = { 0, 1, 0 },
					varying_force = { kind = "pulse", force = { 0, 4, 0 }, from = 1.003, to = 1.297 } }
				box { size = { .2, .2, .1 }, mass = 4, at = { 0, 0, 9 }, born = 1,
					varying_force = { kind = "pulse", force = { 0, 0, 5 }, from = .5, to = .7 } }""")
		program.report(scene, "--series", series)
		w = math.pi
		with open(series) as f:
			lines = list(csv.DictReader(f))
		self.assertEqual(len(lines), 301)
		for line in lines:
			t = float(line["time_s"])
			self.assertAlmostEqual(float(line["momentum_x"]), 3 * (math.cos(.4) - math.cos(w * t + .4)) / w, delta=1e-9)
			self.assertAlmostEqual(float(line["momentum_y"]), t + 4 * min(max(t - 1.003, 0), .294), delta=1e-9)
			self.assertAlmostEqual(float(line["momentum_z"]), 5 * min(max(t - 1.5, 0), .2), delta=1e-9)

	def test_again_and_again(self):
		"""A run in thirty pieces, each from the checkpoint of the one before; the scene's file is deleted."""
		words = self.words("come_and_go")
		whole = program.report(*words)
		program.report(*words, "--duration", ".01", "--checkpoint", self.file)
		os.remove(words[0])
		for i in range(1, 30):
			self.finish("--duration", whole["simulated_s"] * i / 30, *WAYS[i % len(WAYS)], "--checkpoint", self.file)
		self.assertEqual(figures(self.finish("--duration", whole["simulated_s"])), figures(whole))

	def test_solvers(self):
		"""Each solver's warm-start data is saved, and settings and parameters are those of the first part."""
		for more in ["--set", "solver=jacobi"], ["--set", "solver=lagged", "--set", "lag=3"], ["--set", "solver=ghost"], ["--set", "integrator=ode"], \
				["--set", "substeps=3", "--set", "iterations=7"], ["--set", "narrow=aabb"], ["--set", "sleeping=off"], ["--tolerance", ".1mm"]:
			with self.subTest(more=more):
				words = [program.scene("falling_boxes"), "-D", "n=12", "--seed", "7", *more]
				whole = program.report(*words, "--duration", "1.8")
				program.report(*words, "--duration", "1.4", "--checkpoint", self.file)
				self.assertEqual(figures(self.finish("--duration", "1.8", "--isolation", "process")), figures(whole))

	def test_measured_at_the_ends(self):
		"""Only figures measured at each step of both parts are reported as maxima."""
		words = self.words("cradle")
		whole = program.report(*words, "--set", "measure=end")
		for first, second in ("end", "end"), ("end", "step"), ("step", "end"):
			program.report(*words[:1], "--duration", ".5", "--set", f"measure={first}", "--checkpoint", self.file)
			again = self.finish("--duration", words[-1], "--set", f"measure={second}")
			self.assertEqual(figures(again), figures(whole))

	def test_every(self):
		r = program.report(*self.words("come_and_go"), "--checkpoint", self.file, "--set", "every=.25")
		self.assertEqual(r["checkpoints"], 8)
		self.assertEqual(r["checkpoint_bytes"], os.path.getsize(self.file))
		self.assertGreater(r["checkpoint_s"], 0)
		self.assertEqual(os.listdir(self.directory.name).count("run.ck.part"), 0)
		# no work is left: the same report again
		self.assertEqual(figures(self.finish()), figures(r))

	def test_interrupted(self):
		"""Ctrl-C and similar signals leave a checkpoint of the step at which they ended the run."""
		for number in signal.SIGINT, signal.SIGTERM:
			run = self.start_stepping(program.scene("falling_boxes"), "-D", "n=40", "--duration", program.FOR_EVER, "--set", "sleeping=off",
				"--checkpoint", self.file, "--set", "every=1e6", "--json", self.path("r.json"), "--isolation", "process")
			time.sleep(.3)
			run.send_signal(number)
			self.assertEqual(run.wait(program.PATIENCE), 1)
			with open(self.path("r.json")) as f:
				r = json.load(f)
			seen = self.inspect()
			self.assertEqual((seen["steps"], seen["state_hash"]), (r["steps"], r["state_hash"]))
			end = (r["steps"] + 30) * r["step"]
			whole = program.report(program.scene("falling_boxes"), "-D", "n=40", "--set", "sleeping=off", "--duration", end, "--set", "measure=end")
			self.assertEqual(self.finish("--duration", end)["state_hash"], whole["state_hash"])

	def test_interrupted_in_a_long_step(self):
		"""A step that takes far longer than others ends, too, and its checkpoint is kept."""
		run = self.start_stepping(program.scene("gas"), "--duration", program.FOR_EVER, "--checkpoint", self.file, "--set", "every=1e6",
			"--json", self.path("r.json"), "--set", "narrow=aabb", "--set", "load=1000000")
		run.send_signal(signal.SIGTERM)
		self.assertEqual(run.wait(program.PATIENCE), 1)
		self.assertNotIn("no checkpoint", run.stderr.read())
		with open(self.path("r.json")) as f:
			self.assertEqual(self.inspect()["steps"], json.load(f)["steps"])

	def test_killed_while_it_writes(self):
		"""At any instant the file is a whole checkpoint, and the run goes on from it to the same end."""
		words = [program.scene("falling_boxes"), "-D", "n=40", "--duration", "2", "--set", "measure=end"]
		whole = program.report(*words)
		resumed = 0
		for i in range(12):
			run = program.start("run", *words, "--checkpoint", self.file, "--set", "every=1/60", *WAYS[i % len(WAYS)])
			if i % 2: # from the first checkpoint on; else at any time, also during the start
				self.assertTrue(program.wait_until(lambda: os.path.exists(self.file) or run.poll() is not None))
			time.sleep(.02 * i)
			below = program.processes(run.pid)
			run.kill()
			run.wait(program.PATIENCE)
			run.stdout.close()
			run.stderr.close()
			self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))))
			if not os.path.exists(self.file):
				continue
			self.inspect()
			self.assertEqual(self.finish("--set", "measure=end")["state_hash"], whole["state_hash"])
			resumed += 1
			os.remove(self.file)
		self.assertGreater(resumed, 3)

	def test_full_disk(self):
		"""A full disk costs the checkpoints, not the run; the last whole one stays. A requested checkpoint that
		is missing at the end is a failure."""
		words = [program.scene("falling_boxes"), "-D", "n=40", "--duration", "1"]
		program.report(*words, "--checkpoint", self.file)
		before = self.inspect()
		limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (16384, 16384))
		shm = "needs room in shared memory, which the limit counts, too"
		done = program.call("run", "--resume", self.file, "--duration", "2", "--checkpoint", self.file, "--set", "every=.2", preexec_fn=limit)
		self.assertEqual(done.returncode, 1, shm)
		self.assertEqual(self.inspect(), before)

	def test_output_goes_on(self):
		"""Output begins at the time of the checkpoint; frames are numbered as in an uninterrupted run."""
		words = self.words("come_and_go")
		program.report(*words, "--series", self.path("whole.csv"))
		program.report(*words, "--duration", ".5", "--series", self.path("first.csv"), "--checkpoint", self.file)
		self.finish("--duration", "2", "--series", self.path("second.csv"), "--trace", self.path("trace.json"))
		lines = {}
		for name in "whole", "first", "second":
			with open(self.path(name + ".csv")) as f:
				lines[name] = f.read().splitlines()
		self.assertEqual(lines["first"], lines["whole"][:len(lines["first"])])
		self.assertEqual(lines["second"][1:], lines["whole"][len(lines["first"]) - 1:]) # the step in common is in both
		with open(self.path("trace.json")) as f:
			json.load(f)

	def test_frames(self):
		if "no EGL" in program.call("--version").stdout:
			self.skipTest("no EGL")
		size = ["--size", "64x48", "--set", "samples=1", "--fps", "25"]
		words = self.words("come_and_go")
		program.report(*words, "--duration", ".7", *size, "--out", self.path("whole"))
		program.report(*words, "--duration", ".32", *size, "--out", self.path("parts"), "--checkpoint", self.file)
		r = self.finish("--duration", ".7", *size, "--out", self.path("parts"))
		self.assertEqual(r["frames"], 17 - 8)
		for i in range(17):
			with open(self.path(f"whole/frame-{i:06}.png"), "rb") as a, open(self.path(f"parts/frame-{i:06}.png"), "rb") as b:
				self.assertEqual(a.read(), b.read(), i)

	def test_what_is_refused(self):
		words = self.words("cradle")
		program.report(*words[:1], "--duration", ".1", "--checkpoint", self.file)
		self.refuse("run", *words[:1], "--resume", self.file, saying="a checkpoint holds its scene")
		for more in ["-D", "n=3"], ["--seed", "1"], ["--step", ".01"], ["--set", "substeps=2"], ["--arch", "obs"]:
			self.refuse("run", "--resume", self.file, *more, saying="keeps the settings that it has")
		self.refuse("run", "--resume", self.file, "--duration", ".05", saying="is at 0.1 s already")
		self.refuse("run", *words[:1], "--set", "every=1", saying="--set every needs --checkpoint")
		self.refuse("run", *words[:1], "--checkpoint", "x.ck", "--arch", "monolith", saying="a monolith cannot be resumed")
		for special in "/dev/null", "/dev/full", self.directory.name:
			self.refuse("run", *words[:1], "--checkpoint", special, saying=special)
		self.refuse("inspect", saying="no checkpoint given")
		os.mkfifo(self.path("pipe"))
		for command in ["run", "--resume"], ["inspect"]:
			self.refuse(*command, "nothing.ck", saying="nothing.ck: cannot read the checkpoint: No such file")
			self.refuse(*command, "pipe", saying="pipe: cannot read the checkpoint: it is no file, but a pipe")
			self.refuse(*command, "/dev/zero", saying="/dev/zero: cannot read the checkpoint: it is no file, but a pipe or a device")
			self.refuse(*command, words[0], saying="no checkpoint of obsim")
			self.refuse(*command, self.directory.name, saying="it is no file, but a directory")

	def test_damaged(self):
		"""Any changed byte, any missing or additional ones."""
		program.report(*self.words("cradle")[:1], "--duration", ".1", "--checkpoint", self.file)
		with open(self.file, "rb") as f:
			good = f.read()
		chance = random.Random(2)
		places = [0, 8, 12, 16, 100, 130, *(chance.randrange(len(good)) for _ in range(20))]
		bad = [good[:i] + bytes([good[i] ^ 1 << chance.randrange(8)]) + good[i + 1:] for i in places]
		bad += [good[:n] for n in (0, 1, 100, 128, 4000, len(good) - 1)] + [good + b"\0"]
		bad += [good[:12] + struct.pack("I", 99) + good[16:]]
		said = set()
		for i, data in enumerate(bad):
			if data == good:
				continue
			with open(self.path("bad.ck"), "wb") as f:
				f.write(data)
			refused = self.refuse(*(["inspect"] if i % 2 else ["run", "--resume"]), "bad.ck", saying="bad.ck: ")
			said.add(" ".join(refused.stderr.split()[2:5]))
		self.assertIn("a checkpoint of", said) # of another version

	def test_other_program(self):
		"""Another obsim says that it is another, and goes on."""
		program.report(*self.words("cradle")[:1], "--duration", ".1", "--checkpoint", self.file)
		done = program.call("run", "--resume", self.file)
		self.assertEqual((done.returncode, done.stderr), (0, ""))

	def test_two_runs_one_file(self):
		"""The second run with one file is refused; neither damages the other's checkpoints."""
		words = [program.scene("falling_boxes"), "-D", "n=20", "--duration", "2", "--set", "measure=end", "--checkpoint", self.file, "--set", "every=1/60"]
		runs = [program.start("run", *words) for _ in range(2)]
		for run in runs:
			said = run.communicate(timeout=program.PATIENCE)[1]
			self.assertIn(run.returncode, (0, 1), said)
			self.assertRegex(said, r"^(obsim: .*run\.ck\.part: another run writes it.*\n)*$")
		self.assertEqual(self.inspect()["simulated_s"], 2)


unittest.main()
