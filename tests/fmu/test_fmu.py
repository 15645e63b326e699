"""FMUs as simulators of objects, end to end: control, the same bits after kills, and FMUs that fail alone.

test_fmu.py [SEEDS]    SEEDS: runs that are killed; 2
"""

import os
import random
import sys
import unittest
import zipfile

import program

FMUS = os.environ["FMUS"]
MACHINE = os.uname().machine
FOLDER = {2: "linux64" if MACHINE == "x86_64" else MACHINE + "-linux", 3: MACHINE + "-linux"}
SEEDS = 2
KILLS = 6

VARIABLES = {
	"hover": [("z", "input"), ("vz", "input"), ("mass", "input"), ("height", "parameter"), ("force", "output")],
	"wild": [("time", "output"), ("how", "parameter"), ("x", "output"), ("y", "output"), ("force", "output")],
	"bad": [("time", "output"), ("how", "parameter"), ("x", "output"), ("when", "parameter"), ("force", "output")],
	"dahlquist": [("time", "output"), ("x", "output"), ("der_x", "local"), ("k", "parameter"), ("force", "output")],
	"van_der_pol": [("time", "output"), ("x0", "output"), ("x1", "local"), ("mu", "parameter"), ("force", "output")],
	"bouncing_ball": [("time", "output"), ("h", "output"), ("v", "local"), ("e", "parameter"), ("force", "output")],
}


def describe(model, standard):
	keeps = 'canGetAndSetFMUstate="true" canSerializeFMUstate="true"'
	lines = []
	for reference, (name, causality) in enumerate(VARIABLES[model]):
		head = f'name="{name}" valueReference="{reference}" causality="{causality}"'
		lines.append(f"<ScalarVariable {head}><Real/></ScalarVariable>" if standard == 2 else f"<Float64 {head}/>")
	return (f'<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="{standard}.0" modelName="{model}" '
		f'{"guid" if standard == 2 else "instantiationToken"}="{{obsim}}">'
		f'<CoSimulation modelIdentifier="{model}" {keeps if standard == 2 else keeps.replace("FMUstate", "FMUState")}/>'
		f'<ModelVariables>{"".join(lines)}</ModelVariables></fmiModelDescription>')


HOVERS = """
scene { title = "FMUs", duration = 1.5, step = 1/60 }
ground {}
local height = param("height", 2)
for i = 1, 8 do
	sphere { radius = .2, at = { i % 4 + random(-.05, .05), random(-.3, .3), 1 + i / 4 }, density = 300,
		fmu = i % 2 == 0 and "hover2.fmu" or "hover3.fmu",
		inputs = { z = "position.z", vz = "velocity.z", mass = "mass" }, outputs = { force = "force.z" },
		parameters = { height = height + i / 10 } }
end
box { size = { .5, .5, .5 }, at = { 1, 0, 4 } }
"""

ALONE = """
scene { title = "one fails", duration = 1, gravity = { 0, 0, 0 } }
sphere { name = "bad", radius = .2, at = { 0, 0, 0 }, mass = 1, fmu = "bad%d.fmu", outputs = { force = "force.x" },
	parameters = { how = %d, when = .5 } }
sphere { name = "good", radius = .2, at = { 5, 0, 0 }, mass = 1, fmu = "bad%d.fmu", outputs = { force = "force.x" } }
"""


def pack(path, model, standard, library=None):
	"""Writes an FMU of a model; library: other bytes in place of its library."""
	with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as z:
		z.writestr("modelDescription.xml", describe(model, standard))
		if library is None:
			with open(os.path.join(FMUS, f"{model}{standard}.so"), "rb") as f:
				library = f.read()
		z.writestr(f"binaries/{FOLDER[standard]}/{model}.so", library)


class Fmu(program.Case):
	def setUp(self):
		super().setUp()
		for model in VARIABLES:
			for standard in 2, 3:
				pack(self.path(f"{model}{standard}.fmu"), model, standard)

	def write(self, text, name="scene.lua"):
		with open(self.path(name), "w") as f:
			f.write(text)
		return self.path(name)

	def test_control(self):
		"""Bodies come to rest at heights that their controllers were given; both standards end in the same state."""
		scene = self.write(HOVERS)
		hashes = []
		for standard in 2, 3:
			one = self.write(HOVERS.replace("hover2", f"hover{standard}").replace("hover3", f"hover{standard}"), f"{standard}.lua")
			hashes.append(program.report(one)["state_hash"])
		self.assertEqual(hashes[0], hashes[1])
		self.assertEqual(program.report(scene)["state_hash"], hashes[0])
		self.assertNotEqual(program.report(scene, "-D", "height=3")["state_hash"], hashes[0])
		report = program.report(self.write(HOVERS.replace("box {", "-- box {").replace("1.5", "20")), "--duration", "20")
		self.assertEqual(report["scripts_stopped"], 0)
		self.assertLess(report["kinetic_energy"] if "kinetic_energy" in report else 0, 1e-6)

	def test_same_bits(self):
		scene = self.write(HOVERS)
		expected = program.report(scene)["state_hash"]
		for words in (["--isolation", "thread"], ["--workers", 3], ["--workers", "objects"], ["--isolation", "process", "--workers", 2, "--harden"],
				["--isolation", "thread", "--workers", "objects"]):
			with self.subTest(words=words):
				self.assertEqual(program.report(scene, *words)["state_hash"], expected)
		program.report(scene, "--duration", ".7", "--checkpoint", self.path("half"))
		self.assertEqual(program.report("--resume", self.path("half"), "--duration", "1.5")["state_hash"], expected)

	def killed(self, scene, seed):
		"""The state's hash after a run whose simulators die KILLS times, between steps."""
		chance = random.Random(seed)
		run = self.start_universe(scene, "--seed", seed, "--isolation", "process", "--workers", 2, command="control")
		run.stdout.readline()
		led = program.Led(self.name)
		steps = 0
		for moment in sorted(chance.sample(range(1, 80), KILLS)):
			led.step(moment - steps)
			steps, before = moment, program.deaths(self.name)
			led.kill(chance.randint(1, 8))
			self.assertTrue(program.wait_until(lambda: program.deaths(self.name) > before))
		led.step(85 - steps)
		led.save(self.path("end"))
		led.close()
		self.assertEqual(run.wait(program.PATIENCE), 0)
		return program.report("--resume", self.path("end"), "--duration", "1.5")["state_hash"]

	def test_killed(self):
		scene = self.write(HOVERS)
		for seed in range(1, SEEDS + 1):
			with self.subTest(seed=seed):
				expected = program.report(scene, "--seed", seed)["state_hash"]
				self.assertEqual(self.killed(scene, seed), expected)
				within_steps = program.report(scene, "--seed", seed, "--isolation", "process", "--workers", 2, "--fault",
					f"kill:p=.004,seed={seed}") # as many as chance has it
				self.assertEqual(within_steps["state_hash"], expected)

	def test_standards_examples(self):
		"""Their outputs as forces: a mass without gravity has the velocity of the integral."""
		for model in "dahlquist", "van_der_pol", "bouncing_ball":
			hashes = set()
			for standard in 2, 3:
				scene = self.write('scene { duration = 3, gravity = { 0, 0, 0 } }\n'
					f'sphere {{ radius = .2, mass = 1, fmu = "{model}{standard}.fmu", outputs = {{ force = "force.x" }} }}\n')
				report = program.report(scene, "--series", self.path("series.csv"))
				self.assertEqual(report["scripts_stopped"], 0)
				hashes.add(report["state_hash"])
			self.assertEqual(len(hashes), 1)

	def fails_alone(self, how, saying, *words):
		for standard in (2, 3) if not program.SANITIZED else (3,):
			scene = self.write(ALONE % (standard, how, standard))
			hashes = set()
			for way in program.ways(["--workers", 1], ["--workers", 2], ["--isolation", "process"]):
				done = program.call("run", scene, *way, "--json", self.path("report.json"), *words)
				self.assertEqual(done.returncode, 0, done.stderr)
				self.assertRegex(done.stderr, rf"of object 0 \(bad\) was stopped at 0\.5 s: bad{standard}\.fmu: {saying}\n")
				with open(self.path("report.json")) as f:
					report = program.json.load(f)
				self.assertEqual(report["deaths"], 0, done.stderr)
				self.assertEqual(report["scripts_stopped"], 1)
				hashes.add(report["state_hash"])
			self.assertEqual(len(hashes), 1)

	def test_hangs(self):
		self.fails_alone(1, "it did not return within the run's patience", "--set", "patience=1")

	def test_crashes(self):
		self.fails_alone(2, r"its process was ended by SIGABRT \(Aborted\)")

	def test_leaves(self):
		self.fails_alone(5, "it ended its process with exit code 0" if not program.SANITIZED else ".*")

	def test_nan(self):
		self.fails_alone(3, "a force of -?nan, expected a number up to .*")

	def test_reports_an_error(self):
		self.fails_alone(4, "step: Error: no step.*")

	def test_rounding(self):
		"""An FMU that changes how numbers are rounded changes nothing else."""
		plain = program.report(self.write(ALONE % (2, 0, 2)))["state_hash"]
		self.assertEqual(program.report(self.write(ALONE % (2, 6, 2)))["state_hash"], plain)

	def refuse_scene(self, line, saying):
		self.refuse("run", self.write("scene {}\n" + line + "\n"), saying=saying)

	def test_refused(self):
		sphere = 'sphere { radius = 1, mass = 1, fmu = "hover2.fmu", %s }'
		self.refuse_scene(sphere % 'inputs = { hight = "position.z" }', "no real variable \"hight\", did you mean \"height\"?")
		self.refuse_scene(sphere % 'inputs = { z = "position" }', "expected a quantity, as \"position.x\"")
		self.refuse_scene(sphere % 'inputs = { z = "force.z" }', "expected a quantity")
		self.refuse_scene(sphere % 'inputs = { force = "position.z" }', "\"force\" is no input of the FMU")
		self.refuse_scene(sphere % 'parameters = { z = 1 }', "\"z\" is no parameter of the FMU")
		self.refuse_scene(sphere % 'parameters = { height = "high" }', "expected a number for \"height\"")
		self.refuse_scene(sphere % 'script = "function on_start() end"', "fmu")
		self.refuse_scene(sphere % 'static = true', "sphere.")
		self.refuse_scene('sphere { radius = 1, inputs = {} }', "sphere.inputs: expected none where there is no fmu")
		self.refuse_scene('sphere { radius = 1, fmu = "none.fmu" }', "cannot read")
		self.refuse_scene('sphere { radius = 1, fmu = "../hover2.fmu" }', "expected a file in the folder of the scene")
		self.write("no zip", "text.fmu")
		self.refuse_scene('sphere { radius = 1, fmu = "text.fmu" }', "text.fmu: it is no zip archive")
		with zipfile.ZipFile(self.path("empty.fmu"), "w") as z:
			z.writestr("modelDescription.xml", describe("hover", 2))
			z.writestr(f"binaries/{FOLDER[2]}/hover.so", "no library")
		done = program.call("run", self.write('scene { duration = .1 }\nsphere { radius = 1, fmu = "empty.fmu" }\n'))
		self.assertEqual(done.returncode, 0)
		self.assertRegex(done.stderr, "was stopped at 0 s: empty.fmu: its library cannot be loaded")
		self.assertEqual(program.call("run", self.path("scene.lua"), "--strict").returncode, 1)


if __name__ == "__main__":
	if len(sys.argv) > 1:
		SEEDS = int(sys.argv.pop(1))
	unittest.main()
