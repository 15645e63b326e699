"""Files given to obsim: each command reads only regular files; and records on a full disk."""

import os
import shutil
import subprocess
import tempfile
import unittest

import program

ENTRANCES = ["run FILE", "compare FILE", "serve FILE", "run --resume FILE", "inspect FILE", "run --replay FILE --out /dev/null", "serve --replay FILE",
	"export FILE /dev/null"]


class Files(unittest.TestCase):
	def setUp(self):
		self.directory = tempfile.TemporaryDirectory()
		self.addCleanup(self.directory.cleanup)

	def path(self, name):
		return os.path.join(self.directory.name, name)

	def test_none_but_regular_files(self):
		"""One line each, at once: no command waits for a pipe without a writer."""
		os.mkfifo(self.path("pipe"))
		os.symlink("pipe", self.path("link"))
		os.symlink("nothing", self.path("dangling"))
		os.mkdir(self.path("folder"))
		for name in "pipe", "link", "dangling", "folder", "/dev/zero":
			for words in ENTRANCES:
				with self.subTest(name=name, words=words):
					done = program.call(*words.replace("FILE", self.path(name)).split(), timeout=100)
					self.assertIn(done.returncode, (1, 2), done)
					self.assertRegex(done.stderr, "no file|No such file|irectory|EGL|egl", words)
					self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

	def test_scripts_and_meshes(self):
		os.mkfifo(self.path("pipe.lua"))
		os.mkfifo(self.path("pipe.glb"))
		for field in "script = 'pipe.lua'", "mesh = 'pipe.glb'":
			if "glb" in field and not program.MESHES:
				continue
			with open(self.path("scene.lua"), "w") as f:
				f.write(f"sphere {{ radius = 1, {field} }}")
			done = program.call("run", self.path("scene.lua"), timeout=100)
			self.assertEqual(done.returncode, 2)
			self.assertIn("it is no file, but a pipe", done.stderr)

	def record_on(self, kilobytes, scene):
		"""Records a run on a disk of its own of that size, and copies the record, if there is one, for the
		test."""
		os.makedirs(self.path("disk"), exist_ok=True)
		command = 'mount -t tmpfs -o size="$1"k none "$2" || exit 77; "$3" run "$4" --duration 1 --record "$2/r.h5"; code=$?; cp "$2/r.h5" "$5"; exit $code'
		done = subprocess.run(["unshare", "-r", "-m", "sh", "-c", command, "sh", str(kilobytes), self.path("disk"), program.OBSIM, program.scene(scene),
			self.path("r.h5")], capture_output=True, text=True, timeout=program.PATIENCE)
		if "unshare" in done.stderr or done.returncode == 77:
			self.skipTest("no mount namespace: " + done.stderr)
		return done

	def test_full_disk(self):
		"""On a full disk, a record holds the states up to then, at least one; without room for one there is no
		record."""
		if not shutil.which("unshare"):
			self.skipTest("no unshare")
		outcomes = set()
		for scene in "stack", "flock":
			for kilobytes in 8, 40, 100, 300, 500, 600, 650, 700, 800, 1000, 1300, 1600, 2500:
				if os.path.exists(self.path("r.h5")):
					os.unlink(self.path("r.h5"))
				done = self.record_on(kilobytes, scene)
				there = os.path.exists(self.path("r.h5"))
				with self.subTest(scene=scene, kilobytes=kilobytes):
					self.assertIn(done.returncode, (0, 1), done)
					if done.returncode == 1:
						self.assertRegex(done.stderr, r"r\.h5: .*No space left on device")
					else:
						self.assertTrue(there)
					if there:
						read = program.call("export", self.path("r.h5"), self.path("page.html"))
						self.assertEqual(read.returncode, 0, read)
				outcomes.add((done.returncode, there))
		self.assertEqual(outcomes, {(1, False), (1, True), (0, True)})


if __name__ == "__main__":
	unittest.main()
