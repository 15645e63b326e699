"""Scripts that steer kinematic objects: by velocities, paths and running surfaces; and the same bits in any configuration, with
deaths, and after a resume."""

import math
import re
import unittest

import configurations
import program

# A platform carries a box to and fro, and looks for a turn in each step. A lift follows paths with a ball on it. A belt changes
# its direction. A turntable begins to turn, and stops, with a cube on it. At last the platform stands for good.
SCENE = """
scene { duration = 1, gravity = { 0, 0, -9.81 } }
ground {}
script("platform", [[
function on_step()
	local x = self:position()
	if time() > .8 then self:set_velocity(0, 0, 0)
	elseif time() == 0 then self:set_velocity { 1, 0, 0 }
	elseif x > .3 then self:set_velocity { -1, 0, 0 }
	elseif x < -.05 then self:set_velocity { 1, 0, 0 } end
end
]])
script("lift", [[
function on_start()
	self:set_path { points = { { .2, 4, 0, 1.05 }, { .4, 4, 0, 1 } }, loop = true }
	self:wake(.6)
end
function on_wake() self:set_path { points = { { .3, 4, .1, 1.2, 1, 0, 0, 0 } } } end
]])
script("belt", [[
function on_start() self:set_surface_velocity(.5, 0, 0) self:wake(.5) end
function on_wake() self:set_surface_velocity { -.5, 0, 0 } end
]])
script("table", [[
function on_start() self:set_spin(0, 0, 2) self:wake(.7) end
function on_wake() self:set_spin(0, 0, 0) end
]])
script("reader", [[
function on_step(dt)
	if time() + 1.5 * dt > self.state.next then
		self.state.next = self.state.next + .1
		for _, name in ipairs { "platform", "rider", "lift", "passenger", "parcel", "cube" } do
			print(name, time(), find(name):position())
		end
	end
end
]])
local function mover(fields) fields.kind = "kinematic" box(fields) end
mover { name = "platform", size = { 1, 1, .2 }, at = { 0, 0, 1 }, friction = 1, script = "platform" }
box { name = "rider", size = { .3, .3, .3 }, at = { 0, 0, 1.25 }, mass = 2, friction = 1 }
mover { name = "lift", size = { 1, 1, .2 }, at = { 4, 0, 1 }, script = "lift" }
sphere { name = "passenger", radius = .2, at = { 4, 0, 1.3 }, mass = 1 }
mover { name = "belt", size = { 3, 1, .2 }, at = { 0, 4, 1 }, friction = 1, script = "belt" }
box { name = "parcel", size = { .3, .3, .3 }, at = { 0, 4, 1.25 }, mass = 1, friction = 1 }
cylinder { name = "table", radius = 1, length = .2, at = { 4, 4, 1 }, kind = "kinematic", friction = 1, script = "table" }
box { name = "cube", size = { .2, .2, .2 }, at = { 4.5, 4, 1.2 }, mass = 1, friction = 1 }
sphere { name = "reader", radius = .1, at = { 9, 9, .1 }, script = "reader", state = { next = .1 } }
"""


class Steering(configurations.SameBits, program.Case):
	FILE, TEXT = "steering.lua", SCENE

	def places(self, text, *words):
		"""Places of objects that scripts have printed: by name, a list of (time, x, y, z)."""
		self.write(text)
		done = program.call("run", self.scene, "--set", "measure=end", *words)
		self.assertEqual(done.returncode, 0, done.stderr)
		found = {}
		for name, numbers in re.findall(r"^obsim: (\w+) (.*)$", done.stderr, re.MULTILINE):
			self.assertNotEqual(name, "warning", done.stderr)
			found.setdefault(name, []).append(tuple(float(x) for x in numbers.split()))
		return found

	def test_carries(self):
		"""What lies on a platform comes to its speed by friction, and so slips by v^2 / 2 mu g each time; the rest goes along."""
		at = self.places(SCENE)
		lag = {round(t, 2): platform[0] - rider[0] for (t, *platform), (_, *rider) in zip(at["platform"], at["rider"])}
		slip = 1 / (2 * 9.81)
		self.assertAlmostEqual(lag[.18], slip, delta=1e-3)
		self.assertAlmostEqual(lag[.28], slip, delta=1e-3)
		self.assertAlmostEqual(lag[.68], slip - 4 * slip, delta=2e-3) # turned from 1 m/s to -1 m/s
		self.assertEqual(at["platform"][-1][1:], at["platform"][-2][1:])
		for (t, *lift), (_, *passenger) in zip(at["lift"], at["passenger"]):
			self.assertAlmostEqual(passenger[2] - lift[2], .3, delta=2e-3, msg=t)
		for found, wanted in zip(at["lift"][-1][1:], (4, .1, 1.2)):
			self.assertAlmostEqual(found, wanted, 12)
		for before, after, speed in (1, 4, .5), (-3, -1, -.5):
			(t, x, *_), (s, y, *_) = at["parcel"][before], at["parcel"][after]
			self.assertAlmostEqual((y - x) / (s - t), speed, delta=1e-3)
		for t, x, y, _ in at["cube"][1:6]: # at 2 rad/s, after it has slipped a little
			self.assertAlmostEqual(math.hypot(x - 4, y - 4), .5, delta=.02, msg=t)
		self.assertAlmostEqual(at["cube"][5][0] - at["cube"][1][0], .4, 9)
		turned = [math.atan2(y - 4, x - 4) for _, x, y, _ in at["cube"]]
		self.assertAlmostEqual(turned[5] - turned[1], 2 * .4, delta=1e-3)
		self.assertEqual(at["cube"][-1][1:], at["cube"][-2][1:])

	def test_path_of_a_scene(self):
		"""A path that a script sets has the bits of the scene's own, and so has what stands on it."""
		points = ((0, 0, 0, 2), (.3, .4, 0, 3), (.5, .5, 0, 2.5), (1, 0, 0, 2))
		written = [", ".join(f"{{ {t}, {x}, {y + place}, {z} }}" for t, x, y, z in points[begin:])
			for begin, place in ((0, 0), (1, 3))]
		at = self.places("""
scene { duration = 1.8 }
script("steered", "function on_start() self:set_path { loop = true, points = { %s } } end")
script("reader", [[
function on_step()
	for _, name in ipairs { "own", "on_own", "set", "on_set" } do print(name, time(), find(name):position()) end
end
]])
box { name = "own", size = { 1, 1, .2 }, kind = "kinematic", path = { kind = "spline", loop = true, points = { %s } } }
sphere { name = "on_own", radius = .3, at = { .1, 0, 2.4 } }
box { name = "set", size = { 1, 1, .2 }, at = { 0, 3, 2 }, kind = "kinematic", script = "steered" }
sphere { name = "on_set", radius = .3, at = { .1, 3, 2.4 } }
sphere { name = "reader", radius = .1, at = { 9, 9, 9 }, script = "reader", kind = "static" }
""" % (written[1], written[0]))
		self.assertEqual(len(at["own"]), 108)
		for one, other in ("own", "set"), ("on_own", "on_set"):
			self.assertEqual([(t, x, z) for t, x, _, z in at[one]], [(t, x, z) for t, x, _, z in at[other]])

	def test_unchanged(self):
		"""A velocity that is set again in each step is as one that is set once: contacts go on."""
		found = {self.places("""
scene { duration = .5 }
script("lift", "function on_step() if %s then self:set_velocity(0, .5, 1) self:set_spin(0, 0, 1) self:set_surface_velocity(.1, 0, 0) end end")
script("reader", "function on_step() if time() > .4 then print('rider', find('rider'):position()) end end")
box { name = "lift", size = { 1, 1, .2 }, at = { 0, 0, 1 }, kind = "kinematic", script = "lift" }
box { name = "rider", size = { .3, .3, .3 }, at = { .1, 0, 1.25 } }
sphere { radius = .1, at = { 9, 9, .1 }, script = "reader", kind = "static" }
""" % when)["rider"].__repr__() for when in ("true", "time() == 0")}
		self.assertEqual(len(found), 1)

	def test_refusals(self):
		"""One line names the script, its line, and the fault; the object goes on as it was."""
		kinematic = "kind = 'kinematic'"
		for (call, kind), expected in {
			("self:set_velocity(1, 0, 0)", "mass = 1"): r"set_velocity: expected a kinematic object, got a dynamic one",
			("self:set_spin(1, 0, 0)", "static = true"): r"set_spin: expected a kinematic object, got a static one",
			("self:set_path { points = { { 1, 0, 0, 0 } } }", "static = true"): r"set_path: expected a kinematic object, got a static one",
			("self:set_surface_velocity(1, 0, 0)", "mass = 1"):
				r"set_surface_velocity: expected a static or kinematic object, got a dynamic one",
			("find('other'):set_velocity(1, 0, 0)", kinematic): r"set_velocity: a script moves its own object, self",
			("self:set_velocity(0, 0 / 0, 0)", kinematic): r"set_velocity: expected a number, up to 100000, got -?nan",
			("self:set_velocity(1e6, 0, 0)", kinematic): r"set_velocity: expected a number, up to 100000, got 1000000",
			("self:set_velocity(1)", kinematic): r"set_velocity: expected a number, up to 100000, got nothing",
			("self:set_spin(9e3, 0, 0)", kinematic): r"spin: expected from 0 to 100000 m/s at its surface, got 180000",
			("self:set_surface_velocity(0, 0, 1 / 0)", kinematic): r"set_surface_velocity: expected a number, up to 100000, got inf",
			("self:set_path { { 1, 0, 0, 0 } }", kinematic): r"set_path.*",
			("self:set_path { points = {} }", kinematic): r"set_path\.points: expected 1 to 1024 points {t, x, y, z}, got 0",
			("self:set_path { points = { { 1, 0, 0 } } }", kinematic): r"set_path\.points: expected four numbers {t, x, y, z} as point 1",
			("self:set_path { points = { { 1, 0, 0, 0 / 0 } } }", kinematic): r"set_path\.points: expected four numbers {t, x, y, z} as point 1",
			("self:set_path { points = { { 0, 0, 0, 0 } } }", kinematic): r"set_path\.points: expected times that are after 0 and grow, got 0 at point 1",
			("self:set_path { points = { { .001, 0, 0, 0 } } }", kinematic): r"points: expected at least two steps of",
			("self:set_path { points = { { .1, 99999, 0, 0 } } }", kinematic): r"path: expected from 0 to 100000 m/s, got 99",
			("self:set_path { points = { { 9, 1, 0, 0 } }, loop = true }", kinematic): r"loop: expected ",
			("self:set_path { points = { { 9, 1, 0, 0, 0, 1, 0, 0 } } }", kinematic): r"points: expected .*half a turn",
			("local p = {} for i = 1, 64 do p[i] = { i, 0, 0, 99 } end self:set_path { points = p }", kinematic):
				r"expected at most 4096 bytes",
		}.items():
			with self.subTest(call=call):
				self.write(f"""
scene {{ duration = .1 }}
script("it", [[function on_start()
{call} end]])
sphere {{ name = "ball", radius = 20, at = {{ 0, 0, 99 }}, script = "it", {kind} }}
sphere {{ name = "other", radius = 1, at = {{ 99, 0, 99 }}, kind = "kinematic" }}
""")
				done = program.call("run", self.scene)
				self.assertEqual(done.returncode, 0, done.stderr)
				self.assertRegex(done.stderr, r"^obsim: warning: the script of object 0 \(ball\) was stopped at 0 s: it:2: " + expected)
				self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

	def test_refused_in_ode(self):
		self.write(SCENE)
		done = program.call("run", self.scene, "--arch", "monolith")
		self.assertRegex(done.stderr, r"\(platform\) was stopped at 0 s: platform:\d+: the one ODE world keeps its bodies to itself")


unittest.main()
