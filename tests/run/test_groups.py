"""Collision groups and sensors: what passes through what, who is in a sensor, and the same bits in any configuration, with
deaths, and after a resume."""

import re
import shutil
import subprocess
import unittest

import program

WAYS = program.ways(["--workers", 1], ["--workers", 3, "--check"], ["--isolation", "process", "--workers", 2],
	["--isolation", "process", "--workers", "objects"], ["--isolation", "process", "--workers", 2, "--harden"])

SCENE = """scene { title = "Groups", duration = 1.5, room = 2 }
local SHELF, GHOST = 1, 2
ground {}
box { name = "shelf", size = { 3, 3, .2 }, at = { 0, 0, 2 }, static = true, group = SHELF }
box { name = "held", size = { .4, .4, .4 }, at = { 1, 0, 2.6 } }
box { name = "through", size = { .4, .4, .4 }, at = { 0, 0, 2.6 }, hits = { 0 } }
box { name = "ghost", size = { .4, .4, .4 }, at = { -1, .5, 2.4 }, group = GHOST, hits = { 0, SHELF } }
box { name = "twin", size = { .4, .4, .4 }, at = { -1, .5, 2.6 }, group = GHOST, hits = { 0, SHELF } }
sphere { name = "lost", radius = .2, at = { 5, 0, .5 }, hits = { 9 } }
box { name = "beam", size = { .4, .4, .4 }, at = { 7, 0, .2 } }
box { name = "twin of beam", size = { .4, .4, .4 }, at = { 7, .1, 1 } }
apart { "beam", "twin of beam" }
box { name = "swing", size = { .1, .1, 1 }, at = { 3, 0, 2 } }
hinge { "swing", at = { 3, 0, 2.5 }, axis = { 0, 1, 0 } }
script("door", [[
function on_step()
	for _, o in ipairs(self:inside()) do
		if not self.state[o:name()] then
			self.state[o:name()] = true
			print(self:name(), "at", time(), o:name())
		end
	end
	if time() == .5 and self:name() == "door" then sphere { radius = .1, at = { 0, 1, 3 }, hits = { 1 } } end
end
]])
cylinder { name = "door", radius = .5, length = .6, at = { 0, 0, .3 }, static = true, sensor = true, script = "door" }
box { name = "lift", size = { 1, 1, 1 }, at = { 1, 0, 3 }, kind = "kinematic", velocity = { 0, 0, -1 }, sensor = true,
	script = "door" }
sphere { name = "probe", radius = .3, at = { 3, .2, 1.5 }, sensor = true, script = "door" }
fixed { "probe", "swing" }
plane { name = "depths", at = { 0, 0, -1 }, group = 9, sensor = true, script = "door" }
box { name = "blind", size = { 9, 9, 9 }, static = true, sensor = true, hits = { 7 }, script = "door" }
"""


class Groups(program.Case):
	def setUp(self):
		super().setUp()
		self.scene = self.path("groups.lua")
		with open(self.scene, "w", encoding="utf-8") as f:
			f.write(SCENE)

	def state(self, *words):
		"""The state at the end, and what scripts have printed."""
		done = program.call("run", *words, "--set", "measure=end")
		found = re.search(r"^  state +([0-9a-f]{16})$", done.stdout, re.MULTILINE)
		self.assertTrue(done.returncode == 0 and found, f"{words}: {done.stdout}{done.stderr}")
		return found.group(1), sorted(re.findall(r"^obsim: (\S+) at (\S+) (\S+)$", done.stderr, re.MULTILINE))

	def test_who_is_in(self):
		said = self.state(self.scene)[1]
		found = {sensor: [other for name, _, other in said if name == sensor] for sensor in ("door", "lift", "probe", "depths", "blind")}
		self.assertEqual(found["door"], ["through"])
		self.assertEqual(found["lift"], ["held"])
		self.assertEqual(found["probe"], ["swing"])
		self.assertEqual(found["depths"], ["lost"])
		self.assertEqual(found["blind"], [])
		# It falls from .2 m above the door's top: sqrt(2 (2.6 - .2 - .6) / 9.81) = .606 s.
		entered = next(float(time) for name, time, _ in said if name == "door")
		self.assertTrue(.606 <= entered <= .606 + 1 / 60, entered)

	def test_depth(self):
		"""What may overlap is no penetration; what stands on the shelf is none, either."""
		done = program.report(self.scene, "--duration", ".9")
		self.assertLess(done["penetration_max_m"], 1e-3)

	def test_same_bits(self):
		self.assertEqual(len({str(self.state(self.scene, *way)) for way in WAYS}), 1)

	def test_kills(self):
		killed = self.state(self.scene, "--isolation", "process", "--workers", 2, "--fault", "kill:p=.01,seed=5")
		self.assertEqual(killed[0], self.state(self.scene)[0])

	def test_resume(self):
		kept = self.path("kept.ck")
		self.state(self.scene, "--duration", .5, "--checkpoint", kept)
		self.assertEqual(self.state("--resume", kept, "--duration", 1.5)[0], self.state(self.scene)[0])

	@unittest.skipUnless(shutil.which("mpirun"), "no mpirun")
	def test_ranks(self):
		text = re.sub(r"^(hinge|fixed|apart).*\n", "", SCENE, flags=re.MULTILINE)
		with open(self.scene, "w", encoding="utf-8") as f:
			f.write(text)
		done = subprocess.run(["mpirun", "-n", "2", program.OBSIM, "run", self.scene, "--workers", "1", "--set", "measure=end"],
			env=program.RANKS, capture_output=True, text=True, timeout=program.PATIENCE)
		self.assertIn(self.state(self.scene)[0], done.stdout, done.stderr)

	def test_monolith(self):
		"""ODE's one world has the same groups and sensors."""
		text = re.sub(r"^(hinge|fixed|apart).*\n", "", SCENE, flags=re.MULTILINE)
		with open(self.scene, "w", encoding="utf-8") as f:
			f.write(text)
		said = self.state(self.scene, "--arch", "monolith")[1]
		self.assertEqual([(name, other) for name, _, other in said],
			[("depths", "lost"), ("door", "through"), ("lift", "held"), ("probe", "swing")])

	def test_inside_asks_a_sensor(self):
		scene = self.path("wrong.lua")
		with open(scene, "w", encoding="utf-8") as f:
			f.write('sphere { radius = 1, script = [[function on_start() self:inside() end]] }')
		said = program.call("run", scene, "--duration", "1/60").stderr
		self.assertIn("inside: expected a sensor, as in sphere { radius = 1, sensor = true }", said)


unittest.main()
