"""Joined objects end in the same bits in any architecture, after kills and after a resume; what has no joints refuses them."""

import math
import os
import re
import tempfile
import unittest

import program

WAYS = program.ways(["--workers", 1], ["--workers", 3], ["--isolation", "process", "--workers", 2],
	["--isolation", "process", "--workers", "objects"], ["--isolation", "process", "--workers", 2, "--harden"],
	["--check"])


# All kinds of joints, to objects that move as they are told, that die, and that have scripts.
MECHANISMS = """scene { title = "Mechanisms", duration = 2.2 }
ground {}
box { name = "turntable", size = { 1, 1, .2 }, kind = "kinematic", at = { 0, 0, 3 }, spin = { 0, 0, 2 } }
box { name = "arm", size = { 1.5, .1, .1 }, at = { 1.1, 0, 2.8 } }
hinge { "arm", "turntable", at = { .4, 0, 2.85 }, axis = { 0, 1, 0 } }
sphere { name = "tip", radius = .1, at = { 1.9, 0, 2.8 }, dies = 1 }
ball { "tip", "arm", at = { 1.85, 0, 2.8 }, stiffness = 3, damping = .2, armature = .01 }
box { name = "shaker", size = { .3, .3, .3 }, kind = "kinematic", at = { 3, 0, 4 },
	path = { kind = "sine", amplitude = { .5, 0, 0 }, frequency = 1 } }
sphere { name = "bob", radius = .1, at = { 3, 0, 3 }, script = [[ function step(self) self:torque(0, .01, 0) end ]] }
distance { "bob", "shaker" }
box { name = "slide", size = { .2, .2, .2 }, at = { -2, 0, 3 } }
slider { "slide", axis = { 1, 0, -1 } }
box { name = "w1", size = { .2, .2, 1 }, at = { -3, 1, 2 } }
box { name = "w2", size = { 1, .2, .2 }, at = { -2.4, 1, 2.4 } }
fixed { "w1", "w2" }
box { name = "u1", size = { .2, .2, 1 }, at = { -3, -2, 4 } }
box { name = "u2", size = { .2, .2, 1 }, at = { -3, -2, 3 }, spin = { 1, 2, 3 } }
universal { "u1", "u2", at = { -3, -2, 3.5 }, axis = { 1, 0, 0 }, across = { 0, 1, 0 }, low = -.4, high = .4, restitution = .5,
	second = { stiffness = 20, damping = 1, friction = .2 } }
"""

# A script turns a crank back and forth, by its angle.
CRANK = """scene { title = "A crank", duration = 3 }
box { name = "crank", size = { .6, .1, .1 }, at = { .3, 0, 1 }, script = [[
	function on_step()
		local angle, rate = joint("axle")
		if angle > .5 then motor("axle", -1) elseif angle < -.5 then motor("axle", 1) end
		if math.abs(rate) > 1e-9 and math.abs(math.abs(rate) - 1) > 1e-9 then print("@rate", rate) end
		if time() > 2.97 then print("@angle", angle) end
	end
]] }
hinge { "crank", name = "axle", at = { 0, 0, 1 }, axis = { 0, 1, 0 }, motor = { rate = 1 } }
"""

# Forces along axes, in the air and on the ground: limits that are hit, springs that are sat on, wheels that are driven.
DRIVES = """scene { title = "Drives", duration = 2.5 }
ground {}
box { name = "flap", size = { 1, .2, .1 }, at = { .6, 0, 1 }, mass = 2 }
hinge { "flap", at = { .1, 0, 1 }, axis = { 0, 1, 0 }, low = -1, high = .6, restitution = .4 }
sphere { name = "ball", radius = .1, at = { .9, 0, 1.8 }, mass = 1, restitution = .3, script = [[
	function on_start() self:wake(2.4) end
	function on_wake()
		for _, name in ipairs { "flap", "gate", "seat", "lift", "load", "car" } do
			local o = find(name)
			local x, y, z = o:position()
			print("@" .. name, x, y, z, o:velocity())
		end
	end
]] }
box { name = "gate", size = { 1, .2, .1 }, at = { .6, 3, 1 }, mass = 2 }
hinge { "gate", at = { .1, 3, 1 }, axis = { 0, 1, 0 }, low = -1, high = .6, restitution = .4, friction = .5 }
box { name = "seat", size = { 1, 1, .1 }, at = { -3, 0, 1 }, mass = 5 }
slider { "seat", axis = { 0, 0, 1 }, stiffness = 2000, damping = 100 }
box { name = "rider", size = { .4, .4, .4 }, at = { -3, 0, 1.3 }, mass = 10 }
box { name = "lift", size = { 1, 1, .1 }, at = { 3, 0, .2 }, mass = 5 }
slider { "lift", axis = { 0, 0, 1 }, low = 0, high = 1, motor = { rate = .5, most = 500 } }
box { name = "load", size = { .4, .4, .4 }, at = { 3, 0, .451 }, mass = 10 }
box { name = "car", size = { 1.2, .6, .2 }, at = { 0, -4, .45 }, mass = 40 }
for i, x in ipairs { -.4, .4 } do
	for k, y in ipairs { -4.45, -3.55 } do
		local name = "wheel" .. i .. k
		cylinder { name = name, radius = .2, length = .1, at = { x, y, .2 }, mass = 3, friction = .9,
			rotation = { axis = { 1, 0, 0 }, degrees = 90 } }
		hinge { name, "car", at = { x, y, .2 }, axis = { 0, 1, 0 }, motor = { rate = 10, most = 20 } }
	end
end
"""

# Joints that break: of a shelf on which a ball lands, of a chain under a load, of a swing, and at once: the cap then falls
# on its post, which it did not touch before.
BREAKS = """scene { title = "Breaks", duration = 1.5 }
ground {}
local telling = [[
	function on_break(name, force, torque) print("@broke " .. name, time(), force, torque) end
	function on_start() self:wake(1.4) end
	function on_wake() print("@at", self:name(), self:position()) end
]]
box { name = "shelf", size = { 1, .4, .05 }, at = { .5, 0, 1.5 }, mass = 5, script = telling }
fixed { "shelf", name = "bracket", at = { 0, 0, 1.5 }, breaks_at = { torque = 100 } }
sphere { name = "ball", radius = .15, at = { .8, 0, 2 }, mass = 20 }
box { name = "post", size = { .4, .4, .4 }, at = { 3, 0, .2 }, mass = 4 }
box { name = "cap", size = { .4, .4, .1 }, at = { 3, 0, .46 }, mass = 1, script = telling }
fixed { "cap", "post", name = "glue", at = { 3, 0, .4 }, breaks_at = { force = 9 } }
for i = 1, 4 do
	sphere { name = "link" .. i, radius = .05, at = { -2, 0, 3.2 - .2 * i }, mass = i < 4 and .1 or 5, script = telling }
	ball { "link" .. i, i > 1 and "link" .. i - 1 or nil, name = "eye" .. i, at = { -2, 0, 3.3 - .2 * i },
		breaks_at = i == 3 and { force = 50 } or nil }
end
sphere { name = "bob", radius = .1, at = { 1, 3, 2 }, mass = 2, script = telling }
hinge { "bob", name = "rope", at = { 0, 3, 2 }, axis = { 0, 1, 0 }, breaks_at = { force = 40 }, friction = .1 }
"""

# Joints that scripts add and remove: to a crane that swings, to the ground, to objects that scripts create and remove.
GRABS = """scene { title = "Grabs", duration = 2, room = 8 }
ground {}
box { name = "crane", size = { .5, .5, .1 }, kind = "kinematic", at = { 0, 0, 3 },
	path = { kind = "sine", amplitude = { 1, 0, 0 }, frequency = .5 } }
sphere { name = "weight", radius = .2, at = { 0, 0, 2.4 }, mass = 5, script = [[
	function on_start() self:wake(.1) end
	function on_wake()
		local t = time()
		if t < .2 then
			local x, y, z = find("crane"):position()
			hinge { "weight", "crane", name = "hook", at = { x, y, z }, axis = { 0, 1, 0 }, low = -.4, high = .4,
				restitution = .5, breaks_at = { force = 1e6 } }
			self:wake(.6)
		elseif t < .75 then
			local angle, rate, torque = joint("hook")
			local x, y, z = joint_load("hook")
			print("@hook", angle, rate, torque, x, y, z)
			unjoin("hook")
			sphere { name = "child", radius = .1, at = { 0, 2, 3 }, mass = 1 }
			self:wake(.1)
		elseif t < 1.2 then
			if joint("hook") then print("@wrong") end
			fixed { "weight", "child", name = "hook" }
			distance { "child", name = "rope", stiffness = 50, damping = 2, to = { 0, 2, 4 } }
			self:wake(.5)
		else
			print("@rope", joint("rope"))
			find("child"):remove()
		end
	end
]] }
for i = 1, 3 do
	box { name = "crate" .. i, size = { .3, .3, .3 }, at = { 2, 0, .31 * i - .16 }, mass = 2 }
end
hinge { "crate3", at = { 2, .15, .92 }, axis = { 1, 0, 0 }, friction = 1 }
sphere { name = "glue", radius = .1, at = { 4, 0, .1 }, mass = 1, script = [[
	function on_start() self:wake(.5) end
	function on_wake()
		if time() < .6 then
			slider { "crate1", "crate2", name = "glue", axis = { 1, 0, 0 }, low = 0, motor = { rate = .5, most = 40 } }
			self:wake(.8)
		else
			print("@slid", joint("glue"))
			motor("glue", -.5)
		end
	end
]] }
"""

# In one pause two scripts remove one joint, and one between them adds another, which gets its number.
TWICE = """scene { title = "Twice", duration = .2, gravity = { 0, 0, 0 } }
local script = [[
	function on_start() self:wake(.05) end
	function on_wake()
		if time() > .1 then
			print("@" .. self:name(), joint_load("old") and 1 or 0, joint_load("new") and 1 or 0)
		else
			if self:name() == "b" then
				fixed { "a", "c", name = "new" }
			else
				unjoin("old")
			end
			self:wake(.1)
		end
	end
]]
for i, name in ipairs { "a", "b", "c" } do
	sphere { name = name, radius = .1, at = { i, 0, 0 }, mass = 1, script = script }
end
fixed { "a", "b", name = "old" }
"""

# An arm that a motor turns by more than half a turn, to a limit of 4 rad.
FAR = """scene { title = "Far", duration = 4 }
box { name = "wall", size = { .2, 1, 3 }, kind = "static", at = { 0, 0, 1.5 }, rotation = { axis = { 0, 0, 1 }, degrees = 180 } }
box { name = "arm", size = { 1, .1, .1 }, at = { .5, 0, 3 }, mass = 2, script = [[
	function on_start() self:wake(3.9) end
	function on_wake() print("@arm", (joint("axle")), self:position()) end
]] }
hinge { "wall", "arm", name = "axle", at = { 0, 0, 3 }, axis = { 0, -1, 0 }, low = -.5, high = 4,
	motor = { rate = 1.5, most = 100 } }
"""


def kept(folder, text):
	path = os.path.join(folder, "scene.lua")
	with open(path, "w", encoding="utf-8") as file:
		file.write(text)
	return path


def state(*words):
	done = program.call("run", *words, "--set", "measure=end")
	found = re.search(r"^  state +([0-9a-f]{16})$", done.stdout, re.MULTILINE)
	if done.returncode or not found:
		raise AssertionError(f"{words}: {done.stdout}{done.stderr}")
	return found.group(1), done.stdout


# Mechanisms that come to rest, and are woken: by a script's motor, a ball, the end of what held one.
SLEEPERS = """scene { title = "Sleepers", duration = 2.5 }
ground {}
box { name = "base", size = { 1, 1, .4 }, at = { 0, 0, .2 }, script = [[
	function on_start() self:wake(1.5) end
	function on_wake() motor("axle", 2) end
]] }
box { name = "arm", size = { 1, .1, .1 }, at = { .5, 0, .5 } }
hinge { "arm", "base", name = "axle", at = { 0, 0, .5 }, axis = { 0, 0, 1 }, motor = { rate = 0, most = 100 } }
for i = 1, 4 do
	box { name = "plank" .. i, size = { .4, .4, .1 }, at = { 3 + .5 * i, 0, .05 } }
	if i > 1 then hinge { "plank" .. i, "plank" .. i - 1, at = { 2.75 + .5 * i, 0, .05 }, axis = { 0, 1, 0 }, friction = .1 } end
end
sphere { name = "ball", radius = .15, at = { 3.6, 0, 10 }, velocity = { 0, 0, .5 }, density = 3000 }
sphere { name = "hook", radius = .1, at = { -3, 0, 3 }, static = true, dies = 1.6 }
for i = 1, 3 do
	capsule { name = "link" .. i, radius = .05, length = .3, at = { -3, 0, 3.15 - .45 * i } }
	universal { "link" .. i, i > 1 and "link" .. i - 1 or "hook", at = { -3, 0, 3.35 - .45 * i }, axis = { 1, 0, 0 }, across = { 0, 1, 0 },
		friction = .1, second = { friction = .1 } }
end
sphere { name = "look", radius = .1, at = { 90, 0, 0 }, static = true, script = [[
	function on_start() self:wake(1.45) end
	function on_wake()
		if time() < 2 then self:wake(1) end
		local arm, rate = joint("axle")
		local link, plank = find("link3"), find("plank4")
		local _, _, z = link:position()
		local _, _, speed = link:velocity()
		local _, turn = plank:spin()
		print("@at", time(), rate, z, speed, turn)
	end
]] }
"""


class Joints(unittest.TestCase):
	# The ball hits the wall in the first second.
	scenes = [[program.scene("wrecking_ball"), "-D", "links=4", "-D", "rows=3", "--duration", 1.4],
		[program.scene("bridge"), "-D", "planks=8", "--duration", 1], [program.scene("crane"), "-D", "stools=1", "--duration", 9]]

	def test_same_bits(self):
		for scene in self.scenes:
			self.assertEqual(len({state(*scene, *way)[0] for way in WAYS}), 1, scene)

	def test_mechanisms(self):
		for text in (MECHANISMS, DRIVES, CRANK, BREAKS, GRABS, TWICE, SLEEPERS):
			with tempfile.TemporaryDirectory() as folder:
				path = kept(folder, text)
				self.assertEqual(len({state(path, *way)[0] for way in WAYS}), 1)

	# In the end gates hang on their limits, the seat carries its rider, the lift is up, the car goes; in ODE likewise.
	def test_drives(self):
		for arch, fine in (("obs", 1e-6), ("monolith", 1e-3)):
			with tempfile.TemporaryDirectory() as folder:
				done = program.call("run", kept(folder, DRIVES), "--set", "measure=end", "--arch", arch)
			self.assertEqual(done.returncode, 0, done.stderr)
			at = {name: [float(x) for x in rest.split()] for name, rest in re.findall(r"@(\w+)(.*)", done.stderr)}
			for name in ("flap", "gate"):
				self.assertAlmostEqual(at[name][2], 1 - .5 * math.sin(.6), delta=fine)
			self.assertAlmostEqual(at["seat"][2], 1 - 15 * 9.81 / 2000, delta=1e-3)
			self.assertAlmostEqual(at["lift"][2], 1.2, delta=fine)
			self.assertAlmostEqual(at["car"][3], 2, delta=.01 if arch == "obs" else .1)

	def test_sleepers(self):
		with tempfile.TemporaryDirectory() as folder:
			done = program.call("run", kept(folder, SLEEPERS), "--set", "measure=end")
		self.assertEqual(done.returncode, 0, done.stderr)
		at = [[float(x) for x in line.split()] for line in re.findall(r"@at (.*)", done.stderr)]
		self.assertEqual(len(at), 2, done.stderr)
		self.assertEqual(at[0][1::2], [0, 0], "not asleep before it is woken")
		self.assertEqual(at[0][4], 0)
		self.assertAlmostEqual(at[1][1], 2, 6)
		self.assertLess(at[1][2], .5) # the links have fallen
		self.assertNotEqual(at[1][4], 0)

	def told(self, *words):
		"""Instants and loads of all breaks by the joints' names, and the ended program."""
		with tempfile.TemporaryDirectory() as folder:
			done = program.call("run", kept(folder, BREAKS), "--set", "measure=end", *words)
		self.assertEqual(done.returncode, 0, done.stderr)
		return {name: (float(t), float(force), float(torque)) for name, t, force, torque in
			re.findall(r"@broke (\w+)\s+(\S+)\s+(\S+)\s+(\S+)", done.stderr)}, done

	# ODE's joints break likewise, by loads of the same size.
	def test_breaks_in_ode(self):
		broke, ode = self.told()[0], self.told("--arch", "monolith")[0]
		self.assertEqual(set(broke), set(ode))
		self.assertLess(abs(broke["rope"][0] - ode["rope"][0]), .05)
		self.assertAlmostEqual(ode["rope"][1], broke["rope"][1], delta=6)

	# A hinge whose limit lies beyond half a turn, of a static object to one that moves, comes to its limit in ODE as well.
	def test_frames_in_ode(self):
		found = []
		for arch in ("obs", "monolith"):
			with tempfile.TemporaryDirectory() as folder:
				done = program.call("run", kept(folder, FAR), "--set", "measure=end", "--arch", arch)
			self.assertEqual(done.returncode, 0, done.stderr)
			found.append([float(x) for x in re.search(r"@arm(.*)", done.stderr).group(1).split()])
		for one, other in zip(*found):
			self.assertAlmostEqual(one, other, delta=.03) # ODE goes beyond the limit by up to a step
		self.assertAlmostEqual(found[1][0], 4, delta=.03) # the value

	def test_breaks(self):
		broke, done = self.told()
		self.assertEqual(set(broke), {"bracket", "glue", "eye3", "rope"})
		self.assertGreater(broke["bracket"][2], 100)
		self.assertGreater(broke["rope"][1], 40)
		self.assertLess(broke["rope"][1], 42)
		self.assertLess(broke["eye3"][0], .05)
		at = {name: [float(x) for x in rest.split()] for name, rest in re.findall(r"@at\s+(\w+)(.*)", done.stderr)}
		self.assertAlmostEqual(at["cap"][2], .45, delta=1e-3)
		self.assertAlmostEqual(at["link2"][2], 2.8, delta=.05)
		self.assertLess(at["link3"][2], .3)

	def test_grabs(self):
		with tempfile.TemporaryDirectory() as folder:
			done = program.call("run", kept(folder, GRABS), "--set", "measure=end")
		self.assertEqual(done.returncode, 0, done.stderr)
		found = {name: [float(x) for x in rest.split()] for name, rest in re.findall(r"@(\w+)(.*)", done.stderr)}
		self.assertEqual(set(found), {"hook", "rope", "slid"}, done.stderr)
		self.assertLess(abs(found["hook"][0]), .4 + 1e-9)
		self.assertGreater(found["hook"][5], 10) # it bears the weight
		self.assertAlmostEqual(found["slid"][0], .4, delta=.05)

	# Joints stay as they have become, whenever the run is saved, and whoever dies.
	def test_removed_twice(self):
		with tempfile.TemporaryDirectory() as folder:
			done = program.call("run", kept(folder, TWICE), "--set", "measure=end")
		self.assertEqual(re.findall(r"@(\w)\s+(\d)\s+(\d)", done.stderr), [("a", "0", "1"), ("b", "0", "1"), ("c", "0", "1")])

	def test_again(self):
		for text, end, durations in ((BREAKS, 1.5, (1 / 60, .2, .8)), (GRABS, 2, (.3, 1, 1.9)), (SLEEPERS, 2.5, (.5, 1.3, 1.6))):
			with tempfile.TemporaryDirectory() as folder:
				path, saved = kept(folder, text), os.path.join(folder, "kept.ck")
				bits = state(path)[0]
				for duration in durations:
					state(path, "--duration", duration, "--checkpoint", saved)
					self.assertEqual(state("--resume", saved, "--duration", end)[0], bits)
				killed, words = state(path, "--isolation", "process", "--workers", 2, "--fault", "kill:p=.01,seed=3")
				self.assertRegex(words, r"deaths +[1-9]")
				self.assertEqual(killed, bits)

	def test_script(self):
		with tempfile.TemporaryDirectory() as folder:
			done = program.call("run", kept(folder, CRANK), "--set", "measure=end")
		self.assertEqual(done.returncode, 0, done.stderr)
		self.assertNotIn("@rate", done.stderr)
		angle = float(re.search(r"@angle (\S+)", done.stderr).group(1))
		self.assertAlmostEqual(angle, 0, delta=.15) # .5 s up, 1 s down, 1 s up, .5 s down

	def test_kills(self):
		scene = self.scenes[0]
		bits, words = state(*scene, "--isolation", "process", "--workers", 2, "--fault", "kill:p=.003,seed=5")
		self.assertRegex(words, r"deaths +[1-9]")
		self.assertEqual(bits, state(*scene)[0])

	def test_resume(self):
		with tempfile.TemporaryDirectory() as folder:
			kept = os.path.join(folder, "kept.ck")
			for scene in self.scenes:
				state(*scene[:-1], .5, "--checkpoint", kept)
				self.assertEqual(state("--resume", kept, *scene[-2:])[0], state(*scene)[0])

	def test_refusals(self):
		for words in (["--sync", "free"], ["--set", "solver=ghost"], ["--set", "solver=jacobi"],
			["--set", "integrator=ode"]):
			done = program.call("run", *self.scenes[0], *words)
			self.assertNotEqual(done.returncode, 0, words)
			self.assertRegex(done.stderr, r"^obsim: .*(has no joints, as this scene has: take|the scene has joints, which hold in lockstep) .*\n$")

	# One thing along an axis is ODE's motor, and a distance has none.
	def test_refused_in_ode(self):
		for joint in ('distance { "bob", name = "rope", stiffness = 9, to = { 0, 0, 3 } }',
			'hinge { "bob", name = "rope", at = { 0, 0, 3 }, axis = { 0, 1, 0 }, friction = 1, damping = 2 }'):
			with tempfile.TemporaryDirectory() as folder:
				path = kept(folder, 'sphere { name = "bob", radius = .1, at = { 1, 0, 3 } }\n' + joint)
				done = program.call("run", path, "--arch", "monolith")
			self.assertEqual(done.returncode, 1, done.stderr)
			self.assertRegex(done.stderr, r'^obsim: .*arch: the one ODE world has no joint as "rope": .*\n$')


unittest.main()
