"""Models of MJCF and URDF become scenes: bodies with MuJoCo's masses and moments, which move as in MuJoCo, and a list of what
is left out. Damaged and hostile files are one line."""

import math
import os
import pathlib
import random
import re
import unittest

import program
import robots

MODELS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "models")


def rolled_off_centre(mass, radius, off, moment):
	"""Way in a second of the centre of mass of a roller under gravity 1 ahead and 9 down, that lies ahead of its axis at first."""
	def speed_up(turn, rate):
		inertia = mass * (radius ** 2 + off ** 2 - 2 * radius * off * math.sin(turn)) + moment
		change = -2 * mass * radius * off * math.cos(turn)
		return (mass * (radius - off * math.sin(turn)) + 9 * mass * off * math.cos(turn) - .5 * change * rate ** 2) / inertia
	turn, rate, h = 0, 0, 1e-4
	for _ in range(round(1 / h)):
		middle = turn + .5 * h * rate, rate + .5 * h * speed_up(turn, rate)
		turn, rate = turn + h * middle[1], rate + h * speed_up(*middle)
	return radius * turn + off * math.cos(turn)


class Import(program.Case):
	def convert(self, name):
		"""The scene, its objects that move by name, and what it leaves out."""
		done, bodies = robots.convert(name if os.path.isabs(name) else os.path.join(MODELS, name))
		self.assertEqual(done.returncode, 0, done.stderr)
		return done.stdout, {b.name: b for b in bodies}, done.stderr

	def compare(self, name, soft=(), seconds=2, moves=1e-4):
		"""soft: bodies that MuJoCo holds by springs."""
		expected = robots.reference(os.path.join(MODELS, name), seconds)
		scene, bodies, said = self.convert(name)
		self.assertEqual(list(bodies), [e.name for e in expected])
		self.assertLess(robots.error_of_mass(bodies.values(), expected), 1e-9)
		self.assertLess(robots.error_of_inertia(bodies.values(), expected), 1e-9)
		found = robots.states(scene, bodies.values(), seconds, self.directory.name)
		for e, f, b in zip(expected, found, bodies.values()):
			self.assertLess(math.dist(b.at, e.start), 1e-9, b.name)
			if b.name in soft:
				continue
			self.assertLess(math.dist(f["at"], e.end), moves, f"{name}: {b.name} {f} {e.end}")
			turned = robots.product(robots.matrix(*f["turned"]), robots.transposed(b.frame))
			for i in range(3):
				self.assertLess(math.dist(turned[i], e.turn[3 * i:3 * i + 3]), 10 * moves, f"{name}: {b.name}")
		return scene, bodies, said

	def test_arm(self):
		scene, _, said = self.compare("arm.xml")
		self.assertRegex(scene, r'\nhinge \{ "shoulder".*, low = -2.96\d*, high = 2.96')
		for what in ('actuator "lifter" is left out', 'light "lamp" is left out',
				"hand: 1 geoms that are looks alone are left out: --out DIR writes them"):
			self.assertIn(f"obsim: {what}\n", said)
			self.assertIn(f"-- {what}\n", scene)
		self.assertRegex(scene, r'\nhinge \{ "upper".*, name = "lift" \}')
		self.assertIn('\nencoder { joint = "lift", name = "angle" }\n', scene)
		self.assertRegex(scene, r'\nplane \{ name = "floor"')
		self.assertRegex(scene, r'\nuniversal \{ "hand", "fore"')
		self.assertRegex(scene, r'\nslider \{ "finger", "hand"')
		self.assertRegex(scene, r'\ncompound \{ name = "upper", parts = \{ \{ shape = "capsule", .* \}, \{ size = \{ 0.08\d*, 0.12\d*, 0.1\d* \}, at = ')

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
		scene, _, said = self.compare("springs.xml")
		self.assertRegex(scene, r'\nhinge \{ "door".*, low = -3, high = 3, stiffness = 3, rest = 0.4\d*, damping = 0.2')
		self.assertRegex(scene, r'\nhinge \{ "servo".*, motor = \{ to = 0, stiffness = 20 \} \}')
		self.assertRegex(scene, r'\nhinge \{ "gear".*, armature = 0.001')
		self.assertIn('obsim: actuator "idle" is left out\n', said)
		self.assertNotIn('"hold"', said)

	def test_limbs(self):
		"""Springs, dampers, rotors and limits of balls, and of two hinges that cross."""
		scene, _, said = self.compare("limbs.xml")
		self.assertRegex(scene, r'\nball \{ "upper arm".*, high = 2.5, stiffness = 6, damping = 0.4\d*, armature = 0.0\d+ \}')
		self.assertRegex(scene, r'\nuniversal \{ "forearm", .*, low = -2, high = 2, damping = 0.05\d*, armature = 0.0\d+, '
			r'second = \{ restitution = 0, stiffness = 3, rest = 0.4\d*, damping = 0.1')
		self.assertRegex(scene, r'\nuniversal \{ "spinner".*, stiffness = 2, rest = 0, second = \{ restitution = 0, armature = 0.1')
		self.assertIn('obsim: joint "wrist": its frictionloss, 1e-09, is left out\n', said)
		self.assertEqual(said.count("joint"), 1, said)

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
		found = robots.states(scene, bodies.values(), 1, self.directory.name)
		total = sum(b.mass for b in bodies.values())
		fallen = sum(b.mass * (b.at[2] - f["at"][2]) for b, f in zip(bodies.values(), found)) / total
		self.assertAlmostEqual(fallen, .5 * 9.81, 6)

	def test_compound(self):
		"""Each geom of a body is a part; boxes are exact, so a peg fits between them."""
		path = self.write("channel.xml", """<mujoco><worldbody>
			<geom type="plane" size="1 1 1"/>
			<body name="channel" pos="0 0 1.02"><freejoint/>
				<geom type="box" size=".5 .1 .02"/>
				<geom type="box" size=".5 .02 .1" pos="0 -.08 .12"/>
				<geom type="box" size=".5 .02 .1" pos="0 .08 .12"/>
			</body>
			<body name="peg" pos="0 0 1.2"><freejoint/><geom type="box" size=".1 .05 .05" euler="0 0 1"/></body>
		</worldbody></mujoco>""")
		scene, bodies, said = self.convert(path)
		self.assertEqual(said, "")
		self.assertEqual(len(re.findall(r"\{ size = ", scene)), 3)
		found = dict(zip(bodies, robots.states(scene, bodies.values(), 2, self.directory.name)))
		self.assertAlmostEqual(found["peg"]["at"][2], .09, 3)

	def test_round_geoms(self):
		"""Spheres, capsules and cylinders are exact, also the only one of a body, off its centre of mass: they roll."""
		path = self.write("rollers.xml", """<mujoco><option gravity="1 0 -9"/><worldbody>
			<geom type="plane" size="1 1 1"/>
			<body name="axle" pos="0 0 .1"><freejoint/>
				<geom type="sphere" size=".1" pos="0 -.3 0"/><geom type="sphere" size=".1" pos="0 .3 0"/>
				<geom type="cylinder" size=".03 .2" euler="90 0 0"/>
			</body>
			<body name="roller" pos="0 3 .1"><freejoint/><inertial pos=".001 0 0" mass="1" diaginertia=".03 .005 .03"/>
				<geom type="capsule" size=".1 .2" euler="90 0 0"/>
			</body>
		</worldbody></mujoco>""")
		scene, bodies, said = self.convert(path)
		self.assertEqual(said, "")
		self.assertRegex(scene, r'\ncompound \{ name = "axle", parts = \{ \{ shape = "sphere", .*shape = "cylinder", radius = 0.0[23]')
		self.assertRegex(scene, r'\ncompound \{ name = "roller", parts = \{ \{ shape = "capsule", .* \} \}')
		axle = bodies["axle"]
		found = dict(zip(bodies, robots.states(scene, bodies.values(), 1, self.directory.name)))
		rolled = .5 / (1 + axle.tensor[1] / (axle.mass * .1 ** 2)) # half the acceleration
		self.assertAlmostEqual(found["axle"]["at"][0], rolled, 6)
		self.assertAlmostEqual(found["axle"]["at"][2], .1, 5)
		self.assertAlmostEqual(found["roller"]["at"][0], rolled_off_centre(1, .1, .001, .005), 4)

	def test_many_geoms(self):
		"""More parts than a compound has become the hull of all."""
		geoms = "".join(f'<geom type="box" size=".01 .01 .01" pos="{i * .02} 0 0"/>' for i in range(20))
		scene, _, said = self.convert(self.write("many.xml", "<mujoco><worldbody><body name='bar'><freejoint/>"
			f"{geoms}</body></worldbody></mujoco>"))
		self.assertIn('\nhull { name = "bar"', scene)
		self.assertIn("bar collides as the hull of its 20 geoms, with 8 corners", said)

	def test_urdf_of_others(self):
		"""MuJoCo refuses meshes of other kinds, and ones that are missing or damaged, links without mass, and moments that no
		body can have; others read them."""
		self.write("cut.stl", b" " * 80 + b"\4\0\0\0")
		self.write("box.dae", "<COLLADA/>")
		link = """<link name="{0}">{1}{2}</link>"""
		mass = '<inertial><mass value="{0}"/><inertia ixx="{1}" ixy="0" ixz="0" iyy="{2}" iyz="0" izz="{3}"/></inertial>'
		mesh = '<{0}><geometry><mesh filename="{1}"/></geometry></{0}>'
		joint = '<joint name="{1}" type="{2}"><parent link="{0}"/><child link="{1}"/><axis xyz="0 1 0"/>{3}</joint>'
		text = "".join([
			link.format("base", mass.format(1, .1, .1, .5), mesh.format("collision", "package://robot/cut.stl")),
			link.format("arm", mass.format(1, .1, .1, .1), mesh.format("visual", "box.dae") + mesh.format("collision", "box.dae")),
			link.format("hand", "", mesh.format("collision", "none.stl")),
			link.format("finger", mass.format(.1, .01, .01, .01), ""),
			joint.format("base", "arm", "continuous", ""),
			joint.format("arm", "hand", "continuous", ""),
			joint.format("hand", "finger", "continuous", '<mimic joint="arm"/>')])
		scene, bodies, said = self.convert(self.write("robot.urdf", f'<robot name="robot">{text}</robot>'))
		self.assertEqual(list(bodies), ["base", "arm", "hand", "finger"])
		self.assertEqual(scene.count("\nhinge {"), 3)
		for what in ("1 looks are left out: --out DIR writes them", "mesh box.dae is left out: MuJoCo reads STL, OBJ and MSH files",
				"mesh none.stl is left out: no file of this name is beside the model", "cut.stl is left out: MuJoCo ",
				"1 mimic joints move by themselves", "moments that no body can have are replaced by their mean",
				"bodies have at least 1e-6 kg and 1e-9 kg m^2: some that move have none"):
			self.assertIn(what, said)

	def test_feet(self):
		"""A link that is fixed and has no mass, or no moments, is part of the one that it is fixed to: mass, moments, solid."""
		link = '<link name="{0}"><inertial><mass value="{1}"/><inertia ixx="{2}" ixy="0" ixz="0" iyy="{2}" iyz="0" izz="{2}"/>' \
			'</inertial>{3}</link>'
		ball = '<collision><geometry><sphere radius=".02"/></geometry></collision>'
		box = '<collision><geometry><box size=".1 .1 .4"/></geometry></collision>'
		joint = '<joint name="{0}" type="fixed"><parent link="leg"/><child link="{0}"/><origin xyz="0 0 {1}"/></joint>'
		text = link.format("leg", 1, .01, box) + link.format("foot", 0, .002, ball) + link.format("hip", .5, 0, "")
		text += joint.format("foot", -.3) + joint.format("hip", .3)
		scene, bodies, said = self.convert(self.write("leg.urdf", f'<robot name="robot">{text}</robot>'))
		self.assertEqual(list(bodies), ["leg"])
		self.assertAlmostEqual(bodies["leg"].mass, 1.5, 12)
		self.assertAlmostEqual(bodies["leg"].at[2], .1, 12)
		for mine, given in zip(bodies["leg"].tensor, [.012 + .01 + .02, .012 + .01 + .02, .012, 0, 0, 0]):
			self.assertAlmostEqual(mine, given, 12)
		self.assertIn("\ncompound {", scene)
		self.assertNotIn("no mass", said)

	def test_relative_path(self):
		"""A path of the model that is not absolute: meshes are still found by package://."""
		folder = self.path("arm_description")
		os.makedirs(os.path.join(folder, "urdf"))
		corners = "".join(f"v {x} {y} {z}\n" for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
		with open(os.path.join(folder, "wedge.obj"), "w", encoding="utf-8") as f:
			f.write(corners + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
		with open(os.path.join(folder, "urdf", "arm.urdf"), "w", encoding="utf-8") as f:
			f.write('<robot name="a"><link name="l"><inertial><origin xyz=".25 .25 .25"/><mass value="1"/><inertia ixx=".1" ixy="0" '
				'ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial><collision><geometry>'
				'<mesh filename="package://arm_description/wedge.obj"/></geometry></collision></link></robot>')
		done = program.call("import", "urdf/arm.urdf", cwd=folder)
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		self.assertIn('hull { name = "l"', done.stdout)

	def test_newer(self):
		"""Attributes and elements that a newer MuJoCo reads; there a range is a limit."""
		path = self.write("newer.xml", """<mujoco><worldbody><body name="arm" gravcomp="1">
			<joint name="a" range="-1 1" actuatorfrcrange="-5 5"/><geom type="box" size=".1 .1 .1" pos=".2 0 0"/></body></worldbody>
			<sensor><jointactuatorfrc joint="a"/><jointactuatorfrc joint="a"></jointactuatorfrc></sensor></mujoco>""")
		scene, _, said = self.convert(path)
		self.assertIn(", low = -0.017", scene)
		self.assertIn("attribute gravcomp is left out, 1 times: MuJoCo 2.2 has none", said)
		self.assertIn("element jointactuatorfrc is left out, 2 times: MuJoCo 2.2 has none", said)

	def test_sensors(self):
		"""Sensors of sites and joints that the scene has; two of the same thing are one; others are listed."""
		path = self.write("sensors.xml", """<mujoco><worldbody><body name="box" pos="1 2 3"><joint name="turn" axis="0 0 1"/>
			<geom type="box" size=".3 .2 .1"/><site name="s" pos=".1 .2 .3" quat="0 0 1 0"/>
			<body pos="1 0 0"><joint name="odd#" type="slide"/><geom type="sphere" size=".1"/></body></body></worldbody>
			<sensor><gyro name="unit" site="s" noise=".01"/><touch name="skin" site="s"/><accelerometer site="s" noise=".2"/>
			<rangefinder name="beam" site="s" cutoff="7"/><jointpos name="angle" joint="turn"/><jointvel joint="turn" noise=".3"/>
			<jointvel joint="odd#"/><framepos name="place" objtype="site" objname="s"/><force name="pull" site="s"/></sensor></mujoco>""")
		scene, _, said = self.convert(path)
		site = r"at = \{ 0.1\d*, 0.2\d*, 0.(3|29)\d* \}, q = \{ "
		for line in (r'hinge \{ "box", .*, name = "turn" \}', r'slider \{ .*, name = "joint 1" \}',
				r'imu \{ on = "box", ' + site + r'0, 0, 1, 0 \}, noise = 0.2\d*, gyro_noise = 0.01\d*, name = "unit" \}',
				r'touch \{ on = "box", name = "skin" \}',
				r'lidar \{ on = "box", ' + site + r'0.707\d*, 0, 0.707\d*, 0 \}, beams = 1, reach = 7, name = "beam" \}',
				r'encoder \{ joint = "turn", rate_noise = 0.(3|29)\d*, name = "angle" \}', r'encoder \{ joint = "joint 1" \}'):
			self.assertRegex(scene, "\n" + line.replace("0, 0, 1, 0", "-?0, -?0, 1, -?0") + "\n")
		for what in ('sensor "place" is left out', 'sensor "pull" is left out',
				'sensor "skin" reads all contacts of its object, not those at its site alone'):
			self.assertIn(what, said)
		with open(self.path("sensors.lua"), "w", encoding="utf-8") as f:
			f.write(scene)
		program.report(self.path("sensors.lua"), "--duration", ".1")

	def test_odd_moments(self):
		"""A body whose shape is far too small for its moments keeps these, and touches nothing."""
		path = self.write("odd.xml", """<mujoco><worldbody><body name="odd"><freejoint/><geom type="box" size=".001 .001 .001"/>
			<inertial pos="0 0 0" mass=".001" diaginertia=".01 .01 .01"/></body></worldbody></mujoco>""")
		scene, bodies, said = self.convert(path)
		self.assertIn("odd collides with nothing: its moments are too large or too small for its shape", said)
		self.assertEqual(bodies["odd"].tensor[0], .01)
		robots.states(scene, bodies.values(), .1, self.directory.name)

	def test_out(self):
		folder = self.path("out")
		done = program.call("import", os.path.join(MODELS, "quadruped.xml"), "--out", folder)
		self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
		if program.MESHES:
			self.assertEqual(program.call("run", os.path.join(folder, "quadruped.lua"), "--duration", .1).returncode, 0)
		self.assertIn("look_", " ".join(os.listdir(folder)))

	def test_looks_of_urdf(self):
		path = self.write("ball.urdf", """<robot name="ball"><link name="world"/><link name="ball">
			<inertial><mass value="1"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial>
			<visual><geometry><box size=".1 .1 .1"/></geometry></visual>
			<visual><geometry><mesh filename="none.dae"/></geometry></visual>
			<collision><geometry><sphere radius=".1"/></geometry></collision></link>
			<joint name="j" type="continuous"><parent link="world"/><child link="ball"/></joint></robot>""")
		self.assertIn("2 looks are left out: --out DIR writes them", self.convert(path)[2])
		folder = self.path("out")
		done = program.call("import", path, "--out", folder)
		self.assertEqual(done.returncode, 0, done.stderr)
		self.assertIn("look none.dae is left out", done.stderr)
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

	def test_no_file(self):
		"""All files that a model names are regular ones: nothing waits for a pipe, or reads a device."""
		model = "<mujoco><asset>%s</asset><worldbody><geom type='%s'/><body pos='0 0 1'><freejoint/><geom size='.1'/></body></worldbody></mujoco>"
		for name in ("pipe", "pipe.stl", "pipe.png", "pipe.skn", "pipe.xml"):
			os.mkfifo(self.path(name))
		for text in (model % ("<hfield name='h' file='pipe' size='1 1 1 1'/>", "hfield' hfield='h"),
				model % ("<hfield name='h' file='/dev/zero' size='1 1 1 1'/>", "hfield' hfield='h"),
				model % ("<hfield name='h' file='pipe.png' size='1 1 1 1'/>", "hfield' hfield='h"),
				model % ("<mesh name='m' file='pipe.stl'/>", "mesh' mesh='m"),
				model % ("<texture name='t' type='2d' file='pipe.png'/>", "sphere' size='1"),
				model % ("<skin file='pipe.skn'/>", "sphere' size='1"),
				"<mujoco><include file='pipe.xml'/></mujoco>", "<mujoco><include file='/dev/zero'/></mujoco>"):
			with self.subTest(text=text):
				self.refuse("import", self.write("model.xml", text), saying="model.xml: ")
		path = self.write("pipe.urdf", """<robot name="r"><link name="l"><inertial><mass value="1"/>
			<inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial>
			<collision><geometry><mesh filename="pipe.stl"/></geometry></collision></link></robot>""")
		self.assertRegex(self.convert(path)[2], r"mesh \S*pipe.stl is left out: MuJoCo cannot read it")

	def test_read_back(self):
		"""A scene that was written can be read; a model with other numbers is one line."""
		body = "<mujoco>%s<worldbody><body pos='%s'><freejoint/><geom type='sphere' size='%s'/></body></worldbody></mujoco>"
		for text, saying in ((body % ("<option gravity='nan 0 1'/>", "0 0 1", ".1"), "nan"), (body % ("", "1.4e153 0 1", ".1"), "sphere.at"),
				(body % ("", "0 0 1", "1e50"), "sphere.radius"), (body % ("<option gravity='0 0 1e9'/>", "0 0 1", "1"), "scene.gravity")):
			with self.subTest(text=text):
				self.refuse("import", self.write("model.xml", text), saying="makes no scene: model.lua:")
				self.refuse("import", self.write("model.xml", text), "--out", self.path("out"), saying=saying)
				self.assertFalse(os.path.exists(os.path.join(self.path("out"), "model.lua")))
		draw = random.Random(3)
		whole = {name: pathlib.Path(MODELS, name).read_text() for name in ("arm.xml", "springs.xml", "quadruped.xml", "rover.urdf")}
		for i in range(8 if program.SANITIZED else 40):
			name = draw.choice(list(whole))
			numbers = list(re.finditer(r'(?<=[" ])-?[0-9.]+(?=[" ])', whole[name]))
			at = draw.choice(numbers)
			text = whole[name][:at.start()] + draw.choice(["nan", "inf", "-1", "0", "1e-300", "1e300", "1e9", "1e-9", "7"]) + whole[name][at.end():]
			done = program.call("import", self.write("model.xml", text))
			self.assertIn(done.returncode, (0, 2), done.stderr)
			if done.returncode == 0:
				with open(self.path("model.lua"), "w") as f:
					f.write(done.stdout)
				self.assertNotEqual(program.call("run", self.path("model.lua"), "--duration", "1/60").returncode, 2, text[at.start() - 80:at.end()])
			else:
				self.assertRegex(done.stderr, r"^obsim: [^\n]*\n$")

	def test_many(self):
		"""MuJoCo's stack does not overflow by the number of bodies."""
		bodies = "".join(f"<body pos='{i} 0 1'><freejoint/><geom size='.1'/></body>" for i in range(2000))
		scene, found, _ = self.convert(self.write("many.xml", f"<mujoco><worldbody>{bodies}</worldbody></mujoco>"))
		self.assertEqual(len(found), 2000)

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
