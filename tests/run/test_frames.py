"""Frames: the right number, each at its time, the same bytes each time, whatever runs the scene."""

import glob
import hashlib
import os
import shutil
import subprocess
import sys
import unittest
import zlib

import program

SIZE = ["--size", "64x48", "--set", "samples=1"]
BOXES = [program.scene("falling_boxes"), "-D", "n=12"]
BYTES = 64 * 48 * 3


def stamps(path):
	"""The texts of a PNG file, whose chunks are whole: each CRC is checked."""
	texts = {}
	with open(path, "rb") as f:
		data = f.read()
	assert data[:8] == b"\x89PNG\r\n\x1a\n" and data.endswith(b"IEND\xaeB`\x82")
	at = 8
	while at < len(data):
		length, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
		body = data[at + 8:at + 8 + length]
		assert zlib.crc32(kind + body) == int.from_bytes(data[at + 8 + length:at + 12 + length], "big")
		if kind == b"tEXt":
			key, _, value = body.partition(b"\0")
			texts[key.decode()] = value.decode()
		at += 12 + length
	return texts


def digest(directory):
	digests = []
	for path in sorted(glob.glob(directory + "/*.png")):
		with open(path, "rb") as f:
			digests.append(hashlib.sha256(f.read()).hexdigest())
	return digests


class Frames(program.Case):
	def test_stills(self):
		"""Single frames equal those of a film at these times."""
		self.draw("film", "--duration", "1", "--fps", "10")
		self.assertEqual(self.draw("stills", "--duration", "1", "--still", ".3,.8")["frames"], 2)
		for still, frame in enumerate((3, 8)):
			with open(self.path(f"film/frame-{frame:06}.png"), "rb") as a, open(self.path(f"stills/frame-{still:06}.png"), "rb") as b:
				self.assertEqual(a.read(), b.read())
		late = program.call("run", *BOXES, "--out", self.path("late"), "--still", "2", "--duration", "1")
		self.assertEqual(late.returncode, 2)
		self.assertIn("the run ends at 1 s", late.stderr)

	def test_colours(self):
		"""Colours by islands are the same for threads and processes; by simulators they differ from the scene's."""
		pictures = {}
		for name, *words in (("own",), ("simulator", "--colour-by", "simulator"), ("island", "--colour-by", "island"),
				("processes", "--colour-by", "island", "--isolation", "process", "--workers", "3")):
			self.draw(name, "--duration", "1", "--still", "1", *words)
			pictures[name] = digest(self.path(name))
		self.assertEqual(pictures["island"], pictures["processes"])
		self.assertEqual(len({str(p) for p in pictures.values()}), 3)

	def test_own_times(self):
		"""Bodies have colours by lag in a free run, and are grey in lockstep."""
		for name, *words in (("free", "--sync", "free", "--set", "coupling=own", "--set", "jitter=.3"), ("lockstep",)):
			self.draw(name, "--duration", "1", "--still", "1", "--colour-by", "lag", *words)
		self.assertNotEqual(digest(self.path("free")), digest(self.path("lockstep")))

	def draw(self, name, *words):
		report = program.report(*BOXES, *SIZE, "--out", self.path(name), *words)
		names = sorted(os.listdir(self.path(name)))
		self.assertEqual(names, [f"frame-{i:06}.png" for i in range(report["frames"])])
		return report

	def test_count_and_times(self):
		r = self.draw("f", "--duration", "1", "--fps", "60")
		self.assertEqual(r["frames"], 60)
		self.assertGreater(r["fps"], 0)
		for i in range(60):
			text = stamps(self.path(f"f/frame-{i:06}.png"))
			(value,) = (v for k, v in text.items() if "time" in k.lower())
			self.assertAlmostEqual(float(value.split()[0]), i / 60, delta=1e-6)

	def test_other_rates(self):
		for fps, count in ("25", 25), ("144", 144), ("29.97", 29), ("1/2", 1):
			with self.subTest(fps=fps):
				self.assertEqual(self.draw("f" + fps.replace("/", "_"), "--duration", "1", "--fps", fps)["frames"], count)

	def test_six_hundred(self):
		raw = self.path("all.rgb")
		r = program.report(program.scene("cradle"), "--size", "16x16", "--set", "samples=1", "--out", raw, "--duration", "10",
			"--set", "measure=end")
		self.assertEqual(r["frames"], 600)
		self.assertEqual(os.path.getsize(raw), 600 * 16 * 16 * 3)

	def test_same_bytes(self):
		"""Twice, and in processes, and without measuring: the same pictures."""
		expected = None
		for i, words in enumerate(([], [], ["--isolation", "process", "--workers", "3"], ["--set", "measure=end"])):
			self.draw(str(i), "--duration", ".5", "--fps", "50", "--overlay", "aabb,contacts", *words)
			found = digest(self.path(str(i)))
			self.assertEqual(len(found), 25)
			expected = expected or found
			self.assertEqual(found, expected, words)
		self.assertGreater(len(set(expected)), 20) # things move

	def test_who_simulates(self):
		"""A strip of workers at the upper left, with the own times of a free run below: the rest of the picture is as before."""
		size, wide = ["--size", "640x360", "--set", "samples=1"], 640
		def picture(*words):
			raw = self.path("r.rgb")
			program.report(*BOXES, *size, "--workers", "2", "--still", ".5", "--out", raw, *words)
			with open(raw, "rb") as f:
				return f.read()
		plain, strip = picture(), picture("--overlay", "simulators")
		changed = {(i // 3 % wide, i // 3 // wide) for i in range(len(plain)) if plain[i] != strip[i]}
		self.assertGreater(len(changed), 2000)
		self.assertLess(max(x for x, _ in changed), 300)
		lowest = max(y for _, y in changed)
		self.assertLess(lowest, 60)
		free = picture("--sync", "free", "--overlay", "simulators")
		rows = [free[3 * wide * y:3 * wide * y + 3 * 250] for y in range(lowest + 4, lowest + 60)]
		self.assertGreater(len({row[3 * x:3 * x + 3] for row in rows for x in range(12, 240)}), 20)

	def test_reads(self):
		"""Lines between objects whose bounds overlap, of all or of one; the rest of the picture is as before."""
		with open(self.path("scene.lua"), "w") as f:
			f.write("ground {}\ncamera 'main' { eye = { 0, -9, 3 }, target = { 0, 0, .5 } }\n"
				"for i, x in ipairs { -3, -1.98, 2, 3.02 } do box { name = 'box ' .. i, size = { 1, 1, 1 }, at = { x, 0, .5 } } end\n")
		wide, high = 320, 180
		def picture(*words):
			raw = self.path("r.rgb")
			program.report(self.path("scene.lua"), "--size", f"{wide}x{high}", "--set", "samples=1", "--still", ".5", "--duration", "1", "--out", raw, *words)
			with open(raw, "rb") as f:
				return f.read()
		plain = picture()
		def changed(*words):
			drawn = picture("--overlay", *words)
			return [i // 3 % wide for i in range(len(plain)) if plain[i] != drawn[i]]
		every, one, none = changed("reads"), changed("reads=box 1"), changed("reads=other")
		self.assertEqual(none, [])
		self.assertLess(max(one), wide / 2)
		self.assertGreater(len(one), 50) # from one centre to the other
		self.assertEqual(sorted(every)[:len(one)], sorted(one))
		self.assertGreater(min(sorted(every)[len(one):]), wide / 2) # the other two; none across the gap
		self.assertGreater(len(every), 1.8 * len(one))

	def test_old_frames_are_replaced(self):
		self.draw("f", "--duration", ".5")
		r = self.draw("f", "--duration", ".2")
		self.assertEqual(r["frames"], 12)

	def test_directories_are_made(self):
		"""Files may lie in a directory that --out creates."""
		report = program.report(*BOXES, *SIZE, "--duration", ".1", "--out", self.path("a/b/c"), "--out", self.path("a/r.rgb"),
			"--series", self.path("a/b/s.csv"))
		self.assertEqual(len(os.listdir(self.path("a/b/c"))), report["frames"])
		self.assertEqual(os.path.getsize(self.path("a/r.rgb")), report["frames"] * BYTES)
		self.assertTrue(os.path.exists(self.path("a/b/s.csv")))

	def test_raw_to_a_pipe(self):
		done = subprocess.run([program.OBSIM, "run", *BOXES, *SIZE, "--duration", ".5", "--out", "-"], stdout=subprocess.PIPE,
			stderr=subprocess.PIPE, timeout=program.PATIENCE)
		self.assertEqual(done.returncode, 0)
		self.assertEqual(len(done.stdout), 30 * BYTES)
		self.assertIn(b"\n  state  ", done.stderr) # the report gives way

	def test_reader_leaves(self):
		"""A pipe whose reader has gone ends the run with a message."""
		run = program.start("run", *BOXES, *SIZE, "--duration", "1000", "--out", "-", "--name", self.name)
		run.stdout.close()
		self.assertEqual(run.wait(program.PATIENCE), 1)
		said = run.stderr.read()
		run.stderr.close()
		self.assertIn("obsim: ", said)

	@unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed")
	def test_what_ffmpeg_says(self):
		done = program.call("run", *BOXES, *SIZE, "--out", self.path("v.xyz"), "--duration", "1")
		self.assertEqual(done.returncode, 1)
		self.assertRegex(done.stderr, r"^obsim: \S*v.xyz: ffmpeg failed: .*format")
		self.assertNotIn("@ 0x", done.stderr)  # the temporary folder may have any name

	@unittest.skipUnless(shutil.which("ffmpeg") and shutil.which("ffprobe"), "ffmpeg is not installed")
	def test_video(self):
		video = self.path("v.mp4")
		r = program.report(*BOXES, *SIZE, "--out", video, "--duration", "1", "--fps", "30")
		self.assertEqual(r["frames"], 30)
		probe = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames,width,height",
			"-of", "csv=p=0", video], stdout=subprocess.PIPE, text=True, check=True, timeout=60)
		self.assertEqual(probe.stdout.strip(), "64,48,30")

	def test_cameras_differ(self):
		done = program.call("run", *BOXES, "--out", self.path("x.rgb"), "--camera", "mian")
		self.assertEqual(done.returncode, 2)
		self.assertIn("did you mean main?", done.stderr)

	def test_wrong_gpu(self):
		done = program.call("run", *BOXES, *SIZE, "--out", self.path("x.rgb"), "--set", "gpu=99", "--name", self.name)
		self.assertEqual(done.returncode, 1)
		self.assertIn("99", done.stderr)


if "no EGL" in program.call("--version").stdout:
	sys.exit(77)
unittest.main()
