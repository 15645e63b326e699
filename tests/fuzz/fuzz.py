#!/usr/bin/env python3
"""Fuzzing of the built program: scenes, Lua, command lines, checkpoints that no person would write.

    fuzz.py OBSIM KIND ... [--count N | --hours H] [--seed S] [--keep DIR]

KIND is one of: scenes (generated, edge values in all fields), lua (mutants of the shipped scenes), words (command
lines), checkpoints (mutants of a run's own), recordings (the same), records (mutants of the results of compare), schedules (of
free runs, most with true checksums). Each
case is a process of its own. With any input, it must end by itself with 0, 1 or 2, and report errors in lines that
begin "obsim: ". It must leave no universe behind, send no control character to a terminal, and compute no longer than
its CPU time allows. Failing cases are stored in DIR (fuzz-kept) with a command that repeats them, and the exit code is
1.

For hours, all kinds in turn, on a build with sanitizers:

    meson setup build-asan -Dbuildtype=debugoptimized -Db_sanitize=address,undefined -Db_lto=false && ninja -C build-asan
    export UBSAN_OPTIONS=halt_on_error=1 ASAN_OPTIONS=intercept_tls_get_addr=0 LSAN_OPTIONS=suppressions=$PWD/tests/leaks.txt
    setarch -R python3 tests/fuzz/fuzz.py build-asan/obsim all --hours 8 --seed $RANDOM

Segments, meshes, requests, and checkpoints with valid checksums are read in the fuzzer's own process, up to a million
in some minutes: tests/fuzz/segments.c, meshes.c, requests.c, tests/checkpoint/test_hostile.c.
"""

import argparse
import glob
import math
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "run"))

import glb

SCENES = os.path.join(HERE, "..", "..", "scenes")
CPU_SECONDS = 60  # per case: a step's whole budget is some 5 s, and a sanitizer takes ten times as long
WALL_SECONDS = 1800  # detects endless waits; generous for overloaded machines
OUTPUT_MAX = 1 << 20  # bytes

EDGES = [0., -0., 5e-324, 1e-300, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, .01, .1, .5, 1., 1.5, 3., 10., 100., 1e3, 1e6, 1e7, 1e9,
	1e15, 1e16, 1e300, 1.7976931348623157e308]


class Scenes:
	"""Generated scenes. Mostly valid, so that they run; now and then anything."""

	def __init__(self, r):
		self.r = r
		self.scripts, self.hulls = 0, False  # number of the scene's scripts, True if it has hulls

	def number(self, low, high, wild=.004):
		r = self.r
		if r.random() < wild:
			return r.choice(["0/0", "1/0", "-1/0", "nil", "true", "'1'", "{}", "-1e400", "2^63", repr(r.choice(EDGES))])
		kind = r.random()
		if kind < .35:
			inside = [x for e in EDGES for x in (e, -e) if low <= x <= high]
			return repr(r.choice(inside) if inside else low)
		if kind < .5:
			return repr(r.choice((low, high)))
		if kind < .75 and low >= 0:
			return repr(math.exp(r.uniform(math.log(max(low, 1e-9)), math.log(max(high, 1e-9)))))
		return repr(r.uniform(max(low, -10), min(high, 10)))

	def vector(self, low, high):
		if self.r.random() < .003:
			return self.r.choice(["{}", "{1, 2}", "{1, 2, 3, 4}", "{1, 2, 'x'}", "7", "{x = 1, y = 2, z = 3}"])
		return "{" + ", ".join(self.number(low, high, .001) for _ in range(3)) + "}"

	def size(self):
		"""In metres, mostly: bodies with absurd sizes in all directions just fly by."""
		return self.number(1e-4, 1e6) if self.r.random() < .05 else repr(self.r.uniform(.05, 2))

	def place(self):
		return self.vector(-1e7, 1e7) if self.r.random() < .1 else self.vector(-3, 3)

	def one_of(self, right, wrong):
		"""A scene with one fault is rejected without a step, so faults are rare."""
		return self.r.choice(wrong if self.r.random() < .005 else right)

	def maybe(self, chance, name, value):
		return [f"{name} = {value()}"] if self.r.random() < chance else []

	def hull_points(self):
		"""Corners, mostly of bodies; some flat, tiny, huge, or repetitions of one point."""
		r = self.r
		kind = r.choice(["few", "many", "box", "prism", "round"] if r.random() < .9 else ["flat", "line", "same", "tiny", "huge", "crowd"])
		if kind == "crowd":
			return f"(function() local p = {{}} for i = 1, {r.choice([5, 300, 4096, 4097])} do p[i] = {{ random(-1, 1), random(-1, 1), random(-1, 1) }} end return p end)()"
		if kind == "round":
			n = self.one_of([12, 40, 64], [70])
			points = [(math.cos(2.4 * i) * math.sqrt(max(0, 1 - z * z)), math.sin(2.4 * i) * math.sqrt(max(0, 1 - z * z)), z) for i in range(n) for z in [1 - 2 * i / n]]
		elif kind == "box":
			points = [(x, y, z) for x in (-.5, .5) for y in (-.3, .3) for z in (0, r.uniform(.01, 1))]
		elif kind == "prism":
			n = r.randint(3, 31)
			points = [(.5 * math.cos(2 * math.pi * i / n), .5 * math.sin(2 * math.pi * i / n), z) for i in range(n) for z in (0, r.choice([1e-6, .01, .5, 20]))]
		else:
			points = [[r.uniform(-.5, .5) for _ in range(3)] for _ in range(r.randint(4, 12) if kind != "many" else r.randint(20, 60))]
		if kind == "flat":
			points = [(x, y, r.choice([0, 0, 1e-15, 1e-9, 1e-4, 1e-3]) * z) for x, y, z in points]
		if kind == "line":
			points = [(x, 1e-12 * y, 1e-12 * z) for x, y, z in points]
		if kind == "same" or r.random() < .1:
			points += [r.choice(points) for _ in range(20)]
		if kind in ("tiny", "huge") or r.random() < .1:
			scale = {"tiny": r.choice([1e-12, 1e-6, 1e-4, .01]), "huge": r.choice([10, 1e3, 1e5, 1e9])}.get(kind, 1)
			off = r.choice([0, 0, 10, 1e5])
			points = [[scale * c + off for c in p] for p in points]
		return "{" + ", ".join("{" + ", ".join(repr(c) for c in p) + "}" for p in points) + "}"

	def timed_points(self, most, closed, turns=False):
		r = self.r
		points, t = [], 0.
		for _ in range(self.one_of([2, 2, 3, 3, 5, 40], [0, 1, 1025])):
			turned = [repr(r.choice([0., 1., 1e-9, r.uniform(-1, 1)])) for _ in range(self.one_of([4], [3, 0]))] if turns else []
			points.append(f"{{{t!r}, " + ", ".join([self.number(-most, most, .001) for _ in range(3)] + turned) + "}")
			t += self.one_of([.1, .3, 1, 1e6, r.uniform(.07, .2)], [1e-9, 1e-3])
		if closed and points:
			points.append(f"{{{t!r}, " + points[0].split(", ", 1)[1])
		return "{" + ", ".join(points) + "}"

	def path(self):
		r = self.r
		kind = self.one_of(["sine", "circle", "spline"], ["square"])
		fields = [f"kind = '{kind}'"]
		if kind == "sine":
			fields += [f"amplitude = {self.vector(-1e6, 1e6) if r.random() < .2 else self.vector(-1, 1)}"] + self.maybe(.4, "phase", lambda: self.number(-1e3, 1e3))
		if kind == "circle":
			fields += [f"centre = {self.place()}"] + self.maybe(.5, "axis", lambda: self.vector(-1, 1))
		if kind == "spline":
			loop = self.one_of([False, True], [0])
			points = self.timed_points(1e7 if r.random() < .1 else 2, loop or r.random() < .1, r.random() < .3)
			return f"{{ kind = 'spline', points = {points}, loop = {'true' if loop is not False else 'false'} }}"
		return "{ " + ", ".join(fields) + f", frequency = {self.number(1e-9, 1e4) if r.random() < .3 else r.uniform(.1, 5)} }}"

	def varying_force(self):
		r = self.r
		kind = self.one_of(["sine", "pulse", "linear"], ["cosine"])
		force = f"force = {self.vector(-1e15, 1e15) if r.random() < .1 else self.vector(-1e4, 1e4)}"
		if kind == "linear":
			return f"{{ kind = 'linear', points = {self.timed_points(1e15 if r.random() < .1 else 1e4, False)} }}"
		if kind == "pulse":
			return f"{{ kind = 'pulse', {force}, from = {self.number(0, .1)}, to = {self.number(.1, 1e9)} }}"
		phase = self.maybe(.3, "phase", lambda: self.number(-1e3, 1e3))
		return "{ " + ", ".join([f"kind = '{kind}'", force, f"frequency = {self.number(1e-9, 1e4)}"] + phase) + " }"

	def shape(self, kind):
		if kind == "box":
			return ["size = {" + ", ".join(self.size() for _ in range(3)) + "}"]
		if kind == "hull":
			self.hulls = True
			return [f"points = {self.hull_points()}"]
		fields = [f"radius = {self.size()}"] if kind in ("sphere", "capsule", "cylinder") else []
		return fields + ([f"length = {self.size()}"] if kind in ("capsule", "cylinder") else [])

	def mesh(self):
		"""Mesh of a body: the files lie beside the scene."""
		path = self.one_of(["ball.glb", "lane.glb"], ["none.glb", "../ball.glb", "/etc/passwd", "scene.lua", ""])
		fields = [f"mesh = '{path}'"] + self.maybe(.3, "mesh_scale", lambda: self.number(1e-9, 1e6)) + self.maybe(.3, "mesh_at", self.place)
		return fields + self.maybe(.3, "mesh_rotation", lambda: f"{{ axis = {self.vector(-1, 1)}, degrees = {self.number(-36000, 36000)} }}")

	def motion(self, static):
		"""Prescribed or initial motion of a body."""
		r = self.r
		fields = []
		kinematic = not static and r.random() < .15
		moved = kinematic and r.random() < .6
		if static:
			return [r.choice(["static = true", "kind = 'static'"])]
		if not moved:
			fields += self.maybe(.5, "velocity", lambda: self.vector(-1e5, 1e5) if r.random() < .2 else self.vector(-9, 9))
		fields += self.maybe(.4, "spin", lambda: self.vector(-1e4, 1e4) if r.random() < .2 else self.vector(-9, 9))
		if kinematic:
			return fields + ["kind = 'kinematic'"] + ([f"path = {self.path()}"] if moved else [])
		fields += self.maybe(.2, "force", lambda: self.vector(-1e4, 1e4) if r.random() < .8 else self.vector(-1e7, 1e7))
		fields += self.maybe(.1, "varying_force", self.varying_force)
		weight = r.random()
		fields += [f"mass = {self.number(1e-12, 1e12)}"] if weight < .3 else []
		fields += [f"density = {self.number(1e-3, 1e9)}"] if .3 < weight < .4 else []
		return fields

	def body(self):
		r = self.r
		kind = self.one_of(["box", "sphere", "capsule", "cylinder", "hull", "plane"], ["ground"])
		fields = self.shape(kind)
		if kind == "plane":
			fields += self.maybe(.8, "normal", lambda: self.vector(-1, 1))
		if kind == "ground":
			fields += self.maybe(.3, "height", lambda: self.number(-1e7, 1e7))
		else:
			fields += self.maybe(.9, "at", self.place)
			fields += self.maybe(.05, "name", self.text)
			fields += self.maybe(.05, "born", lambda: self.number(0, .1))
			fields += self.maybe(.05, "dies", lambda: self.number(1e-3, 1e9))
		fixed = kind in ("plane", "ground")
		if not fixed:
			fixed = r.random() < .15
			fields += self.motion(fixed)
			fields += self.mesh() if r.random() < .03 else []
			turned = r.random()
			if turned < .3:
				fields.append("q = {" + ", ".join(self.number(-2, 2) for _ in range(4)) + "}")
			if .3 < turned < .5:
				fields.append(f"rotation = {{ axis = {self.vector(-1, 1)}, degrees = {self.number(-36000, 36000)} }}")
		if fixed or "kind = 'kinematic'" in fields:
			fields += self.maybe(.3, "surface_velocity", lambda: self.vector(-1e5, 1e5) if r.random() < .2 else self.vector(-3, 3))
		if self.scripts and kind != "ground" and r.random() < .5 and not any(f.startswith("varying_force") for f in fields):
			fields.append(f"script = '{self.one_of([f's{r.randrange(self.scripts)}', 'drop.lua'], ['none.lua', 's9', 'self:remove()'])}'")
			fields += self.maybe(.3, "state", lambda: self.one_of(["{}", "{ a = 1, b = 'x', c = true }", "{ 1, 2, 3 }"], ["{ a = {} }", "{ a = ('x'):rep(2000) }", "7"]))
		fields += self.maybe(.1, "group", lambda: self.one_of(["0", "1", "15"], ["32", "-1", ".5"]))
		fields += self.maybe(.1, "hits", lambda: self.one_of(["{}", "{ 0, 1 }", "{ 15 }"], ["{ 32 }", "{ 'a' }", "1"]))
		fields += self.maybe(.05, "sensor", lambda: r.choice(["true", "false"])) if kind != "ground" else []
		fields += self.maybe(.05, "visible", lambda: r.choice(["true", "false"]))
		fields += self.maybe(.2, "friction", lambda: self.number(0, 1000))
		fields += self.maybe(.4, "restitution", lambda: self.number(0, 1))
		fields += self.maybe(.05, "colour", self.colour)
		fields += self.maybe(.05, "roughness", lambda: self.number(0, 1)) + self.maybe(.05, "metal", lambda: self.number(0, 1))
		fields += self.maybe(.1, "material", lambda: self.one_of(["'a'", "'b'"], ["'c'"]))
		fields += self.maybe(.1, "grid", lambda: r.choice(["true", "false"])) if kind == "ground" else []
		fields += self.maybe(.01, r.choice(["sise", "material", "[1]", "camera"]), lambda: self.number(-1, 1))
		r.shuffle(fields)
		return f"{kind} {{ {', '.join(fields)} }}"

	# Calls of scripts, valid and invalid.
	DEEDS = ["while true do end", "local t = {} for i = 1, 1e7 do t[i] = ('x'):rep(1000) .. i end", "local s = 'x' while true do s = s .. s end",
		"sphere { radius = .1, at = { random(-2, 2), random(-2, 2), 3 } }", "for i = 1, 40 do box { size = { .1, .1, .1 }, at = { i, 0, 2 } } end",
		"sphere { radius = .1, at = { self:position() }, script = 's0' }", "self:remove()", "for _, o in ipairs(near(1e9)) do o:remove() end",
		"for _, o in ipairs(near(5)) do send(o, 'hello', o, 1, true) end", "send(self, 1, 2, 3)", "send(nil, 1)", "send(self, ('x'):rep(5000))", "send(self, {})",
		"for i = 1, 1000 do send(self, i) end", "self:force(0/0, 0, 0)", "self:force(1e308, -1e308, 1e300)", "self:force(1, 2)", "self:force { 0, 0, 50 }",
		"self:torque(0, 1e300, 0)", "self:torque(0, 0, 3)", "self:push(1, 2, 3)", "self:push(1e15, 0, 0, 1e15, 1e15, 0)", "self:push(0, 0, 1, 0/0, 0, 0)",
		"self:twist(1, 0, 0)", "self:twist(1e300, 1e300, 1e300)", "self:colour('#ff0000')", "self:colour('red')", "self:colour { 2, 0, 0 }", "self:wake(.01)",
		"self:wake(0)", "self:wake(-1)", "self:wake(1e300)", "self:wake(0/0)", "self.state.a = (self.state.a or 0) + 1", "self.state.b = ('x'):rep(2000)",
		"self.state.c = self", "self.state.t = {}", "self.state = nil", "x = 1", "local a, b, c = self:position() self:push(-a, -b, -c)",
		"local o, d = ray(0, 0, 9, 0, 0, -1) if o and o:exists() then o:name() end", "ray(0, 0, 0, 0, 0, 0)", "ray(0/0, 0, 0, 1/0, 0, 0, -1)", "near(0/0)",
		"near(-1)", "find('two words')", "find('a'):remove()", "error({})", "error('\\27[2J')", "local function f() return f() + 1 end f()", "nothing()",
		"self:turned(1, 2)", "print(self:spin(), self:attitude(), self:mass(), self:id(), time())", "math.random(0)", "random_rotation()",
		"('x'):rep(1e9)", "('a'):rep(200):find(('a*'):rep(30) .. 'b')", "for k, v in pairs(self.state) do self.state[k] = nil end"]

	def script(self, number):
		r = self.r
		functions = []
		for name in r.sample(["on_start()", "on_step(dt)", "on_message(from, ...)", "on_contact(other, impulse, point)", "on_wake()", "on_stop()"], r.randint(1, 4)):
			functions.append(f"function {name} {' '.join(r.choice(self.DEEDS) for _ in range(r.choice([1, 1, 2, 3])))} end")
		if r.random() < .03:
			functions.append(r.choice(["while true do end", "end", "self:remove()", "on_step = 5", "t = {} for i = 1, 1e7 do t[i] = i end", "\0"]))
		return f"script('s{number}', [=[" + "\n".join(functions) + "]=])"

	def text(self):
		return "(" + self.one_of(["'a'", "'köln'", "'two words'", "('n'):rep(47)"], ["''", "'a#1'", "('n'):rep(48)", "'\\27[2J'", "'\\xff'", "'\\u{202e}'", "5"]) + ")"

	def head(self):
		r = self.r
		fields = self.maybe(.7, "step", lambda: self.number(1e-4, 10) if r.random() < .3 else r.choice(["1/60", "1/30", "1/240"]))
		many = r.random() < .05  # substeps: wild scenes take the maximum, and most of a campaign's time
		fields += self.maybe(.8, "substeps", lambda: str(self.one_of([32, 256, 1000] if many else [1, 1, 2, 4, 8], [1001, 0])))
		if not any(f.startswith("substeps") for f in fields):
			fields += self.maybe(.9, "tolerance", lambda: self.number(1e-6 if many else .01, 1))
		fields += self.maybe(.2, r.choice(["iterations", "iterations", "passes"]), lambda: str(r.choice([1, 2, 16, 1000, 100000])))
		fields += self.maybe(.3, r.choice(["solver", "solver", "exchange"]), lambda: r.choice(["'coloured'", "'jacobi'", "'ghost'", "'lagged'"]))
		if any(f.endswith("= 'lagged'") for f in fields) or r.random() < .01:
			fields += self.maybe(.5, "lag", lambda: str(self.one_of([0, 1, 7, 256], [257, -1])))
		fields += self.maybe(.2, "integrator", lambda: r.choice(["'exact'", "'ode'"]))
		fields += self.maybe(.3, "sleeping", lambda: r.choice(["true", "false"]))
		fields += self.maybe(.3, "gravity", lambda: self.vector(-1e4, 1e4) if r.random() < .3 else "{0, 0, 0}")
		fields += self.maybe(.1, "room", lambda: str(self.one_of([0, 1, 5, 1000], [-1, 100001])))
		fields += self.maybe(.1, "duration", lambda: self.number(1e-3, 1e9))
		fields += self.maybe(.1, "title", self.text) + self.maybe(.1, "seed", lambda: str(self.one_of([0, 1, 2**32, 2**53 - 1], [2**53 + 2, -1, .5])))
		return f"scene {{ {', '.join(fields)} }}"

	def colour(self):
		return self.one_of(["'#ff0000'", "'#00ff0080'", "{1, 0, 0}", "{0, .5, 1, .2}", f"{{{self.number(0, 1)}, 0, 1}}"], ["'red'", "'#12'", "{2, 0, 0}", "{}"])

	def material(self, name):
		fields = []
		for chance, field, value in [(.5, "friction", lambda: self.number(0, 1000)), (.5, "restitution", lambda: self.number(0, 1)),
				(.5, "density", lambda: self.number(1e-3, 1e9)), (.3, "colour", self.colour), (.2, "roughness", lambda: self.number(0, 1)),
				(.2, "metal", lambda: self.number(0, 1))]:
			fields += self.maybe(chance, field, value)
		return f"material {name} {{ {', '.join(fields)} }}"

	def look(self, kind):
		"""Look and cameras."""
		r = self.r
		if kind == "record":
			return f"record {{ every = {self.one_of([1, 2, 1000000], [0, -1, 1e9])} }}"
		if kind == "sun":
			return f"sun {{ towards = {self.vector(-1, 1)} }}"
		fields = []
		if kind == "sky":
			for name in "top", "horizon":
				fields += self.maybe(.7, name, self.colour)
			return f"sky {{ {', '.join(fields)} }}"
		if r.random() < .5:
			fields += [f"eye = {self.place()}", f"target = {self.place()}"]
		else:
			fields += self.maybe(.7, "from", lambda: self.vector(-1, 1))
		for name, value in ("fov", lambda: self.number(1, 170)), ("velocity", lambda: self.vector(-1e6, 1e6)), ("pan", lambda: self.number(-1e4, 1e4)), \
				("tilt", lambda: self.number(-1e4, 1e4)):
			fields += self.maybe(.2, name, value)
		return f"camera{self.text()} {{ {', '.join(fields)} }}"

	def drawn(self):
		"""Parameters and random numbers."""
		return self.r.choice(["local n = param('n', 3, { min = 1, max = 9 })", "local s = param('s', 'a', { 'a', 'b' })", "local x = random(-1, 1)",
			"local q = random_rotation()", "local i = math.random(1, 6)", "local p = param('p', .5)", "local b = param('b', true)",
			"sphere { radius = random(.1, .5), at = { random(), random(), 2 }, q = random_rotation() }"])

	def robot(self):
		"""Two bodies with a joint, and sensors of all kinds on them."""
		r = self.r
		base, arm = self.place(), self.place()
		lines = [f"box {{ name = 'base', size = {self.one_of(['{.4, .2, .1}', '{1, 1, 1}'], ['{}', '{0, 1, 1}'])}, at = {base} }}", f"sphere {{ name = 'arm', radius = .1, at = {arm} }}"]
		kind = r.choice(["hinge", "slider", "ball", "fixed"])
		fields = [f"at = {base}"] if kind != "slider" else []
		if kind in ("hinge", "slider"):
			fields.append(f"axis = {self.one_of(['{0, 0, 1}', '{1, 2, 3}'], ['{0, 0, 0}', '{}'])}")
			fields += self.maybe(.4, "motor", lambda: f"{{ {r.choice(['rate', 'stiffness = 9, to'])} = {self.number(-3, 3)}, most = {self.number(1e-3, 1e6)} }}")
			fields += self.maybe(.2, "friction", lambda: self.number(0, 1e6))
			fields += self.maybe(.2, "low", lambda: self.number(-3, 0)) + self.maybe(.2, "high", lambda: self.number(0, 3))
		if kind != "fixed":
			for name in "stiffness", "damping", "armature":
				fields += self.maybe(.2, name, lambda: self.number(0, 1e6))
		lines.append(f"{kind} {{ 'arm', {self.one_of([chr(39) + 'base' + chr(39)], ['nil', '7'])}, name = 'joint', {', '.join(fields)} }}")
		turns = kind in ("hinge", "slider")
		for _ in range(r.randint(1, 4)):
			kind = r.choice(["imu", "encoder" if turns else "imu", "force_torque", "touch", "lidar"] * 3 + ["camera"])
			of_joint = kind in ("encoder", "force_torque")
			fields = [self.one_of(["joint = 'joint'" if of_joint else "on = 'arm'"] * 9, ["on = 'nobody'", "joint = 5", "on = 'base', joint = 'joint'"])]
			for name, value in [("rate", lambda: self.number(.001, 1e5)), ("noise", lambda: self.number(0, 10)), ("bias", lambda: self.number(0, 10)),
					("walk", lambda: self.number(0, 10)), ("delay", lambda: self.number(0, 10)), ("keep", lambda: str(self.one_of([1, 7, 1000], [0, -1, 1e9, .5])))]:
				fields += self.maybe(.25, name, value) if kind != "camera" or name in ("rate", "delay", "keep") else []
			if not of_joint and kind != "touch":
				fields += self.maybe(.5, "at", lambda: self.vector(-1, 1)) + self.maybe(.2, "rotation", lambda: "{ axis = { 0, 0, 1 }, degrees = 90 }")
			if kind == "lidar":
				for name, value in [("beams", lambda: str(self.one_of([1, 2, 60, 4096], [0, 4097, -1, 1.5]))), ("rows", lambda: str(self.one_of([1, 2, 8], [0, 5000]))),
						("fan", lambda: self.number(0, 360)), ("rise", lambda: self.number(0, 180)), ("reach", lambda: self.number(1e-3, 1e6))]:
					fields += self.maybe(.4, name, value)
			if kind == "camera":
				fields += [f"width = {self.one_of([1, 8, 33], [0, -1, 100000])}", f"height = {self.one_of([1, 8, 17], [0, 1e9])}"]
				fields += self.maybe(.4, "fov", lambda: self.number(1, 170))
			lines.append(f"{kind} {{ {', '.join(fields)} }}")
		return lines

	def scene(self):
		r = self.r
		lines = [self.head()] if r.random() < .95 else []
		self.hulls = False
		self.scripts = r.randint(1, 3) if r.random() < .25 else 0
		lines += [self.script(i) for i in range(self.scripts)]
		lines += [self.look(kind) for kind in ("camera", "sky", "sun", "record") if r.random() < .1]
		lines += [self.drawn() for _ in range(r.choice([0, 0, 0, 1, 2]))]
		lines += [self.material(name) for name in ("'a'", "'b'") if r.random() < .98]
		lines += ["ground {}"] if r.random() < .6 else []
		lines += [self.body() for _ in range(r.randint(1, 12))]
		lines += self.robot() if r.random() < .3 else []
		if r.random() < .1:
			lines.append(f"for i = 1, {r.choice([20, 200])} do sphere {{ radius = .1, at = {{ i % {r.randint(1, 7)}, i // 7, .1 * i }} }} end")
		return "\n".join(lines) + "\n"

	def options(self):
		r = self.r
		words = ["--duration", r.choices([".02", ".05", ".1", ".3"], [6, 4, 1, .3])[0]]
		for chance, more in [(.3, ["--isolation", r.choice(["thread", "process"])]), (.5, ["--workers", r.choice(["1", "2", "3", "objects"])]),
				(.12, ["--set", "narrow=aabb"]), (.05, ["--tolerance", r.choice(["1um", "1mm", "1m", "1m", "1m"])]), (.1, ["--set", "substeps=" + r.choice(["1", "4", "4", "64"])]),
				(.1, ["--set", "solver=" + r.choice(["coloured", "jacobi", "ghost", "lagged"])]), (.1, ["--set", "integrator=" + r.choice(["exact", "ode"])]),
				(.1, ["--set", "measure=" + r.choice(["step", "end", "profile"])]), (.05, ["--step", r.choice(["1e-4", "1/60", ".1", "10"])]),
				(.05, ["--set", "iterations=" + r.choice(["1", "64"])]), (.05, ["--set", "solver=lagged", "--set", "lag=" + r.choice(["0", "3"])]), (.05, ["--set", "sleeping=" + r.choice(["on", "off"])]),
				(.05, ["--seed", r.choice(["0", "7"])]), (.02, ["-D", r.choice(["n=5", "s=b", "p=1/3", "m=1"])]), (.1, ["--explain"]), (.05, ["--trace", "t.json"]), (.05, ["--json", "/dev/null"]),
				(.05, ["--series", "s.csv"]), (.05, ["--record", "r.h5"]), (.05, ["--checkpoint", "c", "--set", "every=.01"]), (.05, ["--strict", "--tolerance", "1mm"]), (.05, ["--set", "verify=on"]), (.1, ["--on-death", "freeze"])]:
			words += more if r.random() < chance else []
		if "process" in words and not self.scripts:
			words += ["--harden"] if r.random() < .3 else []
		if r.random() < (.2 if not self.scripts and not self.hulls else .005):
			words = ["--arch", "monolith", "--set", "iterations=" + r.choice(["20", "0", "1"]), "--duration", ".1"]
		return words

	def case(self, folder):
		path = os.path.join(folder, "scene.lua")
		for beside in "bowling/ball.glb", "bowling/lane.glb", "flock/drop.lua":
			shutil.copy(os.path.join(SCENES, beside), folder)
		with open(path, "w", encoding="utf-8", errors="surrogateescape") as f:
			f.write(self.scene())
		return ["run", path] + self.options()


def mutate(r, data, tokens, most=6):
	"""Bytes changed, cut, doubled, moved, or replaced by tokens."""
	data = bytearray(data)
	for _ in range(r.randint(1, most)):
		at, n = r.randrange(len(data) + 1), r.randint(1, 40)
		kind = r.randrange(7)
		if kind == 0 and at < len(data):
			data[at] = r.randrange(256)
		elif kind == 1:
			del data[at:at + n]
		elif kind == 2:
			data[at:at] = data[(start := r.randrange(len(data) + 1)):start + n]
		elif kind == 3 and r.random() < .2:
			del data[at:]
		elif kind == 4 and at < len(data):
			data[at] ^= 1 << r.randrange(8)
		else:
			data[at:at + r.choice((0, 0, n))] = r.choice(tokens)
	return bytes(data)


class Lua:
	TOKENS = [t.encode("utf-8", "surrogateescape") for t in ["{", "}", "(", ")", "end", "nil", "1e308", "-1", "0/0", "1/0", '"', ",", "={", "[[", "function()",
		"do", "\n", "..", "#", "^", "\0", "box", "scene", "''", "size", "material", "~=", "while true do", "goto", "param", "sphere {}", "camera",
		"2^53", "('x'):rep(1e6)", "math.random(0)", "table.unpack({}, 1, 1e6)", "string.format('%99.99f', 1e308)", "for i = 1, 1e7 do",
		"tostring({})", "error({})", "assert(nil, {})", "pairs(_G)", "t = {} t[t] = t", "%", "*", ".-", "\\u{7fffffff}", "\udcff"]]

	def __init__(self, r):
		self.r = r
		self.scenes = [os.path.basename(path) for path in sorted(glob.glob(os.path.join(SCENES, "*.lua")))]

	def mutate(self, path):
		with open(path, "rb") as f:
			text = f.read()
		with open(path, "wb") as f:
			f.write(mutate(self.r, text, self.TOKENS, 3))

	def case(self, folder):
		"""Mutates a scene, copied with the files that it reads; often its scripts, if it has any."""
		name = self.r.choice(self.scenes)
		path, beside = os.path.join(folder, name), os.path.join(folder, name[:-4])
		shutil.copy(os.path.join(SCENES, name), folder)
		if os.path.isdir(os.path.join(SCENES, name[:-4])):
			shutil.copytree(os.path.join(SCENES, name[:-4]), beside)
		scripts = sorted(glob.glob(os.path.join(beside, "*.lua")))
		self.mutate(self.r.choice(scripts) if scripts and self.r.random() < .7 else path)
		return ["run", path, "--duration", ".1" if scripts else ".02", "--workers", "1", "--set", "measure=end"]


class Words:
	"""Command lines: every option of --help, with valid and invalid values."""

	VALUES = ["", "0", "-1", "1", "2", "1e300", "nan", "inf", "1/0", "1/60", "0x10", "objects", "thread", "process", "monolith", "1mm", "1e-400m", "aabb,contacts",
		"/dev/full", "/dev/null", "/nonexistent/x", ".", "-", "a,b", "100000", "4294967296", "99999999999999999999", "\x1b[31m", "\udcff", "x" * 300, "%s%n",
		"1x1", "0x0", "65536x65536", "n=1", "=", "n=", "none", "main"]

	def __init__(self, r):
		self.r = r
		self.options = {}

	def known(self, obsim):
		for command in ("run", "top", "inspect", "send", "export", "compare"):
			text = subprocess.run([obsim, command, "--help"], capture_output=True, text=True).stdout
			self.options[command] = sorted(set(re.findall(r"--[a-z-]+", text)) - {"--interval"})

	def case(self, folder):
		r = self.r
		command = r.choices(["run", "top", "inspect", "send", "export", r.choice(self.VALUES)], [8, 1, 1, 1, 1, .5])[0]
		words = [command]
		for _ in range(r.randint(0, 5)):
			option = r.choice(self.options.get(command) or ["--help"])
			words += r.choice([[option, r.choice(self.VALUES)], [f"{option}={r.choice(self.VALUES)}"], [option], [r.choice(self.VALUES)]])
		if command == "run" and r.random() < .8:
			words.insert(1, os.path.join(SCENES, "stack.lua"))
			words += ["--duration", ".02"]  # the last one counts, or is rejected
		if command == "top":
			words += ["--once", "--interval", ".05"]
		if command == "send":
			words += r.sample(["none", "create", "remove", "colour", "message", "sphere { radius = 1 }", "'"], 3)
		return [w.replace("\0", "") for w in words]


class Files:
	"""Mutants of files written by the program itself."""

	SCENES = ["stack", "machines", "solids", "flock"]
	NUMBERS = [struct.pack("<d", x) for x in (0, -1, .5, 3, 1e-300, 1e300, -1e300, math.inf, -math.inf, math.nan)] + \
		[struct.pack("<I", x) for x in (0, 1, 2, 21, 255, 0x7fffffff, 0xfffffffe, 0xffffffff)]

	def __init__(self, r):
		self.r = r
		self.seeds = []

	def known(self, obsim):
		for scene in self.SCENES:
			with tempfile.TemporaryDirectory() as folder:
				path = os.path.join(folder, "file")
				subprocess.run([obsim, "run", os.path.join(SCENES, scene + ".lua"), "--duration", ".1", self.WRITTEN_BY, path], stdout=subprocess.DEVNULL,
					check=True)
				with open(path, "rb") as f:
					self.seeds.append(f.read())

	def renumbered(self, data, areas):
		"""Changes numbers in place, in areas (from, to) of equal probability."""
		data = bytearray(data)
		for _ in range(self.r.randint(1, 3)):
			number = self.r.choice(self.NUMBERS)
			first, last = self.r.choice(areas)
			at = self.r.randrange(first, last) // 4 * 4
			data[at:at + len(number)] = number
		return data

	def mutant(self):
		seed = self.r.choice(self.seeds)
		if self.r.random() < .5:
			return bytes(self.renumbered(seed, [(i, i + 4096) for i in range(0, len(seed) - 4096, 4096) if any(seed[i:i + 4096])]))
		tokens = [bytes([x]) * n for x in (0, 1, 127, 255) for n in (1, 4, 8)] + [b"\0\0\0\0\0\0\xf8\x7f"]
		return mutate(self.r, seed, tokens, 3)

	def case(self, folder):
		path = os.path.join(folder, "mutant")
		with open(path, "wb") as f:
			f.write(self.mutant())
		return self.command(path, folder)


CRC64 = []  # table by byte: ECMA-182, reflected
for crc in range(256):
	for _ in range(8):
		crc = crc >> 1 ^ (0xc96c5795d7870f42 if crc & 1 else 0)
	CRC64.append(crc)


def crc64(data):
	crc = (1 << 64) - 1
	for byte in data:
		crc = crc >> 8 ^ CRC64[(crc ^ byte) & 255]
	return crc ^ (1 << 64) - 1


class Checkpoints(Files):
	WRITTEN_BY = "--checkpoint"
	HEADER, LINE = 128, 32  # checkpoint/file.h

	def mutant(self):
		"""Half of them have valid checksums."""
		if self.r.random() < .5:
			return super().mutant()
		seed = self.r.choice(self.seeds)
		areas, = struct.unpack_from("<I", seed, 88)
		table = self.HEADER + areas * self.LINE
		lines = [struct.unpack_from("<II3Q", seed, at) for at in range(self.HEADER, table, self.LINE)]
		full = [(offset, offset + min(element * count, 1 << 14)) for element, _, count, offset, _ in lines if element * count >= 8]
		data = self.renumbered(seed, full)
		for i, (element, _, count, offset, _) in enumerate(lines):
			if data[offset:offset + element * count] != seed[offset:offset + element * count]:
				struct.pack_into("<Q", data, self.HEADER + i * self.LINE + 24, crc64(data[offset:offset + element * count]))
		struct.pack_into("<Q", data, self.HEADER - 8, 0)
		struct.pack_into("<Q", data, self.HEADER - 8, crc64(data[:table]))
		return bytes(data)

	def command(self, path, folder):
		return ["inspect", path] if self.r.random() < .5 else ["run", "--resume", path, "--duration", ".12"]


class Recordings(Files):
	WRITTEN_BY = "--record"

	def known(self, obsim):
		"""Adds a mesh with a picture, if obsim reads such."""
		super().known(obsim)
		with tempfile.TemporaryDirectory() as folder:
			path, scene = os.path.join(folder, "file"), os.path.join(folder, "scene.lua")
			with open(os.path.join(folder, "cube.glb"), "wb") as f:
				f.write(glb.cube(.3, (1, .5, 1), picture=[[glb.RED, glb.GREEN, glb.GREY]] * 2, shine=True))
			with open(scene, "w", encoding="utf-8") as f:
				f.write("ground {} box { size = { .6, .6, .6 }, at = { 0, 0, 1 }, mesh = 'cube.glb' }")
			subprocess.run([obsim, "run", scene, "--duration", ".1", self.WRITTEN_BY, path], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
			if os.path.exists(path):
				with open(path, "rb") as f:
					self.seeds.append(f.read())

	def command(self, path, folder):
		if self.r.random() < .5:
			return ["export", path, os.path.join(folder, "page.html")]
		return ["run", "--replay", path, "--out", "/dev/null", "--size", "16x16", "--set", "samples=1", "--fps", "30"]


class Records(Files):
	def known(self, obsim):
		with tempfile.TemporaryDirectory() as folder:
			subprocess.run([obsim, "compare", os.path.join(SCENES, "stack.lua"), "--duration", ".02", "--repeats", "1", "--out", folder],
				stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
			with open(os.path.join(folder, "results.csv"), "rb") as f:
				self.seeds.append(f.read())

	def command(self, path, folder):
		out = os.path.join(folder, "out")
		os.makedirs(out)
		os.rename(path, os.path.join(out, "results.csv"))
		return ["compare", os.path.join(SCENES, "stack.lua"), "--duration", ".02", "--repeats", "1", "--out", out]


def fnv(data):
	"""The checksum of schedules (base/hash.h)."""
	result = 0xcbf29ce484222325
	for byte in data:
		result = (result ^ byte) * 0x100000001b3 & (1 << 64) - 1
	return result


class Schedules(Files):
	"""Mutants of schedules of free runs, most with the right checksums (free/schedule.c)."""

	SCENES = ["stack", "cradle", "falling_boxes"]
	STEP = struct.Struct("<IIQQdIIII") # mark, numbers after it, checksum, version, end, object, reads, neighbours + 1, anew

	def known(self, obsim):
		for scene in self.SCENES:
			with tempfile.TemporaryDirectory() as folder:
				words = ["run", os.path.join(SCENES, scene + ".lua"), "--duration", ".05"]
				path = os.path.join(folder, "file")
				subprocess.run([obsim, *words, "--sync", "free", "--set", "coupling=own", "--set", f"record_schedule={path}"], stdout=subprocess.DEVNULL, check=True)
				with open(path, "rb") as f:
					data = f.read()
				first, steps = data.index(b"step"), []
				at = first
				while at < len(data):
					size = self.STEP.size + 4 * struct.unpack_from("<I", data, at + 4)[0]
					steps.append(data[at:at + size])
					at += size
				self.seeds.append((words, data[:first], steps))

	def sealed(self, step):
		"""The step with the number of its words and its checksum."""
		step = bytearray(step)
		struct.pack_into("<I", step, 4, (len(step) - self.STEP.size) // 4)
		struct.pack_into("<Q", step, 8, fnv(step[16:]))
		return bytes(step)

	def change(self, steps):
		"""Changes numbers of a step, or leaves it out, repeats it, moves it, or adds numbers to it."""
		r, i = self.r, self.r.randrange(len(steps) - 1)
		step = steps.pop(i)
		kind = r.randrange(8)
		if kind < 4:
			step = self.sealed(self.renumbered(step, [(16, 48)] + [(48, len(step))] * (len(step) > 48)))
		elif kind == 4:
			return
		elif kind == 5:
			steps.insert(i, step)
		elif kind == 6:
			i = r.randrange(len(steps))
		else:
			step = self.sealed(step + r.choice(self.NUMBERS) * r.choice((1, 2, 100)))
		steps.insert(i, step)

	def mutant(self):
		self.words, head, steps = self.r.choice(self.seeds)
		steps, head = list(steps), bytearray(head)
		for _ in range(self.r.choice((0, 1, 1, 1, 2, 3))):
			self.change(steps)
		if self.r.random() < .2:
			head = self.renumbered(head, [(32, len(head))])
		struct.pack_into("<Q", head, 16, fnv(head[24:]))
		end = bytearray(steps.pop())
		struct.pack_into("<Q", end, 16, len(head) + sum(map(len, steps)))
		data = bytes(head) + b"".join(steps) + self.sealed(end)
		return data if self.r.random() < .8 else mutate(self.r, data, [b"step", b"end.", b"lost", *self.NUMBERS], 2)

	def command(self, path, folder):
		return [*self.words, "--set", f"replay_schedule={path}"]


KINDS = {"scenes": Scenes, "lua": Lua, "words": Words, "checkpoints": Checkpoints, "recordings": Recordings, "records": Records, "schedules": Schedules}


def limit():
	resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS + 5))
	resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
	resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 28, 1 << 28))


def faults(done, name):
	"""Violations in a finished run."""
	text = (done.stdout + done.stderr).decode("utf-8", "replace")
	if done.returncode not in (0, 1, 2):
		yield f"exit code {done.returncode}" + (f" ({signal.Signals(-done.returncode).name})" if -65 < done.returncode < 0 else "")
	if re.search(r"Sanitizer|runtime error:|^==\d+==", text, re.M):
		yield "a sanitizer's report"
	if done.returncode in (1, 2) and not re.search(r"^(obsim: |Usage)", done.stderr.decode("utf-8", "replace"), re.M):
		yield "no word of what is wrong"
	if "SIGXCPU" in text:
		yield "computes too long"
	elif re.search(r"was killed by SIG|exit code \d|left with", text):
		yield "a simulator died"
	if re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]", text):
		yield "control characters"
	if os.path.exists("/dev/shm/obsim." + name):
		yield "a universe was left behind"


def run_case(obsim, kind, folder, name):
	words = kind.case(folder)
	if words[0] == "run" and not isinstance(kind, (Words, Recordings)):
		words += ["--name", name]
	before = resource.getrusage(resource.RUSAGE_CHILDREN)
	try:
		done = subprocess.run([obsim] + words, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=limit,
			timeout=WALL_SECONDS)
	except subprocess.TimeoutExpired:
		return words, None, ["hangs"], b"", WALL_SECONDS
	after = resource.getrusage(resource.RUSAGE_CHILDREN)
	cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
	return words, done.returncode, list(faults(done, name)), done.stderr, cpu


def keep(where, label, folder, words, found, stderr):
	to = os.path.join(where, label)
	shutil.rmtree(to, ignore_errors=True)
	shutil.copytree(folder, to, ignore=shutil.ignore_patterns("*.h5"))
	with open(os.path.join(to, "command"), "w", encoding="utf-8", errors="backslashreplace") as f:
		f.write(repr([w.replace(folder, to) for w in words]) + "\n" + "\n".join(found) + "\n\n")
	with open(os.path.join(to, "stderr"), "wb") as f:
		f.write(stderr[:OUTPUT_MAX])


def main():
	p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
	p.add_argument("obsim", type=os.path.abspath)
	p.add_argument("kinds", nargs="+", choices=[*KINDS, "all"])
	p.add_argument("--count", type=int, default=100, help="cases of each kind (100)")
	p.add_argument("--first", type=int, default=0, metavar="I", help="the number of the first case (0)")
	p.add_argument("--hours", type=float, help="instead: for so long, the kinds in turn")
	p.add_argument("--seed", type=int, default=1, help="case I of seed S is the same whatever the count (1)")
	p.add_argument("--keep", type=os.path.abspath, default="fuzz-kept", help="where what fails is kept (fuzz-kept)")
	a = p.parse_args()
	names = list(KINDS) if "all" in a.kinds else a.kinds
	kinds = {}
	for n in names:
		kinds[n] = KINDS[n](random.Random())
		if hasattr(kinds[n], "known"):
			kinds[n].known(a.obsim)
	until = time.monotonic() + 3600 * a.hours if a.hours else None
	cases = bad = 0
	i = a.first
	longest = 0, "none"
	codes = {}
	for s in signal.SIGINT, signal.SIGTERM:
		signal.signal(s, signal.default_int_handler)  # reports the results so far
	try:
		while time.monotonic() < until if until else i < a.first + a.count:
			for n in names:
				kinds[n].r.seed(f"{n} {a.seed} {i}")
				with tempfile.TemporaryDirectory(prefix="obsim-fuzz-") as folder:
					words, code, found, stderr, cpu = run_case(a.obsim, kinds[n], folder, f"fuzz-{os.getpid()}")
					longest = max(longest, (cpu, f"{n}-{a.seed}-{i}"))
					if found:
						bad += 1
						keep(a.keep, f"{n}-{a.seed}-{i}", folder, words, found, stderr)
						print(f"{n} {i}: {', '.join(found)}: {stderr.decode('utf-8', 'replace').strip().splitlines()[-1:]}", flush=True)
				codes[code] = codes.get(code, 0) + 1
				cases += 1
			i += 1
			if i % 1000 == 0:
				print(f"{i} of each kind, {bad} bad", flush=True)
	except KeyboardInterrupt:
		print(f"ends before case {i}")
	tally = ", ".join(f"{n} ended with {code}" for code, n in sorted(codes.items(), key=str))
	print(f"{cases} cases ({tally}), {bad} bad, {longest[0]:.1f} s of CPU at most ({longest[1]})" + (f", kept in {a.keep}" if bad else ""))
	return 1 if bad else 0


if __name__ == "__main__":
	sys.exit(main())
