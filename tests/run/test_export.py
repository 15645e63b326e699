"""A recorded run in browsers: as one page without a server, and served, to each viewer at a time of its own. They show
the renderer's pictures.

If OBSIM_PICTURES names a directory, screenshots are kept there.
"""

import base64
import gzip
import os
import re
import struct
import unittest

import browser
import glb
import mcap
import program
import server

SCENE = """scene { title = "Some <fall> & come", duration = 2, step = 1 / 60 }
ground {}
camera "main" { eye = { -5, -6, 3.5 }, target = { 0, 0, .6 } }
for i = 0, 11 do
	box { size = { .5, .4, .3 }, at = { i % 3 - 1, .6 * (i // 3) - 1, 1 + .5 * i }, spin = { 2, 1, i - 5 } }
end
sphere { radius = .3, at = { 2.2, -1, 2 }, restitution = .7, colour = "#e4572e", name = "ball",
	script = [[function on_start() self:wake(.6) end function on_wake() self:colour("#f6d743") end]] }
capsule { radius = .15, length = .5, at = { -1.5, -1, 1 }, spin = { 0, 5, 1 }, dies = 1.2 }
cylinder { radius = .25, length = .5, at = { 0, -1.4, 1.5 }, born = .5, spin = { 4, 0, 0 } }
hull { points = { { 0, 0, 0 }, { .7, 0, 0 }, { 0, .6, 0 }, { .3, .1, .6 } }, at = { -2.6, -.5, 1 }, colour = "#7a5195", spin = { 0, 4, 2 } }
"""
PATTERNED = """scene { title = "Patterns", duration = 2, step = 1 / 60 }
ground { pattern = "tiles" }
camera "main" { eye = { -5, -6, 3.5 }, target = { 0, 0, .6 } }
plane { normal = { 0, -1, 0 }, at = { 0, 6, 0 }, pattern = "slabs" }
sphere { radius = .3, at = { 0, 0, 6 } }
material "brick" { colour = "#a5523c", pattern = "bricks" }
box { size = { 4, .2, 1.2 }, at = { 0, 3, .6 }, static = true, material = "brick" }
box { size = { 1.2, .8, .3 }, at = { -3, .6, .15 }, static = true, colour = "#b58b58", pattern = "planks" }
box { size = { .5, .5, .5 }, at = { 2.6, .9, .25 }, colour = "#8e9296", pattern = "checker" }
"""
MESHED = 'sphere { radius = .25, at = { -1.2, -2.6, 1.5 }, velocity = { 0, 1, 0 }, spin = { 3, 1, 0 }, mesh = "cube.glb" }'
TIMES = .4, 49 / 60 + .005, 1.75  # s: in the air, between two steps, at rest
# Tolerances of 255: the mean difference, and the share of pixels that are off by more than FAR. Edges, which the
# ground's grid has most of, lie a share of a pixel apart where browser and renderer have different rasterizers.
MEAN, FAR, FAR_SHARE = 2.5, 40, .02

# Both pictures as the browser decodes them: the mean difference, and the share of pixels that are off by more than FAR.
COMPARE = """const [png, far, done] = arguments, canvas = document.querySelector('#picture');
const pixels = async (source) => {
	const image = await createImageBitmap(await (await fetch(source)).blob()), c = new OffscreenCanvas(image.width, image.height);
	c.getContext('2d').drawImage(image, 0, 0);
	return c.getContext('2d').getImageData(0, 0, image.width, image.height);
};
Promise.all([pixels('data:image/png;base64,' + png), pixels(canvas.toDataURL())]).then(([a, b]) => {
	let sum = 0, off = 0;
	for (let i = 0; i < a.data.length; i += 4) {
		const d = [0, 1, 2].map((k) => Math.abs(a.data[i + k] - b.data[i + k]));
		sum += d[0] + d[1] + d[2];
		off += Math.max(...d) > far;
	}
	done({ same: a.width === b.width && a.height === b.height, mean: sum / (a.data.length / 4 * 3), off: off / (a.data.length / 4) });
}, (error) => done({ error: error.message }));"""


class Case(server.Case):
	def setUp(self):
		super().setUp()
		self.record, scene = self.path("run.h5"), self.path("scene.lua")
		with open(scene, "w") as f:
			f.write(SCENE + (MESHED if program.MESHES else ""))
		with open(self.path("cube.glb"), "wb") as f:
			f.write(glb.cube(.3, (1, .8, 1), picture=glb.QUARTERS, shine=True))
		program.report(scene, "--record", self.record)
		self.scene = scene

	def start_replay(self, *words):
		"""Returns the token, if there is one."""
		self.run_ = program.start("serve", "--replay", self.record, *(words or ("--listen", "127.0.0.1:0")))
		self.addCleanup(lambda: (self.run_.poll() is None and self.run_.kill(), self.run_.wait(), self.run_.stdout.close(),
			self.run_.stderr.close()))
		where, _, token = self.run_.stdout.readline().rsplit(" ", 1)[1].strip().partition("#token=")
		self.port = int(where.rstrip("/").rsplit(":", 1)[1])
		return token

	def export(self):
		page = self.path("page.html")
		done = program.call("export", self.record, page)
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		return page


class Served(Case):
	def test_http(self):
		self.start_replay()
		head, body = self.http("GET / HTTP/1.1\nHost: HOST\nConnection: close")
		self.assertIn(b'<meta name="recording" content="recording">', body)
		head, body = self.http("GET /recording HTTP/1.1\nHost: HOST\nConnection: close")
		self.assertIn("200 OK", head)
		tag = next(line.split(": ")[1] for line in head.split("\r\n") if line.lower().startswith("etag"))
		told = gzip.decompress(body)
		self.assertTrue(told[4:].startswith(b'{"welcome":'))
		head, body = self.http(f"GET /recording HTTP/1.1\nHost: HOST\nIf-None-Match: {tag}\nConnection: close")
		self.assertIn("304", head)
		for path in "/drawing.js", "main.js":
			self.assertNotIn("200 OK", self.http(f"GET {path} HTTP/1.1\nHost: HOST\nConnection: close")[0])
		with self.assertRaises(server.Refused):
			server.Viewer(self.port)
		self.end()

	def test_token(self):
		token = self.start_replay("--listen", "0.0.0.0:0")
		get = lambda path: self.http(f"GET {path} HTTP/1.1\nHost: HOST\nConnection: close")[0].split("\r\n")[0]
		self.assertIn("403", get("/recording"))
		self.assertIn("403", get("/recording?token=" + "0" * len(token)))
		self.assertIn("200", get("/recording?token=" + token))
		self.end()

	def test_misuse(self):
		self.refuse("serve", "--replay", self.record, program.scene("stack"), saying="expected one of them")
		self.refuse("serve", "--replay", self.record, "--paused", saying="--paused: a record is shown as it was run")
		self.refuse("serve", "--replay", self.path("nothing"), saying="No such file or directory")
		self.refuse("export", self.record, saying="export needs a record and a file")
		self.refuse("export", saying="export needs a record and a file")
		self.refuse("export", self.record, "a.html", "b.html", saying="unexpected 'b.html'")
		self.refuse("export", self.record, self.record, saying="would replace the record")
		self.refuse("export", self.scene, "a.html", saying="no HDF5 file")
		for name in "a.mp4", "a.PNG", "a.h5", "a.json", "a.csv", "a.lua":
			self.refuse("export", self.record, name, saying="is the end of the name of")
			self.assertFalse(os.path.exists(self.path(name)))
		for words in ("export", self.record, self.path("page.html"), "--patience", "1e-5"), \
				("serve", "--replay", self.record, "--set", "patience=1e-5"):
			self.refuse(*words, saying="takes more than 1e-05 s of CPU to show it in a browser: --patience")
		self.refuse("export", self.record, self.path("no/a.html"), saying="No such file or directory", code=1)
		self.refuse("export", self.record, "/dev/full", saying="No space left on device", code=1)


class Mcap(Case):
	def test_mcap(self):
		path = self.path("run.mcap")
		done = program.call("export", self.record, path)
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		with open(path, "rb") as f:
			data = f.read()
		records = list(mcap.records(data))
		self.assertEqual([kind for kind, _ in records if kind != 5], [1, 3, 4, 3, 4, 15, 2])
		self.assertEqual(records[-1][1], bytes(20)) # no summary
		messages, numbers, before = mcap.messages(data), {1: 0, 2: 0}, 0
		for kind, content in records:
			if kind == 5:
				channel, number, log, publish = struct.unpack_from("<HIQQ", content)
				self.assertEqual(number, numbers[channel])
				self.assertTrue(before <= log == publish)
				numbers[channel], before = number + 1, log
		entities = [e for _, _, m in messages["/scene"] for e in m["entities"]]
		names = {e["id"]: e["metadata"][0]["value"] for e in entities}
		self.assertIn("ball", names.values())
		for e in entities: # each shape has a body
			self.assertTrue(e["cubes"] or e["spheres"] or e["cylinders"] or e["triangles"], names[e["id"]])
			self.assertEqual(e["frame_id"], "object/" + e["id"])
		self.assertEqual(sum(len(m["deletions"]) for _, _, m in messages["/scene"]), 1) # the capsule dies
		at = {}
		for time, _, m in messages["/poses"]:
			for t in m["transforms"]:
				q = t["rotation"]
				self.assertAlmostEqual(sum(v * v for v in q.values()), 1, 6)
				at.setdefault(t["child_frame_id"].split("/")[1], []).append((time, t["translation"]))
		self.assertEqual(set(at), set(names)) # all that is shown has a place
		ball = next(i for i, name in names.items() if name == "ball")
		for time, p in at[ball]:
			if time < .5: # it falls from 2 m
				self.assertAlmostEqual(p["z"], 2 - .5 * 9.81 * time ** 2, 6)
		self.refuse("export", self.record, path, "--patience", "1e-6", saying="takes more than 1e-06 s of CPU to write", code=1)
		self.refuse("export", self.record, self.path("no/a.mcap"), saying="No such file or directory", code=1)


@unittest.skipUnless(browser.CHROMIUM and browser.DRIVER, "no Chromium with its driver")
class Pages(Case):
	def setUp(self):
		super().setUp()
		self.driver = browser.Driver()
		self.addCleanup(self.driver.end)

	def open(self, url, ready="obsim.frames() > 3"):
		b = browser.Browser(self.driver, 540, 460) # small: without a GPU, drawing takes most of this test's time
		self.addCleanup(b.close)
		b.go(url)
		b.wait(ready)
		return b

	def seek(self, b, time):
		b.run("obsim.universe.send({ do: 'pause' }); obsim.universe.seek(arguments[0])", time)
		frames = b.run("return obsim.frames()")
		b.wait(f"obsim.frames() > {frames} + 1")

	def keep(self, name, data):
		folder = os.environ.get("OBSIM_PICTURES")
		if folder:
			with open(os.path.join(folder, name), "wb") as f:
				f.write(data)

	def test_exported(self):
		"""One file, without a server."""
		b = self.open("file://" + self.export(), "obsim.universe.time > .1")
		self.play(b)
		self.check_pictures(b)
		self.assertEqual(b.console(), [])

	def play(self, b):
		"""It plays, pauses, goes back and on, and shows the state of a picked object at that time."""
		self.assertEqual(b.run("return document.title"), "Some <fall> & come – obsim")
		there = lambda name: b.run("return [...obsim.universe.objects.values()].some((o) => o.name.startsWith(arguments[0]))", name)
		b.key(" ")
		b.wait("obsim.universe.paused")
		for time, capsule, cylinder in (1.5, False, True), (.2, True, False), (.8, True, True), (0, True, False), (2, False, True):
			self.seek(b, time)
			self.assertEqual((there("capsule"), there("cylinder")), (capsule, cylinder), time)
		ball = b.run("return [...obsim.universe.objects.values()].find((o) => o.name === 'ball').id")
		b.run("obsim.pick(arguments[0])", ball)
		self.seek(b, .3)
		b.wait("document.querySelector('#details dl').textContent.includes('mass')")
		shown = b.run("return obsim.universe.pose(obsim.universe.objects.get(arguments[0])).p", ball)
		self.assertAlmostEqual(shown[2], 2 - .5 * 9.81 * .3**2, delta=.3 / 256)  # it flies
		b.wait("document.querySelector('#details dl').textContent.includes('reads0 objects')")
		b.run("obsim.pick([...obsim.universe.objects.values()].find((o) => o.name === 'box#1').id)")
		self.seek(b, 1.9) # in a heap
		b.wait("/reads[1-9]/.test(document.querySelector('#details dl').textContent)")
		b.run("obsim.pick(arguments[0])", ball)
		self.seek(b, .5)
		b.key(".")
		self.assertAlmostEqual(b.run("return obsim.universe.time"), .5 + 1 / 60, places=9)
		b.key(",")
		self.assertAlmostEqual(b.run("return obsim.universe.time"), .5, places=9)
		self.assertEqual(b.run("return document.querySelectorAll('#marks i').length"), 2)
		b.run("const t = document.querySelector('#time'); t.value = 1; t.dispatchEvent(new Event('input'))")
		self.assertEqual(b.run("return obsim.universe.time"), 1)
		b.key("n")  # objects cannot be created here
		self.assertTrue(b.run("return document.querySelector('#maker').hidden"))
		self.seek(b, 1.95)
		b.key(" ")
		b.wait("obsim.universe.paused && obsim.universe.time === obsim.universe.end")
		b.run("obsim.pick(null)")

	def compare(self, b, drawn):
		found = b.ask("POST", "/execute/async", {"script": COMPARE, "args": [base64.b64encode(drawn).decode(), FAR]})
		self.assertTrue(found.get("same"), found)
		return found["mean"], found["off"]

	def draw(self, b, scene, time):
		"""The renderer's picture of a scene at a time, as large as the page's."""
		size = "{}x{}".format(*b.run("const c = document.querySelector('#picture'); return [c.width, c.height]"))
		folder = f"{scene}.{time}"
		done = program.call("run", scene, "--out", folder, "--fps", repr(1 / time), "--size", size, "--duration", "4", "--set", "measure=end")
		self.assertEqual(done.returncode, 0, done.stderr)
		with open(os.path.join(folder, "frame-000001.png"), "rb") as f: # the frame at 1 / fps
			return f.read()

	def test_patterns(self):
		"""Patterns of ground, walls and boxes come with the record, and look as the renderer draws them."""
		patterned, plain = self.path("patterned.lua"), self.path("plain.lua")
		for scene, text in (patterned, PATTERNED), (plain, re.sub('pattern = "[a-z]+"', 'pattern = "plain"', PATTERNED)):
			with open(scene, "w") as f:
				f.write(text)
		self.record = self.path("patterned.h5")
		self.assertEqual(program.report(patterned, "--record", self.record)["state_hash"], program.report(plain)["state_hash"])
		b = self.open("file://" + self.export())
		self.seek(b, TIMES[0])
		mean, off = self.compare(b, self.draw(b, plain, TIMES[0]))
		self.assertTrue(mean > MEAN or off > FAR_SHARE, "the page shows no patterns")
		drawn = self.draw(b, patterned, TIMES[0])
		mean, off = self.compare(b, drawn)
		self.keep("drawn-patterns.png", drawn)
		self.keep("played-patterns.png", base64.b64decode(b.run("return document.querySelector('#picture').toDataURL()").split(",")[1]))
		print(f"patterns: mean difference {mean:.3f} of 255, {100 * off:.3f} % of pixels off by more than {FAR}")
		self.assertLess(mean, MEAN)
		self.assertLess(off, FAR_SHARE)
		self.assertEqual(b.console(), [])

	def check_pictures(self, b):
		"""At three times it shows the run's own picture of that time."""
		drawn = None
		for time in TIMES:
			self.seek(b, time)
			if time == TIMES[1]:
				mean, off = self.compare(b, drawn)
				self.assertTrue(mean > MEAN or off > FAR_SHARE, "pictures of two times are taken for one")
			drawn = self.draw(b, self.scene, time)
			mean, off = self.compare(b, drawn)
			self.keep(f"drawn-{time:.2f}.png", drawn)
			self.keep(f"played-{time:.2f}.png", base64.b64decode(b.run("return document.querySelector('#picture').toDataURL()").split(",")[1]))
			print(f"{time:.3f} s: mean difference {mean:.3f} of 255, {100 * off:.3f} % of pixels off by more than {FAR}")
			self.assertLess(mean, MEAN)
			self.assertLess(off, FAR_SHARE)

	def test_served(self):
		"""Two viewers of one recording, each at a time of its own."""
		self.start_replay()
		one, other = (self.open(f"http://127.0.0.1:{self.port}/") for _ in range(2))
		self.seek(one, .25)
		self.seek(other, 1.5)
		self.assertEqual([b.run("return obsim.universe.time") for b in (one, other)], [.25, 1.5])
		self.assertNotEqual(*(b.run("return document.querySelector('#picture').toDataURL()") for b in (one, other)))
		for b in one, other:
			self.assertEqual(b.console(), [])
		self.end()


if __name__ == "__main__":
	unittest.main()
