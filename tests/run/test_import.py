"""Models of MJCF and URDF become scenes: bodies with MuJoCo's masses and moments, which move as in MuJoCo, and a list of what
is left out. Damaged and hostile files are one line."""

import math
import os
import pathlib
import random
import re
import subprocess
import unittest

import program

MODELS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "models")
REFERENCE = os.environ["REFERENCE"]
OBSERVER = """
sphere {{ name = "observer", radius = .1, at = {{ 900, 0, 0 }}, static = true, hits = {{}}, script = [[
function on_start() self:wake({seconds}) end
function on_wake()
	for name in ("{names}"):gmatch("[^|]+") do
		local o = find(name)
		print("at", name, o:position()) print("turned", name, o:attitude())
	end
end
]] }}
"""


def matrix(w, x, y, z):
	return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
		[2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
		[2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def product(a, b):
	return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transposed(a):
	return [list(row) for row in zip(*a)]


def numbers(line, key):
	found = re.search(rf"\b{key} = \{{?([^}},]+(?:, [^}},]+)*)\}}?", line)
	return [float(x) for x in found.group(1).split(",")] if found else None


class Body:
	"""An object of an imported scene, from its line."""

	def __init__(self, line):
		self.name = re.search(r'name = "([^"]*)"', line).group(1)
		self.mass = float(re.search(r"\bmass = ([^,]+)", line).group(1))
		self.at = numbers(line, "at")
		turn = numbers(line, "q")
		self.frame = matrix(*turn) if turn else matrix(1, 0, 0, 0)
		moments = numbers(line, "inertia")
		diagonal = [[moments[i] if i == j else 0 for j in range(3)] for i in range(3)]
		i = product(product(self.frame, diagonal), transposed(self.frame))
		self.tensor = [i[0][0], i[1][1], i[2][2], i[0][1], i[0][2], i[1][2]]


def reference(path, seconds):
	"""Numbers of each body in MuJoCo."""
	done = subprocess.run([REFERENCE, path, str(seconds)], capture_output=True, text=True, timeout=program.PATIENCE, check=True)
	found = {}
	for line in done.stdout.splitlines():
		name, *rest = line.split()
		found[name] = [float(x) for x in rest]
	return found


class Import(program.Case):
	def convert(self, name):
		"""The scene, its objects that move by name, and what it leaves out."""
		done = program.call("import", name if os.path.isabs(name) else os.path.join(MODELS, name))
		self.assertEqual(done.returncode, 0, done.stderr)
		bodies = [Body(line) for line in done.stdout.splitlines() if " inertia = " in line]
		return done.stdout, {b.name: b for b in bodies}, done.stderr

	def states(self, scene, bodies, seconds):
		"""Places and rotations after some time."""
		path = self.path("scene.lua")
		with open(path, "w", encoding="utf-8") as f:
			f.write(scene + OBSERVER.format(seconds=seconds, names="|".join(bodies)))
		done = program.call("run", path, "--step", "1/240", "--duration", seconds + 1 / 60, "--measure", "end")
		self.assertEqual(done.returncode, 0, done.stderr)
		found = {}
		for what, name, values in re.findall(r"^obsim: (at|turned) (\S+) (.*)$", done.stderr, re.MULTILINE):
			found.setdefault(name, {})[what] = [float(x) for x in values.split()]
		return found

	def compare(self, name, soft=(), seconds=2, moves=1e-4):
		"""soft: bodies that MuJoCo holds by springs."""
		path = os.path.join(MODELS, name)
		expected = reference(path, seconds)
		scene, bodies, said = self.convert(name)
		expected = {k: v for k, v in expected.items() if k in bodies}
		self.assertEqual(set(bodies), set(expected))
		for key, b in bodies.items():
			values = expected[key]
			self.assertAlmostEqual(b.mass / values[0], 1, delta=1e-9, msg=key)
			largest = max(values[1:4])
			for mine, theirs in zip(b.tensor, values[1:7]):
				self.assertAlmostEqual(mine, theirs, delta=1e-9 * largest, msg=key)
			self.assertLess(math.dist(b.at, values[7:10]), 1e-9, key)
		found = self.states(scene, bodies, seconds)
		for key, b in bodies.items():
			values = expected[key]
			if key in soft:
				continue
			self.assertLess(math.dist(found[key]["at"], values[10:13]), moves, f"{name}: {key} {found[key]} {values[10:13]}")
			turned = product(matrix(*found[key]["turned"]), transposed(b.frame))
			for i in range(3):
				self.assertLess(math.dist(turned[i], values[13 + 3 * i:16 + 3 * i]), 10 * moves, f"{name}: {key}")
		return scene, bodies, said

	def test_arm(self):
		scene, _, said = self.compare("arm.xml")
		self.assertRegex(scene, r'\nhinge \{ "shoulder".*, low = -2.96\d*, high = 2.96')
		for what in ('actuator "lifter" is left out', 'sensor "angle" is left out', 'light "lamp" is left out',
				"hand: 1 geoms that are looks alone are left out: --out DIR writes them"):
			self.assertIn(f"obsim: {what}\n", said)
			self.assertIn(f"-- {what}\n", scene)
		self.assertRegex(scene, r'\nplane \{ name = "floor"')
		self.assertRegex(scene, r'\nuniversal \{ "hand", "fore"')
		self.assertRegex(scene, r'\nslider \{ "finger", "hand"')

	def test_humanoid(self):
		scene, _, said = self.compare("humanoid.xml")
		self.assertRegex(scene, r'\nball \{ "right_thigh", "pelvis"')
		self.assertRegex(scene, r'\nfixed \{ "watch", "forearm"')
		self.assertRegex(scene, r'\napart \{ "torso", "forearm" \}')
		self.assertIn("right_foot: its 2 joints have 1 balls of a millionth of its mass between them", said)

	def test_quadruped(self):
		scene, _, _ = self.compare("quadruped.xml", soft=("bar", "rod"))
		self.assertRegex(scene, r'\nhull \{ name = "trunk"')
		self.assertRegex(scene, r'\nball \{ "bar", "rod"')

	def test_springs(self):
		"""Limits, springs, dampers, and a servo; between two joints of one body as well."""
		scene, _, said = self.compare("springs.xml", soft=("gear", "cross"))
		self.assertRegex(scene, r'\nhinge \{ "door".*, low = -3, high = 3, stiffness = 3, rest = 0.4\d*, damping = 0.2')
		self.assertRegex(scene, r'\nhinge \{ "servo".*, motor = \{ to = 0, stiffness = 20 \} \}')
		self.assertIn('obsim: joint "heavy": its armature, 0.001, is left out\n', said)
		self.assertIn('obsim: actuator "idle" is left out\n', said)
		self.assertNotIn('"hold"', said)

	def test_crane(self):
		"""A link named world stands still, and what is fixed to it."""
		scene, bodies, said = self.compare("crane.urdf")
		self.assertEqual(set(bodies), {"jib", "hook"})
		self.assertRegex(scene, r'\nbox \{ name = "tower".* static = true')
		self.assertIn('joint "luff": its limits, -90 to 90, are left out', said)

	def test_rover(self):
		"""The base of a URDF model is free, also where MuJoCo would weld it to the world: all of it falls as one."""
		scene, bodies, _ = self.convert("rover.urdf")
		self.assertEqual(set(bodies), {"chassis", "wheel", "mast"})
		self.assertAlmostEqual(bodies["chassis"].mass, 6, 12)
		for mine, given in zip(bodies["chassis"].tensor, [.05, .09, .12, .001, 0, -.002]):
			self.assertAlmostEqual(mine, given, 8)
		found = self.states(scene, bodies, 1)
		total = sum(b.mass for b in bodies.values())
		fallen = sum(b.mass * (b.at[2] - found[b.name]["at"][2]) for b in bodies.values()) / total
		self.assertAlmostEqual(fallen, .5 * 9.81, 6)

	def test_out(self):
		folder = self.path("out")
		done = program.call("import", os.path.join(MODELS, "quadruped.xml"), "--out", folder)
		self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
		if program.MESHES:
			self.assertEqual(program.call("run", os.path.join(folder, "quadruped.lua"), "--duration", .1).returncode, 0)
		self.assertIn("look_", " ".join(os.listdir(folder)))

	def test_same_scene(self):
		self.assertEqual(self.convert("humanoid.xml")[0], self.convert("humanoid.xml")[0])

	# ---- files from outside

	def write(self, name, text):
		path = self.path(name)
		with open(path, "wb") as f:
			f.write(text if isinstance(text, bytes) else text.encode())
		return path

	def test_usage(self):
		self.refuse("import", saying="import needs a model")
		self.refuse("import", "none.xml", saying="none.xml: No such file")
		self.refuse("import", self.directory.name, saying="expected a regular file")

	def test_no_model(self):
		for text in ("", "robot", "<mujoco>", "<mujoco></robot>", b"\0\1\2", "<a/>", "<robot name='a'><link/></robot>",
				"<mujoco><worldbody><body><joint/></body></worldbody></mujoco>",
				"<mujoco><asset><mesh file='none.stl'/></asset></mujoco>", "<mujoco><include file='model.xml'/></mujoco>"):
			with self.subTest(text=text):
				self.refuse("import", self.write("model.xml", text), saying="model.xml: ")

	def test_no_numbers(self):
		path = self.write("nan.xml", "<mujoco><worldbody><geom name='a' size='nan'/><geom name='b' size='1'/></worldbody></mujoco>")
		scene, _, said = self.convert(path)
		self.assertIn("obsim: a is left out: its numbers are out of range\n", said)
		self.assertEqual(scene.count("\nsphere {"), 1)

	def test_deep(self):
		"""A file nested a hundred thousand deep costs the child its stack, and this program nothing."""
		depth = 100000
		text = "<mujoco><worldbody>" + "<body>" * depth + "</body>" * depth + "</worldbody></mujoco>"
		self.refuse("import", self.write("deep.xml", text), saying="deep.xml: ")

	def test_huge(self):
		text = "<mujoco><size nstack='2000000000' njmax='2000000000' nconmax='2000000000'/></mujoco>"
		self.refuse("import", self.write("huge.xml", text), saying="huge.xml: ")

	def test_damaged(self):
		"""Files with random damage are a scene or one line."""
		draw = random.Random(1)
		texts = [pathlib.Path(MODELS, name).read_bytes() for name in ("arm.xml", "rover.urdf")]
		for i in range(10 if program.SANITIZED else 40):
			text = bytearray(draw.choice(texts))
			for _ in range(draw.randrange(1, 6)):
				at = draw.randrange(len(text))
				if draw.random() < .5:
					text[at] = draw.randrange(256)
				else:
					del text[at:at + draw.randrange(1, 40)]
			done = program.call("import", self.write("damaged.xml", bytes(text)))
			self.assertIn(done.returncode, (0, 2), done.stderr)
			if done.returncode:
				self.assertRegex(done.stderr, r"^obsim: [^\n]*\n$")


unittest.main()
