#!/usr/bin/env python3
"""test_charts.py: the script of report pages draws every diagram, however awkward: texts do not overlap, nothing is cut, every number
is finite; a reader can save it. TOOLS: the folder of the browser's module; SCRIPT: chart.js."""

import json
import os
import random
import re
import sys
import tempfile
import unittest
import xml.etree.ElementTree

sys.path.insert(0, os.environ["TOOLS"])
import browser

LONG = ("A title that goes on and on, as titles do when every setting of a run has to be in them: step, substeps, rounds, coupling, "
	"workers, isolation, commit, machine; and then some more words, for good measure, until nobody would expect it to fit on any diagram "
	"whatsoever, which it does not, and so it ends where three lines of it have ended, "
	"Donaudampfschifffahrtselektrizitaetenhauptbetriebswerkbauunterbeamtengesellschaft, amen, amen, amen, amen, amen.")
STRANGE = "a < b & \"c\" > 'd' \t \x01 µ ≤ \U0001f600 </script>"
LABELS = ["1", "2", "4", "8", "16 substeps", "240 Hz"]
TITLES = ["obsim", "ODE QuickStep", "Bullet 3.24, single precision", "the fourth, with a title that is longer than the legend is wide", "", "<&>"]
MOST = sys.float_info.max
WILD = [0, -1, 1e-300, 1e300, MOST, None]


def chart(series, x="log", y="log", marks=(), **more):
	return {"name": "a name", "title": "Cost against error", "subtitle": "H = 1/60 s, commit 1234567", "width": 0, "height": 0, "series": series,
		"marks": list(marks), "x": {"label": "CPU per body and simulated second (µs)", "scale": x}, "y": {"label": "worst penetration (mm)", "scale": y}, **more}


def curves(count, points, seed):
	"""Curves over many decades; every fifth point failed."""
	draw = random.Random(seed)
	made = []
	for i in range(count):
		of = []
		for j in range(points):
			p = {"x": 10 ** (3 * draw.random()), "y": 10 ** (8 * draw.random() - 4), "label": LABELS[j % 6], "failed": j % 5 == 4}
			if j % 3 == 0:
				p |= {"low": p["y"] * .5, "high": p["y"] * 2}
			if p["failed"] and j % 2:
				p["y"] = None
			of.append(p)
		made.append({"title": TITLES[i % 6], "style": i, "line": i % 3 != 2, "hollow": i % 4 == 3, "points": of})
	return made


TARGET, ACROSS = {"at": .5, "label": "target 0.5 mm", "vertical": False, "tinted": True}, {"at": 30, "label": "a vertical one", "vertical": True, "tinted": False}


def scatter(values):
	points = [{"x": x, "y": y, "failed": i % 7 == 0, "label": "x"} | ({"low": -MOST, "high": MOST} if len(values) > 3 and i % 3 == 0 else {})
		for i, (x, y) in enumerate((x, y) for y in values for x in values)]
	return [{"title": "obsim", "style": 0, "line": True, "hollow": False, "points": points}]


def rows(count):
	made = curves(2, min(count, 40), count)
	for i, s in enumerate(made):
		for j, p in enumerate(s["points"]):
			p["y"] = j + .1 * i
			p.pop("low", p.pop("high", None))
	return chart(made, marks=[{"at": 0, "label": "target", "vertical": True, "tinted": True}], height=130 + 42 * count,
		category=[LONG if i % 7 == 3 else "stack of 10" for i in range(count)])


def awkward():
	for count, points in (3, 6), (12, 6), (12, 40), (0, 0), (3, 0):
		yield f"{count} x {points}", chart(curves(count, points, count + points), marks=[TARGET, ACROSS])
	for count in 20, 60, 1:
		yield f"{count} rows", rows(count)
	yield "narrow", chart(curves(8, 6, 1), marks=[TARGET, ACROSS], width=320)
	yield "a guide", chart([*curves(1, 6, 2), {"title": "first order", "style": -1, "line": True, "hollow": False, "points": [{"x": 1, "y": 1}, {"x": 9, "y": 9}]}])
	for scale in "linear", "log", "log2":
		for values in WILD, [None], [7.3], [1, 1 + 1e-12], [5e-324, 2e-310], [-3, 8], [1e-5, 9e-4], [123456, 234567]:
			yield f"{scale} {values}", chart(scatter(values), scale, scale, marks=[TARGET | {"at": -MOST if values is WILD else .5}])
	for text in LONG, STRANGE:
		for width, height in (0, 0), (300, 200), (2000, 300), (1, 1):
			made = curves(5, 6, width)
			for s in made:
				s["title"] = s["points"][2]["label"] = text
			axis = {"label": text, "scale": "log"}
			yield f"texts {width}", chart(made, marks=[TARGET | {"label": text}, ACROSS], width=width, height=height) | {"title": text, "subtitle": text,
				"x": axis, "y": axis}


def page(charts):
	with open(os.environ["SCRIPT"], encoding="utf-8") as f:
		script = f.read()
	figures = "".join(f'<figure><script class="chart" type="application/json">{json.dumps(c).replace("<", chr(92) + "u003c")}</script></figure>\n'
		for c in charts)
	return f'<!DOCTYPE html><meta charset="utf-8"><body style="width:2100px">{figures}<script>{script}</script></body>'


# Boxes of all texts, less the air above and below capitals, and of all shapes, in the frame of their SVG.
MEASURE = """return [...document.querySelectorAll('figure svg')].map(svg => {
	const o = svg.getBoundingClientRect(), box = e => { const b = e.getBoundingClientRect(); return [b.left - o.left, b.top - o.top, b.right - o.left, b.bottom - o.top]; };
	return {size: [o.width, o.height], markup: svg.outerHTML, texts: [...svg.querySelectorAll('text')].map(e => [e.textContent, box(e), !!e.getAttribute('transform')]),
		shapes: [...svg.querySelectorAll('path')].map(e => ({box: box(e), paint: e.getAttribute('class'), hint: e.textContent}))};
});"""


@unittest.skipUnless(browser.CHROMIUM and browser.DRIVER, "no chromium with its driver")
class Charts(unittest.TestCase):
	@classmethod
	def setUpClass(cls):
		cls.dir = tempfile.TemporaryDirectory()
		cls.driver = browser.Driver()

	@classmethod
	def tearDownClass(cls):
		cls.driver.end()
		cls.dir.cleanup()

	def drawn(self, *charts):
		path = os.path.join(self.dir.name, "page.html")
		with open(path, "w", encoding="utf-8") as f:
			f.write(page(charts))
		self.window = browser.Browser(self.driver, 2100, 1000)
		self.window.go("file://" + path)
		made = self.window.run(MEASURE)
		self.assertEqual(self.window.console(), [])
		self.assertEqual(len(made), len(charts))
		return made

	def test_awkward(self):
		names, charts = zip(*awkward())
		for name, one in zip(names, self.drawn(*charts)):
			with self.subTest(name):
				self.assertEqual(re.findall("NaN|Infinity|undefined|null", re.sub("<title>.*?</title>", "", one["markup"])), [])
				xml.etree.ElementTree.fromstring(one["markup"])
				wide, high = one["size"]
				boxes = []
				for text, (x0, y0, x1, y1), turned in one["texts"]:
					air = .15 * ((x1 - x0) if turned else (y1 - y0)) # fonts have room for accents, which no text here has
					box = (x0 + air, y0 + 1, x1 - air, y1 - 1) if turned else (x0 + 1, y0 + air, x1 - 1, y1 - air)
					self.assertTrue(box[0] >= 0 and box[1] >= 0 and box[2] <= wide and box[3] <= high, ("cut", text, box, one["size"]))
					for other, o in boxes:
						self.assertFalse(box[0] < o[2] and o[0] < box[2] and box[1] < o[3] and o[1] < box[3], (text, "covers", other))
					boxes.append((text, box))
				for s in one["shapes"]:
					self.assertTrue(s["box"][0] >= -2 and s["box"][1] >= -2 and s["box"][2] <= wide + 2 and s["box"][3] <= high + 2, s)

	CURVE = {"title": "one", "style": 0, "line": True, "hollow": False, "points": [{"x": 1, "y": 3, "label": "first"}, {"x": 2, "y": 0},
		{"x": 4, "y": None, "failed": True, "label": "fell"}, {"x": 8, "y": None}, {"x": 9, "y": 2, "failed": True}]}

	def hinted(self, one, word):
		return next(s["box"] for s in one["shapes"] if word in s["hint"])

	def test_bands(self):
		"""Failed points and zeros have bands of their own; values that are none, without a failure, are left out."""
		whole = self.CURVE | {"points": self.CURVE["points"][:1]}
		one, plain, zero = self.drawn(chart([self.CURVE]), chart([whole]), chart([self.CURVE], marks=[TARGET | {"at": 0, "label": "target 0"}]))
		texts = [t for t, *_ in one["texts"]]
		self.assertEqual([texts.count(t) for t in ("0", "failed", "first", "fell")], [1, 2, 1, 1]) # the band and the legend
		self.assertEqual(sum(bool(s["hint"]) for s in one["shapes"]), 4)
		self.assertFalse({"0", "failed"} & {t for t, *_ in plain["texts"]})
		# a failed point with a value stays where it is; one without lies above all that have one
		self.assertLess(self.hinted(one, "fell")[3] + 10, self.hinted(one, "first")[1])
		# a target of zero has the whole band of zeros on its good side
		line = next(s["box"] for s in zero["shapes"] if s["paint"] == "s-good")
		self.assertTrue(self.hinted(zero, "first")[3] < line[1] < self.hinted(zero, "2, 0")[1])

	def test_labels(self):
		"""Each point of a falling curve has room for its label."""
		points = [{"x": x, "y": y, "label": t} for x, y, t in ((.09, 1860, "finest"), (.75, 1407, "fine"), (7.9, 501, "coarse"), (23, 366, "coarsest"))]
		one, = self.drawn(chart([self.CURVE | {"points": points}]))
		self.assertLessEqual({p["label"] for p in points}, {t for t, *_ in one["texts"]})

	def test_ticks(self):
		"""1-2-5 steps, decades, powers of two; large and small numbers with an exponent."""
		def labels(scale, *values):
			one, = self.drawn(chart([self.CURVE | {"points": [{"x": v, "y": v} for v in values]}], scale, scale))
			at = {t: box for t, box, _ in one["texts"]}
			return set(at)
		self.assertLessEqual({"0", "2", "4", "6", "8", "10"}, labels("linear", 1, 10))
		self.assertLessEqual({"−0.4", "0", "0.4"}, labels("linear", -.6, .6))
		self.assertLessEqual({"1", "10", "100"}, labels("log", 1, 150))
		self.assertLessEqual({"10−12", "10−6"}, labels("log", 1e-12, 1e-6))
		self.assertLessEqual({"1", "2", "5"}, labels("log", 1, 5))
		self.assertLessEqual({"1", "2", "4", "8", "16"}, labels("log2", 1, 16))
		self.assertLessEqual({"2.0×105"}, labels("linear", 123456, 234567))

	def test_saved(self):
		"""The buttons below a diagram give a file each; what is saved stands by itself."""
		one, = self.drawn(chart([self.CURVE]))
		self.window.run("""window.saved = []; HTMLAnchorElement.prototype.click = function () { saved.push([this.download, this.href.slice(0, 40)]); };
			document.querySelectorAll('.save button').forEach(b => b.click());""")
		self.window.wait("window.saved.length === 2")
		self.assertEqual(sorted(self.window.run("return window.saved")), [["a-name.png", "data:image/png;base64,iVBORw0KGgoAAAANSU"],
			["a-name.svg", "data:image/svg+xml,%3Csvg%20xmlns%3D%22h"]])
		self.assertEqual(one["markup"].count("http"), 1) # the name space


unittest.main()
