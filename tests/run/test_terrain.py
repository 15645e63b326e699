"""Heightfields and meshes: the same bits in any configuration, with deaths, and after a resume; records and refusals."""

import os
import re
import unittest

import configurations
import glb
import mcap
import program

SCENE = """scene { title = "Hills", duration = 1 }
local function height(x, y) return .3 * math.sin(1.3 * x) * math.cos(y) + (x > 2 and .5 or 0) end
heightfield { name = "hills", size = { 12, 12 }, cells = { 30, 24 }, height = height, friction = .7 }
for i = 1, 5 do
	local x, y = 1.4 * i - 4, .5 * i - 1
	sphere { radius = .2, at = { x, y, 1.2 }, velocity = { 1, 0, 0 } }
	box { size = { .4, .3, .2 }, at = { x, y + 1.5, 1.4 }, spin = { 1, 2, 0 } }
	capsule { radius = .1, length = .3, at = { x, y - 1.5, 1.3 } }
	cylinder { radius = .2, length = .2, at = { x, y + 3, 1.3 }, spin = { 0, 3, 0 } }
	compound { at = { x, y - 3, 1.6 }, parts = { { size = { .6, .2, .1 } }, { size = { .1, .2, .4 }, at = { .25, 0, .2 } } } }
end
hinge { "sphere#1", "box#2", at = { -2.6, 0, 1.3 }, axis = { 0, 1, 0 } }
"""


def sheet(n, size, height):
	"""Points and triangles of n x n cells."""
	points = [(size * (i / n - .5), size * (j / n - .5), height(size * (i / n - .5), size * (j / n - .5)))
		for j in range(n + 1) for i in range(n + 1)]
	triangles = []
	for j in range(n):
		for i in range(n):
			a = j * (n + 1) + i
			triangles += [(a, a + 1, a + n + 2), (a, a + n + 2, a + n + 1)]
	return points, triangles


class Terrain(configurations.SameBits, program.Case):
	FILE, TEXT = "hills.lua", SCENE

	def test_penetration(self):
		self.assertLess(program.report(self.scene)["penetration_max_m"], 2e-3)

	def test_record(self):
		"""A record shows what the run shows."""
		record = self.path("r.h5")
		one, other = self.path("one"), self.path("other")
		picture = ["--size", "64x48", "--duration", "1/60"]
		done = program.call("run", self.scene, "--record", record, "--out", one, *picture)
		if "no pictures" in done.stderr:
			self.skipTest("no pictures")
		self.assertEqual(done.returncode, 0, done.stderr)
		done = program.call("run", "--replay", record, "--out", other, *picture)
		self.assertEqual(done.returncode, 0, done.stderr)
		names = sorted(p.name for p in os.scandir(one))
		self.assertTrue(names)
		for name in names:
			with open(f"{one}/{name}", "rb") as a, open(f"{other}/{name}", "rb") as b:
				self.assertEqual(a.read(), b.read(), name)

	def test_export(self):
		"""MCAP has the triangles."""
		record, out = self.path("r.h5"), self.path("r.mcap")
		done = program.call("run", self.scene, "--record", record, "--duration", "1/60")
		self.assertEqual(done.returncode, 0, done.stderr)
		done = program.call("export", record, out)
		self.assertEqual(done.returncode, 0, done.stderr)
		with open(out, "rb") as f:
			found = [len(t["indices"]) for _, _, m in mcap.messages(f.read())["/scene"] for e in m["entities"] for t in e["triangles"]]
		self.assertIn(3 * 2 * 30 * 24, found)

	def test_rays(self):
		self.write("""scene { duration = 1/60 }
script("eye", [[function on_start()
	for _, x in ipairs { -1, 0, .25, 3 } do
		local o, d, nx, ny, nz = ray({ x, .1, 5 }, { 0, 0, -1 })
		print("down", x, 5 - d, nx / nz, o:name())
	end
	print("aside", (select(2, ray({ 0, 0, .5 }, { 1, 0, 0 }))))
	print("below", ray({ 0, 0, -5 }, { 0, 0, 1 }) == nil)
end]])
sphere { radius = .1, at = { 0, 3, 5 }, script = "eye" }
heightfield { name = "slopes", size = { 10, 8 }, cells = { 20, 16 }, height = function(x, y) return math.abs(x) / 2 end }
""")
		done = program.call("run", self.scene)
		self.assertEqual(done.returncode, 0, done.stderr)
		said = done.stdout + done.stderr
		found = re.findall(r"down (\S+) (\S+) (\S+) slopes", said)
		self.assertEqual(len(found), 4, said)
		for x, z, slope in found:
			x, z, slope = float(x), float(z), float(slope)
			self.assertAlmostEqual(z, abs(x) / 2, 9)
			self.assertTrue(x == 0 or abs(slope + (.5 if x > 0 else -.5)) < 1e-9, said)
		self.assertAlmostEqual(float(re.search(r"aside (\S+)", said).group(1)), 1, 9)
		self.assertIn("below true", said)

	def test_monolith(self):
		"""The one ODE world holds bodies, too, and repeats itself."""
		self.write("""scene { duration = 3 }
heightfield { size = { 8, 8 }, cells = { 8, 8 }, height = function(x, y) return .2 * math.max(math.abs(x), math.abs(y)) end }
sphere { name = "ball", radius = .3, at = { 1, .4, 1.2 } }
box { size = { .4, .4, .4 }, at = { -1, -1, 1.2 } }
capsule { radius = .15, length = .4, at = { 1, -1.5, 1.2 } }
cylinder { radius = .2, length = .3, at = { -1.5, 1, 1.2 } }
""")
		states = {self.state(self.scene, "--arch", "monolith") for _ in range(2)}
		self.assertEqual(len(states), 1)
		self.assertLess(program.report(self.scene, "--arch", "monolith")["penetration_max_m"], .05)

	def test_refusals(self):
		self.write("heightfield { size = { 9, 9 }, cells = { 3, 3 }, height = function(x) return x * x end }")
		done = program.call("run", self.scene, "--duration", "1/60", "--sync", "free", "--set", "coupling=own")
		self.assertNotEqual(done.returncode, 0)
		self.assertIn("heightfields", done.stderr)

	@unittest.skipUnless(os.environ.get("MESHES"), "no meshes")
	def test_mesh(self):
		"""A ball and a box move on a mesh as on a heightfield, which tests/step compares with the plane; and in a valley."""
		with open(self.path("flat.glb"), "wb") as f:
			f.write(glb.mesh(*sheet(20, 10, lambda x, y: 0)))
		with open(self.path("valley.glb"), "wb") as f:
			f.write(glb.mesh(*sheet(20, 10, lambda x, y: abs(x) / 2)))
		roll = 'sphere { radius = .25, at = { -2, 0, .25 }, velocity = { 1, .2, 0 }, spin = { -.8, 4, 0 } }'
		box = 'box { size = { .4, .4, .4 }, at = { 0, 2, .2 }, velocity = { 1, .3, 0 } }'
		states = set()
		for floor in ('heightfield { size = { 10, 10 }, cells = { 20, 20 }, height = function() return 0 end }', 'mesh { file = "flat.glb" }'):
			self.write(f"scene {{ duration = 2 }} {roll} {box} {floor}")
			states.add(self.state(self.scene))
		self.assertEqual(len(states), 1)
		self.write('scene { duration = 4 } sphere { radius = .25, at = { 1, 0, 1 }, friction = 0 } mesh { file = "valley.glb" }')
		self.assertLess(program.report(self.scene)["penetration_max_m"], 2e-3)

	@unittest.skipUnless(os.environ.get("MESHES"), "no meshes")
	def test_bad_mesh(self):
		points, _ = sheet(2, 2, lambda x, y: 0) # the first three lie in a line
		with open(self.path("thin.glb"), "wb") as f:
			f.write(glb.mesh(points, [(0, 1, 2)]))
		self.write('mesh { file = "thin.glb" }')
		done = program.call("run", self.scene)
		self.assertEqual(done.returncode, 2)
		self.assertRegex(done.stderr, r"hills.lua:1: mesh.file: cannot read \S+thin.glb: it has no triangles")


unittest.main()
