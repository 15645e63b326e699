"""Scripts of objects, end to end: their abilities, their limits, and the same bits in any configuration and with any
deaths of simulators."""

import math
import re
import unittest

import program

ROOMY = ["--set", "measure=end"]
MONOLITH = ["--arch", "monolith"]
HARDENED = ["--isolation", "process", "--harden"]


class Scripts(program.Case):
	def write(self, name, text):
		with open(self.path(name), "w") as f:
			f.write(text)
		return self.path(name)

	def run_scene(self, text, *words, code=0):
		"""Runs a scene with this text; returns the output."""
		done = program.call("run", self.write("scene.lua", text), *words)
		self.assertEqual(done.returncode, code, done.stderr)
		return done.stderr

	def one(self, script, *words, object="mass = 2", scene="duration = 1", code=0):
		"""Runs one ball with this script, far above the ground; returns the output with what it prints."""
		return self.run_scene(f"""
scene {{ {scene} }}
ground {{}}
script("it", [[{script}]])
sphere {{ name = "ball", radius = .5, at = {{ 0, 0, 1000 }}, script = "it", {object} }}
""", *words, code=code)

	def numbers(self, said, word):
		"""Numbers after a printed word."""
		found = re.findall(rf"^obsim: {word} (.*)$", said, re.M)
		self.assertTrue(found, said)
		return [[float(x) for x in line.split()] for line in found]

	# ---- abilities

	def test_constant_force(self):
		"""A force holds until another is set: a parabola."""
		said = self.one("function on_start() self:force(6, 0, 2 * 9.81) self:wake(.5) end "
		                "function on_wake() local x, y, z = self:position() print('at', x, y, z, self:velocity()) end")
		x, y, z, vx, vy, vz = self.numbers(said, "at")[0]
		self.assertAlmostEqual(x, .5 * 3 * .25, 9)
		self.assertAlmostEqual(z, 1000, 9)
		self.assertAlmostEqual(vx, 1.5, 9)
		self.assertAlmostEqual(vz, 0, 9)

	def test_torque(self):
		"""Spin grows by torque over moment of inertia: 2/5 m r^2 = .2 kg m^2."""
		said = self.one("function on_start() self:torque(0, 0, .4) self:wake(.5) end "
		                "function on_wake() print('spin', self:spin()) self:torque(0, 0, 0) self.state.w = 1 "
		                "if time() < .9 then self:wake(.4) end end")
		spins = self.numbers(said, "spin")
		self.assertAlmostEqual(spins[0][2], 1, 9)
		self.assertAlmostEqual(spins[1][2], 1, 9)

	TORQUES = """
scene { duration = 5 }
ground { friction = .8 }
script("it", [[
function on_start() self:torque(self.state.x, self.state.y, 0) self:wake(2) end
function on_wake() print(self:name(), self:attitude()) end
]])
cylinder { name = "wheel", radius = .5, length = .2, rotation = { axis = { 1, 0, 0 }, degrees = 90 }, at = { 0, 0, .5 },
	mass = 2, friction = .8, script = "it", state = { x = 0, y = 4 } }
sphere { name = "ball", radius = .5, at = { 0, 2, .5 }, mass = 2, friction = .8, script = "it", state = { x = 0, y = 4 } }
box { name = "box", size = { .6, .4, .2 }, at = { 0, 5, 1000 }, spin = { 1, 2, 3 }, mass = 2, script = "it",
	state = { x = .3, y = .1 } }
"""

	def test_torque_turns(self):
		"""A wheel and a ball that a torque rolls along have turned by half the acceleration times the square of time."""
		said = self.run_scene(self.TORQUES)
		for name, inertia in ("wheel", .25), ("ball", .2):
			with self.subTest(name=name):
				w = self.numbers(said, name)[0][0]
				expected = abs(math.cos(.5 * .5 * 4 / (inertia + .5) * 4)) * (.5 ** .5 if name == "wheel" else 1)
				self.assertAlmostEqual(abs(w), expected, 9)

	def test_torque_order(self):
		"""A box that spins under a torque: twice as many substeps, a quarter of the error."""
		found = [self.numbers(self.run_scene(self.TORQUES, "--set", f"substeps={n}"), "box")[0] for n in (8, 16, 32)]
		first, second = [math.dist(a, b) for a, b in zip(found, found[1:])]
		self.assertLess(first, 1e-5)
		self.assertLess(second, .26 * first)

	def test_push_and_twist(self):
		said = self.one("function on_start() self:push(4, 0, 0) self:twist { 0, .6, 0 } self:wake(.1) end "
		                "function on_wake() print('v', self:velocity()) print('w', self:spin()) end")
		self.assertAlmostEqual(self.numbers(said, "v")[0][0], 2, 12)
		self.assertAlmostEqual(self.numbers(said, "w")[0][1], 3, 12)

	def test_friction_holds_a_block(self):
		"""A force below the friction limit does not move a block, one above it moves it as the closed form says."""
		said = self.run_scene("""
scene { duration = 1 }
ground { friction = .5 }
script("pull", [[
function on_step()
	if time() == 0 then self:force(self.state.share * .5 * self:mass() * 9.81, 0, 0) end
	self.state.x = self:position()
end
function on_start() self:wake(59 / 60) end
function on_wake() print(self:name(), (self:position()), (self:velocity())) end
]])
for i, share in ipairs { .9, 1.5 } do
	box { name = share < 1 and "held" or "pulled", size = { 1, 1, 1 }, at = { 0, 3 * i, .5 }, friction = .5, mass = 4,
	      script = "pull", state = { share = share } }
end
""")
		self.assertLess(abs(self.numbers(said, "held")[0][0]), 1e-4)
		x, v = self.numbers(said, "pulled")[0]
		a, t = .5 * .5 * 9.81, 59 / 60
		self.assertAlmostEqual(v / (a * t), 1, 2)
		self.assertAlmostEqual(x / (.5 * a * t * t), 1, 2)

	def test_contact(self):
		"""A ball that falls by 1 m onto the ground, and rebounds with .8 of its speed: m (1 + e) sqrt(2 g h)."""
		said = self.run_scene("""
scene { duration = 1 }
ground {}
script("ball", [[function on_contact(other, impulse, point) print("hit", impulse, point[1], point[2], point[3])
  print("by", other:name(), other == find("ground"), self == other) end]])
sphere { radius = .2, at = { 3, 4, 1.2 }, mass = 2, restitution = .8, script = "ball" }
""")
		hits = self.numbers(said, "hit")
		self.assertEqual(len(hits), 1)
		self.assertAlmostEqual(hits[0][0], 2 * 1.8 * (2 * 9.81) ** .5, 6)
		for found, expected in zip(hits[0][1:], (3, 4, 0)):
			self.assertAlmostEqual(found, expected, 6)
		self.assertIn("obsim: by ground true false", said)

	def test_contact_of_two(self):
		"""Both receive the event, with the same impulse, and once for each contact."""
		said = self.run_scene("""
scene { duration = 1, gravity = { 0, 0, 0 } }
script("ball", "function on_contact(other, impulse) print(self:name(), impulse) end")
sphere { name = "a", radius = .5, mass = 1, at = { -2, 0, 0 }, velocity = { 4, 0, 0 }, script = "ball" }
sphere { name = "b", radius = .5, mass = 3, at = { 0, 0, 0 }, script = "ball" }
""")
		for name in "a", "b":
			found = self.numbers(said, name)
			self.assertEqual(len(found), 1)
			self.assertAlmostEqual(found[0][0], 3, 3)  # they go on together

	def test_messages_and_timers(self):
		said = self.run_scene("""
scene { duration = 1 }
ground {}
script("ping", [[
function on_start() self:wake(.25) end
function on_wake() send(find("b"), "ping", 1, 2.5, true, self) end
function on_message(from, text, n) print("got", time(), from:name(), text, n) end
]])
script("pong", "function on_message(from, text, i, x, yes, who) send(from, text .. ' pong', i + x) print(yes, who == from, math.type(i)) end")
sphere { name = "a", radius = .1, at = { 0, 0, 9 }, script = "ping" }
sphere { name = "b", radius = .1, at = { 1, 0, 9 }, script = "pong" }
""")
		self.assertRegex(said, r"got 0\.28333\d* b ping pong 3\.5")
		self.assertIn("obsim: true true integer", said)

	def test_ray_and_near(self):
		said = self.run_scene("""
scene { duration = .1, gravity = { 0, 0, 0 } }
ground {}
script("eye", [[function on_start()
	local o, d, nx, ny, nz = ray(0, 0, 5, 1, 0, 0, 100)
	print("ray", d, nx, ny, nz) print("sees", o:name())
	o, d = ray({ 0, 0, 5 }, { 0, 0, -1 }) print("down", d)
	print("none", ray(0, 0, 5, 0, 1, 0, 100) == nil)
	local names = "" for _, n in ipairs(near(8)) do names = names .. n:name() .. " " end print("near", names)
end]])
sphere { name = "eye", radius = .1, at = { 0, 0, 5 }, script = "eye" }
box { name = "wall", size = { 1, 4, 4 }, at = { 5, 0, 5 } }
sphere { name = "far", radius = .1, at = { 0, 0, 20 } }
sphere { name = "close", radius = .1, at = { 1, 0, 8 } }
""")
		self.assertEqual(self.numbers(said, "ray")[0], [4.5, -1, 0, 0])
		self.assertEqual(self.numbers(said, "down")[0], [5])
		self.assertIn("obsim: sees wall\n", said)
		self.assertIn("obsim: none true\n", said)
		self.assertIn("obsim: near close wall \n", said)

	def test_colour(self):
		"""The colour is in the universe: the next script that reads the object's look sees it."""
		self.assertEqual(self.one("function on_start() self:colour('#ff0000') self:colour { 0, .5, 1 } end"), "")
		self.assertIn("self.colour: expected a colour", self.one("function on_start() self:colour('red') end"))

	def test_create_and_remove(self):
		said = self.run_scene("""
scene { duration = 1, room = 4 }
ground {}
script("child", [[
function on_start() print("born", self.state.n, self:name()) self:wake(.1) end
function on_wake() self:remove() end
function on_stop() print("gone", self.state.n) send(find("mother"), "bye", self) end
]])
script("mother", [[
function on_start() self.state.n = 0 self:wake(.1) end
function on_wake()
	self.state.n = self.state.n + 1
	sphere { radius = .1, at = { self.state.n, 0, 9 }, script = "child", state = { n = self.state.n } }
	if self.state.n < 5 then self:wake(.1) end
end
function on_message(from, text, child)
	print("exists", child:exists(), child:position() == nil)
	send(child, "too late")
end
]])
sphere { name = "mother", radius = .1, at = { 0, 5, 9 }, script = "mother" }
""")
		self.assertEqual([n for n, in self.numbers(said, "gone")], [1, 2, 3, 4, 5])
		self.assertEqual(said.count("exists false true"), 5)
		self.assertNotIn("warning", said)

	def test_removed_by_another(self):
		said = self.run_scene("""
scene { duration = .5 }
ground {}
script("hunter", [[
function on_start() self:wake(.1) end
function on_wake() find("plain"):remove() find("scripted"):remove() self.state.o = find("plain") self:wake(.1) end
function on_message(from, text) print(text, from:exists(), self.state.o:exists()) self:wake(9) end
]])
sphere { name = "hunter", radius = .1, at = { 0, 5, 9 }, script = "hunter" }
sphere { name = "plain", radius = .1, at = { 0, 6, 9 } }
sphere { name = "scripted", radius = .1, at = { 0, 7, 9 }, script = "function on_stop() send(find('hunter'), 'last words') end" }
""")
		self.assertIn("obsim: last words false false", said)
		self.assertNotIn("warning", said)

	def test_many_created_and_removed(self):
		"""Slots and cells are used again, however many objects there have been."""
		found = self.report_of("""
scene { duration = 40, step = 1 / 20, room = 12 }
script("drop", "function on_start() self:wake(.1) end function on_wake() self:remove() end")
script("tap", [[function on_step()
  for i = 1, 3 do sphere { radius = .1, at = { 0, i, 0 }, script = "drop" } end
  self.state.n = (self.state.n or 0) + 3
end]])
sphere { radius = .1, at = { 9, 9, 9 }, script = "tap" }
""")
		self.assertEqual(found["outcome"], "finished")
		self.assertLessEqual(found["objects"], 13)

	def test_hull_as_of_a_scene(self):
		"""A hull that a script creates is the one that a scene makes of the same points, to the bit."""
		points = "{ { 0, 0, 0 }, { 1, 0, 0 }, { 0, .7, 0 }, { .2, .3, .9 }, { .3, .2, .1 } }"
		hull = f"hull {{ name = 'it', points = {points}, at = {{ 1, 2, 4 }}, rotation = {{ axis = {{ 1, 1, 0 }}, degrees = 40 }}, spin = {{ 1, 2, 3 }} }}"
		ball = "ground {} sphere { radius = .2, at = { 9, 9, 1 }"
		alike = [self.report_of(text) for text in (
			f"scene {{ duration = 2 }} {ball} }} {hull}",
			f'scene {{ duration = 2 }} {ball}, script = "function on_start() {hull} end" }}',
			f'scene {{ duration = 2 }} {ball}, script = "function on_start() {hull} end" }} hull {{ points = {points}, at = {{ 7, 7, 7 }}, dies = .1 }}')]
		self.assertEqual(alike[0]["state_hash"], alike[1]["state_hash"])
		self.assertEqual([r["objects"] for r in alike], [3, 3, 3])

	def report_of(self, text, *words):
		return program.report(self.write("scene.lua", text), *ROOMY, *words)

	# ---- limits

	def test_limits(self):
		"""Each of these stops its script, with object, file and line, and nothing else."""
		cases = {
			"function on_step()\n while true do end end": r"it:2: stopped after a million instructions",
			"function on_start()\n\n local t = {} for i = 1, 1e9 do t[i] = i end end": r"it:3: the script needs more than 4 MiB",
			"function on_start() local t = 'x' for i = 1, 99 do t = t .. t end end": r"it:1: a string grew beyond 64 KiB",
			"function on_wake()\n local t t.x = 1 end function on_start() self:wake(.1) end": r"it:2: attempt to index",
			"function on_start() self:force(1, 2) end": r"it:1: force: expected a number, up to [\d.e+]+, got nothing",
			"function on_start() self:force(0 / 0, 1, 2) end": r"it:1: force: expected a number, up to [\d.e+]+, got nan",
			"function on_start() find('ground'):force(1, 2, 3) end": r"it:1: force: a script moves its own object",
			"n = 0 function on_step() n = n + 1 end": r"it:1: cannot set n here: a script keeps values in self\.state",
			"local n = 0\nfunction on_step() n = n + 1 end": r"it: n was set, which the function at line 2 sees",
			"local t = { { 1 } } function on_step() t[1][1] = 2 end": r"it:1: cannot set a value here",
			"function on_step() string.rep = nil end": r"it:1: cannot set rep here",
			"self:push(1, 2, 3)": r"it:1: objects can be asked in a function alone",
			"on_step = 3": r"it: on_step: expected a function, got a number",
			"function on_step() self.state.x = {} end": r"self\.state: expected a number, text, true, false or an object, got a table",
			"function on_step() for i = 1, 999 do self.state[i] = 'text' end end": r"self\.state: expected at most 1024 bytes",
			"function on_step() for i = 1, 99 do send(self, ('x'):rep(99)) end end": r"it:1: expected at most 4096 bytes of messages, creations and removals in a step",
			"function on_step() self.colour = 3 end": r"it:1: cannot set colour of an object",
			"function on_step() os.exit() end": r"it:1: os: not available",
			"function on_step() sphere { radius = -1 } end": r"it:1: sphere\.radius: expected a number from 1e-06",
			"function on_step() sphere { radius = 1e-160, mass = 1 } end": r"it:1: sphere\.radius: expected a number from 1e-06 to 1000000, got 1e-160",
			"function on_step() sphere { radius = .1, mass = 1e-12, force = { 1, 0, 0 } } end": r"it:1: sphere\.force: expected from -1e-06 to 1e-06 N",
			"function on_step() self:torque(0, 0, 1e12) end": r"it:1: torque: expected a number, up to [\d.]+, got 1e\+12",
			"function on_step() for i = 1, 3 do self:push(0, 0, 9e5 * self:mass()) end end": r"it:1: push: expected at most [\d.e+]+ along an axis in a step",
			"function on_step() self:push(0, 0, 1, 1e7, 0, 0) for i = 1, 9 do self:twist(0, 1e5, 0) end end": r"it:1: \w+: expected at most [\d.e+]+ along an axis in a step",
			"function on_step()\n hull { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } } } end":
				r"it:2: hull\.points: expected at least four different points",
			"function on_step() hull { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 } } } end":
				r"it:1: hull\.points: .*in one plane",
			"local t = {} for i = 1, 4000 do t[i] = { i % 7, i % 11, i % 13 } end function on_step() for i = 1, 9 do hull { points = t } end end":
				r"it:1: stopped after a million instructions",
			"function on_step() sphere { radius = 1, dies = 3 } end": r"sphere: expected neither born nor dies",
			"function on_step() sphere { radius = 1, varying_force = { kind = 'pulse', force = { 1, 0, 0 }, to = 1 } } end":
				r"it:1: sphere: expected neither path nor varying_force",
			"function on_step() sphere { radius = 1, kind = 'kinematic', path = { kind = 'sine', amplitude = { 1, 0, 0 }, frequency = 1 } } end":
				r"it:1: sphere: expected neither path nor varying_force",
			"function on_step() sphere { radius = 1, script = 'its' } end": r'unknown script "its", did you mean "it"',
			"function on_step()\n sphere { radius = .1, at = { random(0, 99), random(0, 99), 9 } } end":
				r"it:2: 3 objects that scripts have created exist, and the scene has no room for more",
			"function on_step() for i = 1, 1e6 do ('a'):rep(300):find('a-a-b') end end": r"it:1: pattern too costly",
		}
		for script, expected in cases.items():
			with self.subTest(script=script):
				said = self.one(script, scene="duration = .2, room = 3")
				self.assertEqual(said.count("\n"), 1, said)
				self.assertRegex(said, r"^obsim: warning: the script of object 1 \(ball\) was stopped at [\d.]+ s: .*" + expected)

	def test_no_effect(self):
		"""What a script does in vain is said once of the script, with object, file, line and remedy; it goes on."""
		cases = {
			("function on_start() end\nfunction on_stp(dt) end", "mass = 2"): r"it:2: on_stp: no event calls a function of this name, did you mean on_step\?",
			("function onContact(other) end", "mass = 2"): r"it:1: onContact: no event calls a function of this name, did you mean on_contact\?",
			("function on_step()\n self:force(1, 2, 3) end", "kind = 'kinematic'"):
				r'it:2: self:force has no effect: the object is kinematic, did you mean kind = "dynamic"\?',
			("function on_step() self:push(1, 2, 3) end", "kind = 'static'"): r"it:1: self:push has no effect: the object is static",
			("function on_step() self:velocity(1, 2, 3) end", "mass = 2"): r"it:1: velocity takes no values and sets nothing: self:push",
		}
		for (script, object), expected in cases.items():
			for words in [], HARDENED:
				with self.subTest(script=script, words=words):
					said = self.run_scene(f"""
scene {{ duration = .2 }}
ground {{}}
script("it", [[{script}]])
for i = 1, 3 do sphere {{ name = "ball " .. i, radius = .5, at = {{ 2 * i, 0, 1000 }}, script = "it", {object} }} end
""", *words)
					self.assertEqual(said.count("\n"), 1, said)
					self.assertRegex(said, r"^obsim: warning: the script of object \d \(ball \d\): " + expected)
		for script in "function on_start() print('at', self:position()) end", "function once() end function on_start() once() end":
			self.assertNotIn("warning", self.one(script))

	def test_report_counts(self):
		"""The report has the number of objects whose scripts were stopped, and were warned of, more than are logged."""
		text = """
scene { duration = .2, room = 1 }
ground {}
script("fails", "function on_step() local t t.x = 1 end")
script("crowds", "function on_start() self:id(3) for i = 1, 2 do sphere { radius = .1, at = { i, 0, 9 } } end end")
script("idles", "function on_step() self:velocity(1, 2, 3) end function on_stp() end")
script("works", "function on_step() self:push(0, 0, 1) end")
for i = 1, 70 do sphere { radius = .1, at = { i, 4, 99 }, script = i <= 40 and "fails" or i <= 60 and "idles" or "works" } end
sphere { radius = .1, at = { 0, 9, 9 }, script = "crowds" }
"""
		for words in [], ["--isolation", "process"], HARDENED, MONOLITH:
			with self.subTest(words=words):
				found = self.report_of(text, *words)
				self.assertEqual((found["scripts_stopped"], found["scripts_warned"]), (41, 20))
		done = program.call("run", self.path("scene.lua"))
		self.assertIn("  scripts      41 stopped by an error, 20 with something in vain\n", done.stdout)
		self.assertRegex(done.stdout, r"(?m)^ +object 1 \(sphere#1\) in step 1: fails:1: attempt to index .*\n( +object .*\n){3} +and 37 more$")
		self.assertIn("more scripts were stopped: the report has their number", done.stderr)
		self.write("scene.lua", "sphere { radius = 1 }")
		self.assertNotIn("  scripts ", program.call("run", self.path("scene.lua")).stdout)

	def test_work_counts(self):
		"""What is done in one instruction counts for its length: all of these are stopped by their count, none by a clock."""
		for work in ("local t = {} for i = 1, 9999 do t[i] = i end while true do table.insert(t, 1, 0) table.remove(t, 1) end",
				"local s, n = ('a'):rep(60000), 0 local t = s .. 'b' s = s .. 'a' while true do n = s < t end",
				"local s, n = ('\\0'):rep(60000), 0 local t = s .. 'b' s = s .. 'a' while true do n = s < t end",
				"local s, n = ('a'):rep(60000), 0 local t = 'b' .. s s = 'b' .. s while true do n = s == t end",
				"local s, n = ('1'):rep(60000), 0 while true do n = tonumber(s) end",
				"local t, n = {} for i = 1, 9999 do t[i] = '' end while true do n = table.concat(t) end",
				"local n while true do n = (''):rep(60000) end",
				"local next = ('a'):rep(60000):gmatch('b') while true do next() end",
				"local t = {} for i = 1, 9e9 do t[i % 40000] = {} end",
				"while true do find('nobody') end"):
			with self.subTest(work=work):
				said = self.one("function on_start()\n" + work + " end", scene="duration = .1")
				self.assertRegex(said, r"it:2: stopped after a million instructions")

	def test_calls_count(self):
		"""A call counts for its work, so these are more than a million instructions."""
		for calls, call in ((1000, "ray(0, 0, 5, 1, 0, 0)"), (40000, "random_rotation()"), (90000, "self:position()"),
				(90000, "self:velocity()"), (90000, "self:mass()"), (90000, "self:name()"), (90000, "self:exists()"),
				(90000, "self:force(1, 2, 3)"), (60000, "self:spin()"), (70000, "self.state.x")):
			with self.subTest(call=call):
				said = self.run_scene(f"""
scene {{ duration = .1 }}
script("it", "function on_start() for i = 1, {calls} do local x = {call} end end")
for i = 1, 300 do sphere {{ radius = .4, at = {{ 400 - i, 0, 5 }} }} end
sphere {{ radius = .4, at = {{ 0, 0, 5 }}, script = "it" }}
""")
				self.assertRegex(said, r"it:1: stopped after a million instructions")

	def test_one_stops_others_go_on(self):
		said = self.run_scene("""
scene { duration = .5 }
ground {}
script("it", [[
function on_start() self:wake(.2) end
function on_wake() if self:name() == "bad" then while true do end end print("fine", self:id()) end
]])
for i = 1, 5 do sphere { name = i == 3 and "bad" or "good " .. i, radius = .1, at = { i, 0, 9 }, script = "it" } end
""", "--workers", 2)
		self.assertEqual(sorted(i for i, in self.numbers(said, "fine")), [1, 2, 4, 5])
		self.assertEqual(said.count("warning"), 1)

	def test_hardened(self):
		"""Simulators that cannot write the universe pass on all requests of scripts, receive events, and fail
		properly."""
		scene = """
scene { duration = 1, room = 9 }
ground {}
script("bomb", "function on_step() local t = {} for i = 1, 1e9 do t[i] = { i } end end")
script("child", "function on_start() print('born', self.state.n) send(find('mother'), self.state.n) self:remove() end")
script("mother", [[
function on_contact(other, impulse, point)
	print("touched", other:name(), impulse, point[3])
	for i = 1, 8 do sphere { radius = .1, at = { i, 3, 1 }, script = "child", state = { n = i, text = ("x"):rep(100) } } end
	self:colour("#ff0000") self:torque(0, 0, 1) self:push(0, 0, 5)
end
function on_message(from, n)
	self.state.sum = (self.state.sum or 0) + n
	if n == 8 then print("sum", self.state.sum, self:position()) end
end
]])
sphere { name = "mother", radius = .5, at = { 0, 0, .6 }, script = "mother" }
sphere { name = "bad", radius = .5, at = { 4, 0, .6 }, script = "bomb" }
"""
		expected = self.run_scene(scene)
		self.assertEqual([n for n, in self.numbers(expected, "born")], list(range(1, 9)))
		self.assertEqual(self.numbers(expected, "sum")[0][0], 36)
		self.assertEqual(expected.count("needs more than 4 MiB"), 1)
		for workers in 1, 3, "objects":
			with self.subTest(workers=workers):
				said = self.run_scene(scene, *HARDENED, "--workers", workers)
				self.assertEqual(sorted(said.splitlines()), sorted(expected.splitlines()))

	def test_refused(self):
		"""Errors before the run are errors of the scene, or of the command line."""
		for field, expected in {
			"script = 'none.lua'": r"scene\.lua:1: sphere\.script: cannot read .*none\.lua: No such file",
			"script = '../x.lua'": r"expected a file in the folder of the scene",
			"script = '/etc/x.lua'": r"expected a file in the folder of the scene",
			"script = 'none'": r"expected the name of a script, of a file that ends with \.lua, or a script as text",
			"script = 3": r"expected the name of a script.*got 3",
			"script = 'function on_step('": r"sphere\.script: scene\.lua script 1:1: .* expected",
			"state = { x = 1 }": r"sphere\.state: expected none where there is no script",
			"script = 'function f() end', state = { {} }": r"sphere\.state: expected a number, text, true, false or an object",
		}.items():
			with self.subTest(field=field):
				said = self.run_scene(f"sphere {{ radius = 1, {field} }}", code=2)
				self.assertRegex(said, expected)

	def test_confined(self):
		"""Measures without the outbox let scripts write the universe."""
		hashes = {program.report(*self.FLOCK, *ROOMY, "--isolation", "process", *more)["state_hash"]
			for more in ([], ["--harden=privileges,limits,calls"])}
		self.assertEqual(len(hashes), 1)
		self.one("function on_start() print('said', 1) end", "--isolation", "process", "--harden=privileges,limits,calls")

	def test_turning_path(self):
		"""An object that a path turns has the path's attitude, before and after a restart, and throws off
		objects that stand on it."""
		scene = self.write("scene.lua", """
scene { duration = 4 }
ground {}
script("it", [[
function on_start() self:wake(.5) end
function on_wake() print("at", time(), find("door"):attitude()) print("rate", find("door"):spin()) if time() < 3.4 then self:wake(1) end end
]])
local s = math.sqrt(.5)
box { name = "door", size = { 2, .1, 1 }, at = { 0, 0, 2 }, rotation = { axis = { 0, 0, 1 }, degrees = 90 }, kind = "kinematic",
	path = { kind = "spline", points = { { 0, 0, 0, 0, 1, 0, 0, 0 }, { 1, 0, 0, 1, s, s, 0, 0 }, { 2, 0, 0, 1, s, s, 0, 0 }, { 3, 0, 0, 0, 1, 0, 0, 0 } } } }
box { name = "rider", size = { .2, .2, .2 }, at = { 0, .7, 2.6 }, mass = 1, friction = .1 }
sphere { radius = .1, at = { 9, 9, .1 }, script = "it" }
""")
		expected = [(1, 45, 90), (2, 90, 0), (3, 45, -90), (4, 0, 0)]
		for words in [], MONOLITH:
			said = program.call("run", scene, *words).stderr
			for (_, degrees, rate), (t, *q), w in zip(expected, self.numbers(said, "at"), self.numbers(said, "rate")):
				a, s = math.radians(degrees) / 2, math.sqrt(.5)
				# by "degrees" about x, after 90 about z
				wanted = [s * math.cos(a), s * math.sin(a), -s * math.sin(a), s * math.cos(a)]
				for x, y in zip(q, wanted):
					self.assertAlmostEqual(x, y, 9, (t, words))
				for x, y in zip(w, (math.radians(rate), 0, 0)):
					self.assertAlmostEqual(x, y, 9, (t, words))
		whole = program.report(scene, *ROOMY)
		program.report(scene, *ROOMY, "--duration", "2.4", "--checkpoint", self.path("half"))
		found = program.report("--resume", self.path("half"), "--duration", "4", *ROOMY, "--isolation", "process")
		self.assertEqual(found["state_hash"], whole["state_hash"])

	# ---- in one ODE world

	def test_monolith(self):
		"""Forces, torques, pushes and timers do there what they do in object simulators."""
		said = self.one("function on_start() self:force(6, 0, 2 * 9.81) self:torque(0, 0, .4) self:push(4, 0, 0) "
		                "self:twist { 0, .6, 0 } self:wake(.5) end "
		                "function on_wake() print('v', self:velocity()) print('w', self:spin()) end", *MONOLITH)
		for found, expected in zip(self.numbers(said, "v")[0] + self.numbers(said, "w")[0], (3.5, 0, 0, 0, 3, 1)):
			self.assertAlmostEqual(found, expected, 9)

	def test_monolith_contact(self):
		"""One event while a contact lasts, asleep or not, and another after a jump."""
		said = self.run_scene("""
scene { duration = 6 }
ground {}
script("it", [[
function on_contact(other, impulse, point) print("hit", time(), impulse, point[3]) self:colour("#ff0000") end
function on_start() self:wake(4) end
function on_wake() self:push(0, 0, 4) end
]])
box { name = "it", size = { .4, .4, .4 }, at = { 0, 0, 1.2 }, mass = 1, script = "it" }
""", *MONOLITH)
		hits = self.numbers(said, "hit")
		self.assertEqual([t > 4 for t, _, _ in hits], [False, True], hits)
		for (_, impulse, _), speed in zip(hits, ((2 * 9.81) ** .5, 4)): # ODE pushes out, beside, a fifth of what has sunk in
			self.assertGreater(impulse, speed - .1)
			self.assertLess(impulse, 1.2 * speed + 2 * 9.81 / 60)
		self.assertAlmostEqual(hits[0][2], 0, delta=.1)

	def test_monolith_population(self):
		"""Objects come and go; the run is the same each time, in a thread or a process."""
		found = [program.report(*self.FLOCK[:1], "-D", "n=30", "-D", "wings=false", "--duration", "2", *ROOMY, *MONOLITH, *more)
			for more in ([], [], ["--isolation", "process"])]
		self.assertGreater(found[0]["objects"], 40)
		self.assertEqual(len({r["state_hash"] for r in found}), 1)
		said = self.one("function on_start() hull { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } } end", *MONOLITH)
		self.assertRegex(said, "was stopped at .*: the one ODE world has no hulls")

	# ---- the same bits

	# A hundred birds that steer, and change colour on contact; and drops that are created and removed.
	FLOCK = [program.scene("flock"), "-D", "n=100", "--duration", "4.5"]

	def bits(self, *words):
		"""The report of a flock's run, and four pictures of it: colours are in no hash."""
		if "no EGL" in program.call("--version").stdout:
			return program.report(*self.FLOCK, *ROOMY, *words), None
		raw = self.path("r.rgb")
		found = program.report(*self.FLOCK, *ROOMY, "--out", raw, "--fps", "1", "--size", "320x180", *words)
		with open(raw, "rb") as f:
			return found, f.read()

	def same(self, found, expected):
		for name in "state_hash", "objects":
			self.assertEqual(found[0][name], expected[0][name])
		self.assertTrue(found[1] == expected[1], "objects look otherwise")

	def test_same_bits(self):
		expected = self.bits("--workers", 1)
		report, pictures = expected
		self.assertGreater(report["objects"], 100 + 30) # drops have been made
		if pictures:
			last = pictures[-320 * 180 * 3:]
			flushed = sum(r > 150 and g < 120 and b < 90 for r, g, b in zip(last[::3], last[1::3], last[2::3]))
			self.assertGreater(flushed, 0, "no bird has flushed")
		for isolation in "thread", "process":
			for workers in program.ways(2, 3, 5, 8, "objects"):
				with self.subTest(isolation=isolation, workers=workers):
					self.same(self.bits("--isolation", isolation, "--workers", workers), expected)
		looked = program.report(*self.FLOCK, "--set", "measure=step")
		self.assertEqual(looked["state_hash"], report["state_hash"])

	def test_killed(self):
		expected = self.bits()
		for workers in program.ways(1, 2, 8):
			with self.subTest(workers=workers):
				found = self.bits("--isolation", "process", "--workers", workers, "--fault", "kill:p=.0005,seed=3")
				self.assertGreater(found[0]["deaths"], 0)
				self.same(found, expected)

	def test_hardened_same_bits(self):
		"""With simulators that pass on requests of scripts; with kills, and with random writes to their
		results."""
		flock = [program.scene("flock"), "-D", "n=30", "--duration", "2.5", *ROOMY]
		expected = program.report(*flock)
		for words in (["--workers", 1], ["--workers", "objects"], ["--workers", 2, "--fault", "kill:p=.001,seed=3"],
				["--workers", 2, "--fault", "scribble:p=.002,words=20,seed=3"]):
			with self.subTest(words=words):
				found = program.report(*flock, *HARDENED, *words)
				self.assertEqual(found["state_hash"], expected["state_hash"])
				self.assertEqual(found["objects"], expected["objects"])
				self.assertEqual(found["deaths"] > 0, "--fault" in words)

	def test_resumed(self):
		expected = program.report(*self.FLOCK, *ROOMY)
		program.report(*self.FLOCK[:-1], "2.3", *ROOMY, "--checkpoint", self.path("half"))
		found = program.report("--resume", self.path("half"), "--duration", "4.5", *ROOMY, "--workers", 2)
		self.assertEqual(found["state_hash"], expected["state_hash"])
		self.assertEqual(found["objects"], expected["objects"])

	CRYSTALS = """
scene { duration = 3, room = 20 }
ground {}
script("crystal", "function on_start() self:wake(1) end function on_wake() self:remove() end")
script("grow", [[
function on_start() self:wake(.05) end
function on_wake()
	local points = {}
	for i = 1, 12 do points[i] = { random(-.3, .3), random(-.3, .3), random(-.3, .3) } end
	hull { points = points, at = { random(-1, 1), random(-1, 1), 2 }, script = "crystal" }
	if random() < .5 then
		hull { points = { { 0, 0, 0 }, { .4, 0, 0 }, { 0, .4, 0 }, { 0, 0, .4 } }, at = { random(-1, 1), random(-1, 1), 3 }, script = "crystal" }
	end
	self:wake(.15)
end
]])
hull { points = { { 0, 0, 0 }, { .4, 0, 0 }, { 0, .4, 0 }, { 0, 0, .4 } }, at = { 0, 0, 1 }, spin = { 3, 2, 1 } }
sphere { name = "mother", radius = .1, at = { 0, 5, .1 }, script = "grow" }
"""

	def test_hulls_same_bits(self):
		"""Hulls have the same numbers in any configuration, after deaths, and after a resume."""
		scene = self.write("crystals.lua", self.CRYSTALS)
		expected = program.report(scene, *ROOMY, "--workers", 1)
		self.assertGreater(expected["objects"], 6)
		for words in (["--workers", 3], ["--isolation", "process", "--workers", 2],
				[*HARDENED, "--workers", 2],
				["--isolation", "process", "--workers", 2, "--fault", "kill:p=.002,seed=5"]):
			with self.subTest(words=words):
				found = program.report(scene, *ROOMY, *words)
				self.assertEqual(found["state_hash"], expected["state_hash"])
		self.assertGreater(found["deaths"], 0)
		program.report(scene, *ROOMY, "--duration", "1.7", "--checkpoint", self.path("half"))
		found = program.report("--resume", self.path("half"), "--duration", "3", *ROOMY, "--workers", 2)
		self.assertEqual(found["state_hash"], expected["state_hash"])

	def test_too_many_hulls(self):
		"""A universe keeps all hulls that it ever had, up to a limit, which is an error of the script."""
		said = self.run_scene("""
scene { duration = 3, step = 1 / 600, room = 30, gravity = { 0, 0, 0 } }
script("brief", "function on_start() self:remove() end")
sphere { radius = .1, at = { 0, 0, 9 }, script = [[function on_step()
	for i = 1, 5 do
		hull { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 + random() } }, at = { 3 * i, 0, 0 }, script = "brief" }
	end
end]] }
""")
		self.assertRegex(said, "was stopped at .*: there is no room for more than 4096 different hulls")

	def test_resumed_with_another_script(self):
		self.write("it.lua", "function on_step() self:force(1, 0, 0) end")
		scene = self.write("scene.lua", "scene { duration = 1 } sphere { radius = 1, script = 'it.lua' }")
		program.report(scene, "--checkpoint", self.path("half"))
		self.write("it.lua", "function on_step() self:force(2, 0, 0) end")
		done = program.call("run", "--resume", self.path("half"), "--duration", 2)
		self.assertEqual(done.returncode, 1)
		self.assertRegex(done.stderr, r"its scripts are not those of the saved run")


unittest.main()
