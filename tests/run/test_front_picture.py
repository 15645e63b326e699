"""Pictures of README and docs are the program's: the README's first one, and the first frame of those that move, are drawn
again, smaller and with fewer samples, and compared as thumbnails. Another Mesa draws other edges, but the same picture.
"""

import os
import shutil
import struct
import subprocess
import sys
import unittest
import zlib

import program

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FRONT = os.path.join(ROOT, "docs", "images", "falling_boxes.png")
WIDE, HIGH = 64, 36 # cells of the thumbnail
MEAN, MOST = 3, 32 # tolerance of cells, of 255


def rows_of_png(path):
	"""Width, and the rows of an RGB picture of 8 bits, from the top (PNG, second edition, clause 9)."""
	with open(path, "rb") as f:
		data = f.read()
	at, packed, width = 8, b"", 0
	while at < len(data):
		length, kind = struct.unpack(">I4s", data[at:at + 8])
		body = data[at + 8:at + 8 + length]
		if kind == b"IHDR":
			width, _, depth, colour, _, _, interlace = struct.unpack(">IIBBBBB", body)
			assert (depth, colour, interlace) == (8, 2, 0), "not a plain RGB picture"
		elif kind == b"IDAT":
			packed += body
		at += 12 + length
	raw, stride = zlib.decompress(packed), 3 * width
	rows, above = [], bytes(stride)
	for start in range(0, len(raw), stride + 1):
		rule, row = raw[start], bytearray(raw[start + 1:start + 1 + stride])
		for i in range(stride):
			left, up, corner = (row[i - 3], above[i], above[i - 3]) if i > 2 else (0, above[i], 0)
			if rule == 1:
				row[i] = row[i] + left & 255
			elif rule == 2:
				row[i] = row[i] + up & 255
			elif rule == 3:
				row[i] = row[i] + (left + up) // 2 & 255
			elif rule == 4:
				guess = left + up - corner
				off = abs(guess - left), abs(guess - up), abs(guess - corner)
				row[i] = row[i] + (left if off[0] <= off[1] and off[0] <= off[2] else up if off[1] <= off[2] else corner) & 255
		rows.append(row)
		above = row
	return width, rows


def thumbnail(width, rows):
	"""Means over cells: WIDE x HIGH x 3 numbers."""
	across, down = width // WIDE, len(rows) // HIGH
	cells = []
	for y in range(HIGH):
		sums = [0] * (3 * WIDE)
		for row in rows[y * down:(y + 1) * down]:
			for x in range(WIDE):
				part = row[3 * x * across:3 * (x + 1) * across]
				for k in range(3):
					sums[3 * x + k] += sum(part[k::3])
		cells += [s / (across * down) for s in sums]
	return cells


def frames_of_webp(path):
	"""Frames of an animated WebP, each by the bytes of its picture (WebP Container Specification: VP8X, ANIM, ANMF)."""
	with open(path, "rb") as f:
		data = f.read()
	assert data[:4] == b"RIFF" and data[8:12] == b"WEBP"
	frames, at = [], 12
	while at < len(data):
		kind, size = struct.unpack("<4sI", data[at:at + 8])
		if kind == b"ANMF":
			# whole frames, which replace what was there: parts leave ghosts
			assert data[at + 8:at + 14] == bytes(6) and data[at + 23] == 2, path
			frames.append(data[at + 24:at + 8 + size])
		at += 8 + size + size % 2
	return frames


def rows_of_frame(frame, width, height):
	"""Rows of a frame that covers the picture."""
	still = b"RIFF" + struct.pack("<I", 4 + len(frame)) + b"WEBP" + frame
	raw = subprocess.run(["ffmpeg", "-loglevel", "error", "-f", "webp_pipe", "-i", "-", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
		input=still, capture_output=True, check=True).stdout
	assert len(raw) == 3 * width * height
	return [raw[i:i + 3 * width] for i in range(0, len(raw), 3 * width)]


class FrontPicture(program.Case):
	@unittest.skipUnless(shutil.which("ffmpeg"), "no ffmpeg, which decodes WebP")
	def test_moving(self):
		for name, scene, frames, words in ("plaza", "plaza", 25, []), ("colours", "falling_boxes", 32, ["--colour-by", "simulator"]), \
				("killed", "tower", 36, ["--colour-by", "worker"]):
			with self.subTest(name=name):
				path = os.path.join(ROOT, "docs", "images", f"moving_{name}.webp")
				self.assertLess(os.path.getsize(path), 4e5)
				found = frames_of_webp(path)
				self.assertAlmostEqual(len(found), frames, delta=2) # equal frames are one
				raw = self.path(name + ".rgb")
				program.report(program.scene(scene), "--duration", ".01", "--still", "0", "--size", "320x180", "--out", raw,
					"--set", "measure=end", *words)
				with open(raw, "rb") as f:
					data = f.read()
				drawn = thumbnail(320, [data[i:i + 960] for i in range(0, 320 * 180 * 3, 960)])
				off = [abs(a - b) for a, b in zip(thumbnail(640, rows_of_frame(found[0], 640, 360)), drawn)]
				self.assertLess(sum(off) / len(off), 2 * MEAN)

	def draw(self, *words):
		raw = self.path("r.rgb")
		program.report(program.scene("falling_boxes"), "--duration", "1.6", "--fps", "1.25", "--size", "320x180", "--out", raw,
			"--set", "measure=end", *words)
		with open(raw, "rb") as f:
			data = f.read()[320 * 180 * 3:]
		return thumbnail(320, [data[i:i + 960] for i in range(0, len(data), 960)])

	def test_is_what_is_drawn(self):
		front = thumbnail(*rows_of_png(FRONT))
		off = [abs(a - b) for a, b in zip(front, self.draw("--quality", "fine", "--set", "samples=8"))]
		self.assertLess(sum(off) / len(off), MEAN)
		self.assertLess(max(off), MOST)
		# a different picture fails: another seed, another picture
		other = [abs(a - b) for a, b in zip(front, self.draw("--set", "samples=1", "--seed", "2"))]
		self.assertGreater(sum(other) / len(other), 3 * MEAN)


if "no EGL" in program.call("--version").stdout:
	sys.exit(77)
unittest.main()
