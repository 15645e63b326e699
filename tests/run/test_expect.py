"""Scenes with expectations: the report of their runs, and messages about expectations that are wrong."""

import json
import unittest

import program

FALL = """scene { duration = 1 }
sphere { name = "ball", radius = .1, at = { 0, 0, 10 }, velocity = { 1, 0, 0 } }
"""

# An expectation, and the line about it: file, line, remedy.
WRONG = {
	"errs": ('expect { "way", function(run)\n return nil + 1 end }', "broken.lua:4: attempt to perform arithmetic on a nil value"),
	"is no number": ('expect { "way", function(run) return 0 / 0 end }',
		'broken.lua:3: expect "way": expected a number from its function, got '),
	"returns nothing": ('expect { "way", function(run) end }',
		'broken.lua:3: expect "way": expected a number from its function, got nothing at 1 s'),
	"never ends": ('watch(function(run)\n while true do end end)',
		"broken.lua:4: stopped after 50 million instructions: does a loop never end?"),
	"grows": ('watch(function(run) local s = "x"\n while true do s = s .. s end end)', "broken.lua:4: a string grew beyond 1 MiB"),
	"names no object": ('expect { "way", worst = true, function(run)\n return run["bal"].at.x end }',
		'broken.lua:4: run: no object "bal", did you mean "ball"?'),
	"names no property": ('expect { "way", function(run) return run["ball"].place.x end }',
		'broken.lua:3: run: an object has no "place", only at, velocity'),
	"builds": ('watch(function(run)\n box { size = { 1, 1, 1 } } end)',
		"broken.lua:4: this is called while a scene is read, not afterwards: call it outside the function"),
	"keeps the run": ('local kept\nwatch(function(run) kept = run["ball"] end)\nwatch(function(run) return kept.at.x end)', None),
	"fails with nothing": ('watch(function(run) run:fail() end)', "broken.lua:3: run:fail: expected a text of 1 to 63 bytes"),
}


class Expect(program.Case):
	def scene(self, text, name="scene.lua"):
		with open(self.path(name), "w") as f:
			f.write(text)
		return self.path(name)

	def test_report(self):
		path = self.scene(FALL + """
			local steps = 0
			watch(function(run) steps = steps + 1 end)
			expect { "fall", unit = "m", below = 1e-9, source = "Galilei 1638", worst = true,
				function(run) return math.abs(run["ball"].moved.z + 9.81 / 2 * run.time ^ 2) end }
			expect { "looks", function(run) return steps end }
			expect { "speed aside", unit = "m/s", below = .5, function(run) return run["ball"].velocity.x end }
			expect { "energy", unit = "J", below = 1e-9, function(run)
				return run.energy - run["ball"].mass * (.5 + 9.81 * 10) end }
		""")
		for ways in program.ways([], ["--isolation", "process"], ["--workers", "1", "--isolation", "thread"]):
			done = program.call("run", path, *ways)
			self.assertEqual((done.returncode, done.stderr), (0, ""))
			self.assertRegex(done.stdout, r"(?m)^  expected     fall \S+ m, at most 1e-09 m: met \(Galilei 1638\)$")
			self.assertRegex(done.stdout, r"(?m)^               looks 61$")
			self.assertRegex(done.stdout, r"(?m)^               speed aside 1 m/s, at most 0.5 m/s: MISSED$")
		done = program.call("run", path, "--strict", "--json", "-")
		self.assertEqual(done.returncode, 1)
		told = {x["name"]: x for x in json.loads(done.stdout)["expectations"]}
		self.assertEqual([x["met"] for x in told.values()], [True, True, False, True])
		self.assertEqual((told["looks"]["value"], told["looks"]["below"], told["speed aside"]["value"]), (61, None, 1))
		done = program.call("run", path, "--set", "measure=end", "--strict")
		self.assertEqual(done.returncode, 0)
		self.assertIn("  expected     not judged: that takes all of the run, and --set measure=step\n", done.stdout)

	def test_failure(self):
		"""A run that fails goes on, and is judged where it failed."""
		path = self.scene(FALL + """
			watch(function(run) if run["ball"].at.z < 9 then run:fail("fell") end end)
			expect { "time", function(run) return run.time end }
		""")
		done = program.call("run", path, "--strict", "--json", "-")
		self.assertEqual(done.returncode, 1)
		told = json.loads(done.stdout)
		self.assertEqual((told["failed"], told["simulated_s"]), ("fell", 1))
		self.assertAlmostEqual(told["expectations"][0]["value"], 28 / 60)

	def test_variants(self):
		path = self.scene("""
			local this = case { runs = 2, variants = { { name = "low", height = 1 }, { name = "high", height = 2 } } }
			local ball = sphere { radius = .1, at = { this.run, 0, this.height } }
			scene { duration = 1 / 60 }
			expect { "place", function(run) return run[ball].start.at.x + 10 * run[ball].start.at.z end }
		""")
		place = lambda *more: program.report(path, *more)["expectations"][0]["value"]
		self.assertEqual((place(), place("-D", "variant=high"), place("-D", "run=1")), (10, 20, 11))
		self.refuse("run", path, "-D", "variant=lower", saying="scene.lua:2: case.variants: there is none of -D variant=lower")
		self.refuse("run", path, "-D", "run=2", saying="expected -D run= with a whole number from 0 to 1, got 2")

	def values(self, prelude, functions):
		"""Values of expressions of Lua, eight at most."""
		path = self.scene("scene { duration = 1 / 60 }\n" + prelude + "".join(
			f"expect {{ 'value {i}', function(run) return {f} end }}\n" for i, f in enumerate(functions)))
		return [x["value"] for x in program.report(path)["expectations"]]

	def test_vectors(self):
		prelude = """
			local v, w, q = vector(1, 2, 3), vector(4, -5, 6), rotation(vector(0, 0, math.pi / 2))
			local ball = sphere { radius = 1, at = 2 * v - w, velocity = -v, q = q }
		"""
		values = self.values(prelude, ["v:dot(w)", "v:cross(w):dot(v) + v:cross(w).x", "vector(3, 4, 12):norm()",
			"vector(3, 4, 12):aside()", "run[ball].start.at.y", "run[ball].start.velocity.z", "(v + w).y", "(w * 3).z"])
		self.assertEqual(values, [12, 27, 13, 5, 9, -3, -3, 18])
		values = self.values(prelude, ["(q * v).x", "(q:back(q * v) - v):norm()", "q:axis('x').y", "(q * q).z", "q:turn(vector(0, 0, math.pi / 2)).z",
			"rotation(3, 0, 0, 4).z", "run[ball].turn.w - q.w", "(run[ball].start.turn * vector(0, 1, 0)).x"])
		for value, expected in zip(values, [-2, 0, 1, 1, 1, .8, 0, -1]):
			self.assertAlmostEqual(value, expected, places=12)

	def test_library(self):
		values = self.values("ground {}\nsphere { radius = 1, at = { 0, 0, 9 } }", ["lab.splitmix(0).whole() >> 40",
			"lab.splitmix(7).within(2, 3) // 1", "lab.quadrature(function(x) return x * x end, 0, 3, 2)",
			"lab.integrate(function(y) return { y[1] } end, { 1 }, 1, 1e-12)[1]",
			"lab.follow(function(y) return { y[2], -y[1] } end, { 0, 1 })(math.pi)[2]", "lab.farthest(run)", "lab.fell(run) and 1 or 0"])
		self.assertEqual((values[0], values[1], values[6]), (0xe220a8397b1dcdaf >> 40, 2, 0))
		for value, expected in zip(values[2:6], [9, 2.718281828459045, -1, 9.81 / 2 / 3600]):
			self.assertAlmostEqual(value, expected, places=9)
		self.refuse("run", self.scene("lab.stand {}"), saying='scene.lua:1: lab: it has no "stand"')

	def test_wrong(self):
		for what, (text, saying) in WRONG.items():
			with self.subTest(what):
				done = program.call("run", self.scene(FALL + text, "broken.lua"))
				self.assertEqual(done.returncode, 2 if saying else 0, done.stderr)
				self.assertIn(saying or "", done.stderr)
				self.assertEqual(done.stderr.count("\n"), 1 if saying else 0, done.stderr)


unittest.main()
