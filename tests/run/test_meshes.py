"""Objects with meshes: drawn as these, their motion unchanged; and an invalid file ends in one line."""

import os
import unittest

import glb
import program

FALLING = "ground {{}}\nfor i = 1, 5 do\n\tbox {{ size = {{ .6, .6, .6 }}, at = {{ .1 * i, 0, i }}{} }}\nend\n"
STANDING = "ground {{}}\ncamera 'main' {{ eye = {{ 3, -5, 3 }}, target = {{ 0, 0, 1 }} }}\n{}\n"
SIZE = ["--size", "96x64", "--set", "samples=1", "--fps", "10", "--duration", ".2"]


def difference(a, b):
	"""Difference of two pictures, per channel, of 255."""
	return sum(abs(x - y) for x, y in zip(a, b, strict=True)) / len(a)


class Meshes(program.Case):
	def write(self, name, content):
		os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
		with open(self.path(name), "wb" if isinstance(content, bytes) else "w") as f:
			f.write(content)
		return self.path(name)

	def frames(self, name, text, *words):
		scene = self.write(f"{name}.lua", text)
		report = program.report(scene, *SIZE, "--out", self.path(name + ".rgb"), *words)
		with open(self.path(name + ".rgb"), "rb") as f:
			return f.read(), report["state_hash"]

	def test_it_moves_as_it_did(self):
		self.write("cube.glb", glb.cube(.3))
		_, plain = self.frames("plain", FALLING.format(""))
		looks, meshed = self.frames("meshed", FALLING.format(", mesh = 'cube.glb'"))
		self.assertEqual(meshed, plain)
		again = self.frames("processes", FALLING.format(", mesh = 'cube.glb'"), "--isolation", "process", "--workers", "objects", "--harden")
		self.assertEqual(again, (looks, plain))

	def test_it_looks_like_its_mesh(self):
		self.write("looks/cube.glb", glb.cube(.5))
		self.write("looks/red.glb", glb.cube(1, (1, 0, 0)))
		points = ", ".join(f"{{ {', '.join(map(str, c))} }}" for c in glb.CORNERS)
		about = "static = true, at = { 0, 0, 1 }, rotation = { axis = { 1, 2, 3 }, degrees = 40 }, colour = '#ff0000'"
		hull, _ = self.frames("hull", STANDING.format(f"hull {{ points = {{ {points} }}, {about} }}"))
		for name, text in {
				"scaled": f"sphere {{ radius = .2, {about}, mesh = 'looks/cube.glb', mesh_scale = 2 }}",
				"turned": f"capsule {{ radius = .2, length = 1, {about}, mesh = 'looks/red.glb', mesh_rotation = {{ axis = {{ 0, 0, 1 }}, degrees = 90 }} }}",
				"painted": f"cylinder {{ radius = .2, length = 1, {about.partition(', colour')[0]}, mesh = 'looks/red.glb' }}",
				"hull's": f"hull {{ points = {{ {points.replace('-1', '-2')} }}, {about}, mesh = 'looks/red.glb' }}"}.items():
			with self.subTest(name):
				looks, _ = self.frames(name, STANDING.format(text))
				self.assertLess(difference(looks, hull), .2) # edges, and those of shadows
		moved, _ = self.frames("moved", STANDING.format(f"box {{ size = {{ 1, 1, 1 }}, {about}, mesh = 'looks/red.glb', mesh_at = {{ 0, 0, .5 }} }}"))
		self.assertGreater(difference(moved, hull), 1)

	def test_a_picture_lies_on_it(self):
		self.write("cube.glb", glb.cube(1, (1, 1, 1), picture=glb.QUARTERS))
		looks, _ = self.frames("picture", "ground {}\ncamera 'main' { eye = { 0, -9, 1.2 }, target = { 0, 0, 1.2 }, fov = 22 }\n"
			"sphere { radius = .2, at = { 0, 0, 1.2 }, static = true, mesh = 'cube.glb' }\n")
		at = lambda x, y: tuple(looks[3 * (96 * y + x):][:3])
		quarters = at(38, 22), at(58, 22), at(38, 42), at(58, 42) # in the first frame: red, green, blue, and grey
		for k, pixel in enumerate(quarters[:3]):
			self.assertGreater(pixel[k], 1.5 * max(pixel[:k] + pixel[k + 1:]), quarters)
		self.assertLess(max(quarters[3]), 1.3 * min(quarters[3]), quarters)

	def test_a_file_that_is_no_mesh(self):
		whole = glb.cube(1)
		self.write("cut.glb", whole[:-9])
		self.write("text.gltf", '{ "asset": { "version": "2.0" } }')
		self.write("points.glb", glb.cube(1, mode=0))
		self.write("noise.glb", bytes(range(256)))
		self.write("broken.glb", glb.cube(1, (1, 1, 1), picture=glb.QUARTERS).replace(b"IDAT", b"IDaT"))
		os.mkdir(self.path("folder.glb"))
		os.mkfifo(self.path("pipe.glb"))
		for name, saying in {"none.glb": "No such file", "cut.glb": "cut short", "text.gltf": "glTF as text", "points.glb": "no triangles",
				"broken.glb": "a picture of it is a damaged PNG",
				"noise.glb": "no binary glTF", "folder.glb": "no file", "pipe.glb": "no file", "../cube.glb": "in the folder of the scene",
				"/etc/passwd": "in the folder of the scene"}.items():
			with self.subTest(name):
				scene = self.write("scene.lua", f"ground {{}}\n\nbox {{ size = {{ 1, 1, 1 }}, mesh = '{name}' }}\n")
				done = self.refuse("run", scene, saying=saying)
				self.assertIn("scene.lua:3: box.mesh: ", done.stderr)
				self.assertIn(name, done.stderr)

	def test_what_scripts_create_has_one_of_the_scene(self):
		self.write("cube.glb", glb.cube(.5, (1, 1, 1), picture=glb.QUARTERS))
		points = "points = { { -1, -1, -1 }, { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 1 } }"
		known = (f"ground {{}}\nhull {{ {points}, static = true, at = {{ -2, 0, 1 }}, mesh = 'cube.glb', mesh_scale = 2, mesh_at = {{ 0, 0, .5 }} }}\n"
			"box { size = { 1, 1, 1 }, static = true, at = { 2, 0, 1 }, mesh = 'cube.glb' }\n"
			"camera 'main' { eye = { 3, -8, 3 }, target = { 0, 0, 1.5 } }\n")
		new = (f"hull {{ {points}, static = true, at = {{ 0, 0, 3 }}, mesh = 'cube.glb', mesh_scale = 2, mesh_at = {{ 0, -0.0, .5 }} }}\n"
			"\tsphere { radius = .2, static = true, at = { 0, -2, 1 }, mesh = 'cube.glb' }\n")
		scripted = "sphere {{ radius = .1, at = {{ 0, 0, 9 }}, script = [[\nfunction on_start()\n\t{}end]] }}\n"
		last = slice(-3 * 96 * 64, None)
		declared, _ = self.frames("declared", known + scripted.format("") + new)
		created, _ = self.frames("created", known + scripted.format(new))
		other, _ = self.frames("other", known + scripted.format(new.replace(", mesh = 'cube.glb' }", " }")))
		self.assertEqual(created[last], declared[last])
		self.assertNotEqual(created[last], other[last])
		for name, wrong in ("scale", new.replace("= 2", "= 3")), ("file", new.replace("cube", "ball")), ("hull", new.replace("{ 2, 0", "{ 3, 0")):
			with self.subTest(name):
				scene = self.write("wrong.lua", known + scripted.format(wrong))
				done = program.call("run", scene, "--duration", ".1")
				self.assertIn("wrong.lua", done.stderr)
				self.assertIn("mesh: expected one that an object of the scene has", done.stderr)

	def test_it_is_recorded(self):
		self.write("cube.glb", glb.cube(.3, (1, .8, .9), picture=glb.QUARTERS, shine=True))
		looks, _ = self.frames("meshed", FALLING.format(", mesh = 'cube.glb'"), "--record", self.path("r.h5"))
		os.remove(self.path("cube.glb"))
		program.call("run", "--replay", self.path("r.h5"), *SIZE, "--out", self.path("again.rgb"))
		with open(self.path("again.rgb"), "rb") as f:
			self.assertEqual(f.read(), looks)

	def test_it_is_read_again_to_go_on(self):
		self.write("cube.glb", glb.cube(.3))
		scene = self.write("scene.lua", FALLING.format(", mesh = 'cube.glb'"))
		whole = program.report(scene, "--duration", ".4")
		program.report(scene, "--duration", ".2", "--checkpoint", self.path("c"))
		self.assertEqual(program.report("--resume", self.path("c"), "--duration", ".4")["state_hash"], whole["state_hash"])
		os.remove(self.path("cube.glb"))
		self.refuse("run", "--resume", self.path("c"), saying="cube.glb: No such file")


unittest.main()
