"""Optional libraries: the program maps none until it needs one, worker processes map none. Without its parts
(obsim-NAME.so) each command that needs one fails in one line, exit 2, while all else works.
"""

import os
import re
import shutil
import subprocess
import unittest

import program

OPTIONAL = r"lib(cairo|EGL|OpenGL|hdf5|Bullet|mujoco|websockets|tinygltf|jpeg|zip)|obsim-\w+\.so"


def mapped(pid):
	with open(f"/proc/{pid}/maps", encoding="utf-8", errors="replace") as f:
		return sorted(set(re.findall(OPTIONAL, f.read())))


class Parts(program.Case):
	def alone(self, *words):
		"""The program in a folder without its parts."""
		lonely = self.path("obsim")
		if not os.path.exists(lonely):
			shutil.copy(program.OBSIM, lonely)
		return subprocess.run([lonely, *map(str, words)], cwd=self.directory.name, capture_output=True, text=True,
			timeout=program.PATIENCE)

	def refused(self, part, *words):
		done = self.alone(*words)
		self.assertEqual(done.returncode, 2, done.stderr)
		self.assertEqual(done.stdout, "")
		self.assertRegex(done.stderr, rf"^obsim: obsim-{part}\.so is missing: .* it needs lib[^\n]*\n\Z")

	def test_missing(self):
		stack = program.scene("stack")
		self.refused("render", "run", stack, "--out", "frames")
		self.refused("render", "paper", "--quick")
		self.refused("serve", "serve", stack)
		self.refused("hdf5", "run", stack, "--record", "stack.h5")
		self.refused("bullet", "lab", "head-on", "--engines", "bullet")
		self.refused("mujoco", "lab", "head-on", "--engines", "obsim,mujoco")
		done = self.alone("run", stack, "--duration", ".1")
		self.assertEqual(done.returncode, 0, done.stderr)
		shutil.copy(os.path.join(os.path.dirname(program.OBSIM), "obsim-render.so"), self.path("obsim-render.so"))
		self.refused("cairo", "run", stack, "--out", "frames", "--overlay", "caption")
		self.assertEqual(self.alone("--version").returncode, 0)

	def test_a_part_of_another_version(self):
		self.alone("--version")
		other = os.path.join(os.path.dirname(program.OBSIM), "obsim-hdf5.so") # with more functions
		shutil.copy(other, self.path("obsim-render.so"))
		done = self.alone("run", program.scene("stack"), "--out", "frames", "--duration", ".1")
		self.assertNotEqual(done.returncode, 0)
		self.assertRegex(done.stderr, r"obsim-render\.so belongs to another obsim")

	def test_workers_map_none(self):
		run = self.start_universe(program.scene("falling_boxes"), "-D", "n=20", "--isolation", "process", "--workers", "2",
			"--duration", program.FOR_EVER, "--out", self.path("frames"), "--size", "64x36")
		self.assertTrue(program.wait_until(lambda: "EGL" in mapped(run.pid)))
		workers = program.simulators(run.pid)
		self.assertGreaterEqual(len(workers), 2)
		for pid in [program.fork_server(run.pid), *workers]:
			self.assertEqual(mapped(pid), [])
		run.terminate()
		run.wait()


if __name__ == "__main__":
	unittest.main()
