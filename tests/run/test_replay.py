"""A run is recorded, and shown again: the same pictures, without a simulator."""

import glob
import hashlib
import os
import subprocess
import unittest

import program

SIZE = ["--size", "96x64", "--set", "samples=1"]
BOXES = [program.scene("falling_boxes"), "-D", "n=12", "--duration", ".7"]
COMES_AND_GOES = """scene {{ title = "Some come and go", duration = 1, step = 1 / 60 }}
ground {{}}
record {{ every = {every} }}
camera "main" {{ eye = {{ -4, -5, 3 }}, target = {{ 0, 0, 1 }} }}
camera "travelling" {{ eye = {{ 5, -5, 2 }}, target = {{ 0, 0, 1 }}, velocity = {{ 1, 0, 0 }}, pan = .3 }}
box {{ size = {{ 1, .4, .2 }}, at = {{ 0, 0, 2 }}, spin = {{ 3, 2, 1 }}, colour = "#e4572e" }}
sphere {{ radius = .3, at = {{ 0, 0, .9 }}, dies = .5 }}
capsule {{ radius = .2, length = .6, at = {{ 1, 0, 1.5 }}, born = .25, spin = {{ 9, 0, 0 }} }}
cylinder {{ radius = .2, length = .6, at = {{ -1, 0, 1.5 }}, born = .3, dies = .8 }}
hull {{ points = {{ {{ 0, 0, 0 }}, {{ .8, 0, 0 }}, {{ 0, .6, 0 }}, {{ .2, .2, .7 }} }}, at = {{ .5, -1, 1 }}, spin = {{ 1, 2, 3 }} }}
sphere {{ radius = .1, at = {{ 2, 1, .1 }}, script = [[function on_start() self:wake(.2) end function on_wake()
	hull {{ points = {{ {{ 0, 0, 0 }}, {{ .6, 0, 0 }}, {{ 0, .8, 0 }}, {{ .1, .1, .4 }}, {{ .5, .5, .4 }} }}, at = {{ 1, 1, 1.5 }} }} end]] }}
hull {{ points = {{ {{ 0, 0, 0 }}, {{ .5, 0, 0 }}, {{ 0, .5, 0 }}, {{ 0, 0, .5 }}, {{ .5, .5, .5 }} }}, at = {{ -1, -1, 1 }}, born = .4 }}
sphere {{ name = "bob", radius = .1, at = {{ -2, 1, 1.6 }}, mass = 1 }}
hinge {{ "bob", name = "eye", at = {{ -2.4, 1, 1.6 }}, axis = {{ 0, 1, 0 }}, breaks_at = {{ force = 15 }} }}
"""


def pictures(directory):
	found = {}
	for path in sorted(glob.glob(directory + "/*.png")):
		with open(path, "rb") as f:
			found[os.path.basename(path)] = hashlib.sha256(f.read()).hexdigest()
	return found


class Replay(program.Case):
	def write_scene(self, every):
		path = self.path(f"scene{every}.lua")
		with open(path, "w") as f:
			f.write(COMES_AND_GOES.format(every=every))
		return path

	def record(self, *words):
		record = self.path("run.h5")
		program.report(*words, "--record", record)
		return record

	def draw(self, folder, *words):
		done = program.call("run", *words, *SIZE, "--out", self.path(folder))
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		return pictures(self.path(folder))

	def test_same_pictures(self):
		"""Pictures of each step, and of times between two, with any camera."""
		for words in (BOXES, [self.write_scene(1)]):
			record = self.record(*words)
			for view in (["--fps", "60"], ["--fps", "50", "--overlay", "aabb,joints"], ["--fps", "23", "--camera", "travelling"]):
				if words is BOXES and "--camera" in view:
					continue
				name = f"{len(words)}{'-'.join(view)}"
				was = self.draw("was" + name, *words, *view)
				now = self.draw("now" + name, "--replay", record, *view)
				self.assertGreater(len(was), 10)
				self.assertEqual(was, now, (words, view))

	def test_sparse(self):
		"""If only some steps were recorded, these give the same pictures."""
		scene = self.write_scene(4)
		record = self.record(scene)
		was, now = self.draw("was", scene, "--fps", "15"), self.draw("now", "--replay", record, "--fps", "15")
		self.assertEqual(len(was), 15)
		self.assertEqual(was, now)
		self.assertEqual(len(self.draw("more", "--replay", record, "--fps", "60")), 60)

	def test_part(self):
		record = self.record(*BOXES)
		whole = self.draw("whole", "--replay", record)
		part = self.draw("part", "--replay", record, "--duration", ".3")
		self.assertEqual(len(part), 18)
		self.assertEqual(part, {name: whole[name] for name in part})

	def test_pipe(self):
		record = self.record(*BOXES)
		done = subprocess.run([program.OBSIM, "run", "--replay", record, *SIZE, "--out", "-", "--fps", "10"], capture_output=True,
			timeout=program.PATIENCE)
		self.assertEqual((done.returncode, len(done.stdout)), (0, 7 * 96 * 64 * 3))
		self.assertIn(b"7 frames", done.stderr)

	def test_resumed(self):
		"""A resumed run has a record of its own, which begins at the checkpoint."""
		checkpoint = self.path("c")
		program.report(*BOXES[:3], "--duration", ".3", "--checkpoint", checkpoint)
		record = self.path("late.h5")
		program.report("--resume", checkpoint, "--duration", ".7", "--record", record)
		was, now = self.draw("was", *BOXES), self.draw("now", "--replay", record)
		self.assertEqual(sorted(now), [f"frame-{i:06}.png" for i in range(18, 42)])
		self.assertEqual(now, {name: was[name] for name in now})

	def test_misuse(self):
		record = self.record(*BOXES[:3], "--duration", ".1")
		frames = ["--out", self.path("f")]
		for words, saying in (
				([], "--replay needs --out"),
				([*frames, "--seed", "2"], "--seed: a record is shown as it was run"),
				([*frames, "-D", "n=3"], "--define: a record is shown as it was run"),
				([*frames, program.scene("stack")], "expected one of them"),
				([*frames, "--camera", "nobody"], "--camera nobody: the scene has none of this name"),
				([*frames, "--overlay", "contacts"], "a record holds no contacts"),
				([*frames, "--overlay", "simulators"], "does not hold where simulators ran")):
			self.refuse("run", "--replay", record, *words, saying=saying)
		self.refuse("run", "--replay", program.scene("stack"), *frames, saying="no HDF5 file")
		self.refuse("run", "--replay", self.path("nothing"), *frames, saying="No such file or directory")
		with open(record, "r+b") as f:
			f.truncate(os.path.getsize(record) // 2)
		self.refuse("run", "--replay", record, *frames, saying="cut short")


if __name__ == "__main__":
	unittest.main()
