"""Free runs that are solved in groups end in the bits of lockstep: random scenes of boxes and balls, stacks, heaps, a gas, with
births and deaths, in threads and processes, few and one for each object, after kills, and with workers that sleep before what others
see: so that they meet in orders that are rare otherwise.

Arguments: the number of scenes, or the first seed and the number of scenes."""

import random
import sys
import unittest

import program

NUMBERS = [int(a) for a in sys.argv[1:] if a.isdigit()]
FIRST, SCENES = [[1, 6], [1] + NUMBERS, NUMBERS][len(NUMBERS)]
CROWDED = 17 # of compounds: a flight whose neighbours come from another world
APART = 206 # heaps far apart, and two that fall unlike and were not solved
WAYS = [["--workers", 1], ["--workers", 2], ["--workers", "objects"], ["--workers", 3, "--isolation", "process"],
	["--workers", "objects", "--isolation", "process"]]
SLOW = [["--workers", 3], ["--workers", 4, "--isolation", "process"]]


def number(draw, low, high):
	return f"{draw.uniform(low, high):.3f}"


def body(draw, at, more=""):
	size = draw.uniform(.2, .6)
	shape = f"box {{ size = {{ {size:.3f}, {number(draw, .2, .6)}, {number(draw, .2, .6)} }}, q = random_rotation()"
	if draw.random() < .4:
		shape = f"sphere {{ radius = {size / 2:.3f}"
	return f"{shape}, at = {{ {', '.join(f'{x:.3f}' for x in at)} }}{more} }}"


def stack(draw, x, y):
	return [f"box {{ size = {{ .5, .5, .4 }}, at = {{ {x}, {y}, {.2 + .4 * i:.3f} }} }}" for i in range(draw.randint(2, 6))]


def heap(draw, x, y):
	return [body(draw, [x + draw.uniform(-.6, .6), y + draw.uniform(-.6, .6), .5 + .6 * i]) for i in range(draw.randint(3, 9))]


def shots(draw, x, y):
	life = draw.choice(["", "", f", born = {number(draw, .05, .3)}", f", dies = {number(draw, .1, .4)}"])
	return [body(draw, [x + 3, y + i, draw.uniform(.3, 2)], f", velocity = {{ {number(draw, -12, -4)}, 0, {number(draw, 0, 3)} }}{life}")
		for i in range(draw.randint(1, 3))]


def gas(draw, x, y):
	return [body(draw, [x + i % 3, y + i // 3 % 3, 2 + i // 9], f", restitution = 1, velocity = {{ {number(draw, -4, 4)}, "
		f"{number(draw, -4, 4)}, {number(draw, -4, 4)} }}") for i in range(draw.randint(4, 14))]


def hills(draw, x, y):
	"""Compounds and balls on a heightfield, or on the plane."""
	ground = "heightfield { size = { 16, 16 }, cells = { 20, 20 }, height = function(x, y) return .3 * math.sin(x) * math.cos(y) end }"
	parts = [f"compound {{ at = {{ {x + draw.uniform(-1, 1):.3f}, {y + draw.uniform(-1, 1):.3f}, {1 + .7 * i} }}, q = random_rotation(), parts = {{ "
		f"{{ size = {{ {number(draw, .3, .7)}, .2, .15 }} }}, {{ size = {{ .15, .2, {number(draw, .2, .5)} }}, at = {{ .2, 0, .2 }} }} }} }}"
		for i in range(draw.randint(2, 5))]
	return [draw.choice([ground, "ground {}"])] + parts + heap(draw, x + draw.randint(1, 4), y) + shots(draw, x, y)


class Group(program.Case):
	def scene(self, draw):
		falls = draw.random() < .8
		lines = [f"scene {{ duration = {number(draw, .4, 1.2)}" + ("" if falls else ", gravity = { 0, 0, 0 }") +
			draw.choice(["", "", ", tolerance = .01", ", sleeping = false"]) + " }", "ground {}"]
		for _ in range(draw.randint(1, 4)):
			x, y = draw.randint(-4, 4), draw.randint(-4, 4)
			lines += draw.choice([stack, heap, shots, gas] if falls else [gas, shots])(draw, x, y)
		path = self.path("scene.lua")
		with open(path, "w") as f:
			f.write("\n".join(lines) + "\n")
		return path

	def test_bits(self):
		for seed in [*range(FIRST, FIRST + SCENES), *([APART] if SCENES < APART else [])]:
			draw = random.Random(seed)
			scene = self.scene(draw)
			lockstep = program.report(scene, "--seed", seed)["state_hash"]
			ways = [*program.ways(*WAYS), *(way + ["--fault", f"slow:p=.03,ms=2,seed={seed + again}"] for way in SLOW
				for again in range(4)), *([way + ["--fault", f"kill:p={p},seed={seed}"] for way in WAYS[3:]
				for p in (.002, .005)] if seed % 2 else [])]
			for way in ways:
				with self.subTest(seed=seed, way=way):
					r = program.report(scene, "--seed", seed, "--sync", "free", *way)
					self.assertEqual(r["state_hash"], lockstep, f"{r['deaths']} deaths")

	def test_compounds_and_terrain(self):
		for seed in [*range(FIRST, FIRST + SCENES), *([CROWDED] if SCENES < CROWDED else [])]:
			draw = random.Random(seed)
			path = self.path("hills.lua")
			with open(path, "w") as f:
				f.write("\n".join(["scene { duration = .8 }", *hills(draw, draw.randint(-3, 3), draw.randint(-3, 3))]) + "\n")
			lockstep = program.report(path, "--seed", seed)["state_hash"]
			for way in program.ways(WAYS[0], WAYS[1], WAYS[3] + ["--fault", f"kill:p=.003,seed={seed}"]):
				with self.subTest(seed=seed, way=way):
					r = program.report(path, "--seed", seed, "--sync", "free", *way)
					self.assertEqual(r["state_hash"], lockstep, f"{r['deaths']} deaths")

	def test_refused(self):
		"""Settings that groups lack are refused, with the one that has them."""
		for setting in "jitter=.1", "delay=.01", "update_rate=500", "max_lag=.1", "record_schedule=x":
			done = program.call("run", program.scene("stack"), "--sync", "free", "--set", setting)
			self.assertEqual(done.returncode, 2, done.stderr)
			self.assertRegex(done.stderr, f"{setting.split('=')[0]} .*--set coupling=own")


if __name__ == "__main__":
	sys.argv = sys.argv[:1] + [a for a in sys.argv[1:] if not a.isdigit()]
	unittest.main()
