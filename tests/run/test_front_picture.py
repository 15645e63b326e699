"""The README's first picture is the program's: it is drawn again, smaller and with fewer samples, and both are compared
as thumbnails. Another Mesa draws other edges, but the same picture.
"""

import os
import struct
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


class FrontPicture(program.Case):
	def draw(self, *words):
		raw = self.path("raw")
		program.report(program.scene("falling_boxes"), "--duration", "1.6", "--fps", "1.25", "--size", "320x180", "--raw", raw,
			"--measure", "end", *words)
		with open(raw, "rb") as f:
			data = f.read()[320 * 180 * 3:]
		return thumbnail(320, [data[i:i + 960] for i in range(0, len(data), 960)])

	def test_is_what_is_drawn(self):
		front = thumbnail(*rows_of_png(FRONT))
		off = [abs(a - b) for a, b in zip(front, self.draw("--quality", "fine", "--samples", "8"))]
		self.assertLess(sum(off) / len(off), MEAN)
		self.assertLess(max(off), MOST)
		# a different picture fails: another seed, another picture
		other = [abs(a - b) for a, b in zip(front, self.draw("--samples", "1", "--seed", "2"))]
		self.assertGreater(sum(other) / len(other), 3 * MEAN)


if "no EGL" in program.call("--version").stdout:
	sys.exit(77)
unittest.main()
