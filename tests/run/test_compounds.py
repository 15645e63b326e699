"""Compounds: the same bits in any configuration, with deaths, and after a resume; records, sensors and refusals."""

import re
import unittest

import configurations
import program

SCENE = """scene { title = "Compounds", duration = 1 }
ground {}
local channel = { { size = { 2, .6, .1 }, at = { 0, 0, .05 } }, { size = { 2, .1, .6 }, at = { 0, -.25, .4 } },
	{ size = { 2, .1, .6 }, at = { 0, .25, .4 } } }
compound { name = "channel", parts = channel, static = true }
compound { name = "lift", parts = channel, at = { 4, 0, 1 }, kind = "kinematic", velocity = { 0, 0, .2 }, spin = { 0, 0, .3 } }
box { name = "peg", size = { .3, .38, .2 }, at = { 0, 0, .6 }, velocity = { .2, 1, 0 } }
sphere { name = "ball", radius = .15, at = { 4, 0, 1.6 } }
capsule { name = "rod", radius = .1, length = .4, at = { .5, 0, 1 }, rotation = { axis = { 0, 1, 0 }, degrees = 80 } }
cylinder { name = "drum", radius = .15, length = .2, at = { -.5, 0, 1 } }
for i = 1, 6 do
	compound { name = "chair" .. i, at = { -4, .1 * i, 1.5 * i }, colour = "#c08a53", rotation = { axis = { 1, i, 0 }, degrees = 40 * i },
		parts = { { size = { .5, .5, .06 } }, { size = { .06, .5, .6 }, at = { -.25, 0, .3 } },
			{ size = { .06, .06, .5 }, at = { .2, .2, -.25 } }, { size = { .06, .06, .5 }, at = { .2, -.2, -.25 } },
			{ size = { .06, .06, .5 }, at = { -.2, .2, -.25 } }, { size = { .06, .06, .5 }, at = { -.2, -.2, -.25 } } } }
end
sphere { name = "inside", radius = .05, at = { 4, 0, 1.5 }, static = true, sensor = true, script = [[
function on_step()
	for _, o in ipairs(self:inside()) do
		if not self.state[o:name()] then self.state[o:name()] = true print("in", o:name()) end
	end
end]] }
"""


class Compounds(configurations.SameBits, program.Case):
	FILE, TEXT = "compounds.lua", SCENE

	def test_parts_collide_one_by_one(self):
		"""What lies in a channel is not inside the hull around it; only what overlaps a part overlaps."""
		report = program.report(self.scene)
		self.assertLess(report["penetration_max_m"], 1e-3)

	def test_sensor(self):
		"""A sensor in a kinematic channel's hull, but in none of its parts, finds what is in it alone."""
		done = program.call("run", self.scene)
		self.assertEqual(re.findall(r" in (\S+)$", done.stderr, re.MULTILINE), ["ball"])

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
		names = sorted(p.name for p in program.os.scandir(one))
		self.assertTrue(names)
		for name in names:
			with open(f"{one}/{name}", "rb") as a, open(f"{other}/{name}", "rb") as b:
				self.assertEqual(a.read(), b.read(), name)

	def test_refusals(self):
		with open(self.scene, "w", encoding="utf-8") as f:
			f.write("compound { parts = { { size = { 1, 1, 1 } }, { size = { 1, 1, 1 }, at = { 1, 0, 0 } } } }")
		for words, said in ((["--sync", "free", "--set", "coupling=own"], "compounds"), (["--arch", "monolith"], "no hulls")):
			done = program.call("run", self.scene, "--duration", "1/60", *words)
			self.assertNotEqual(done.returncode, 0)
			self.assertIn(said, done.stderr)


unittest.main()
