"""The viewer in browsers: two people view one universe, each from a viewpoint of their own, and one of them changes it.

If OBSIM_PICTURES names a directory, screenshots are kept there.
"""

import os
import signal
import unittest

import browser
import glb
import program
import server

SEEN = "obsim.frames() > 3 && obsim.universe.objects.size > 0"


@unittest.skipUnless(browser.CHROMIUM and browser.DRIVER, "no Chromium with its driver")
class Viewer(server.Case):
	def setUp(self):
		super().setUp()
		self.driver = browser.Driver()
		self.addCleanup(self.driver.end)

	def open(self, token=""):
		b = browser.Browser(self.driver)
		self.addCleanup(b.close)
		b.go(f"http://127.0.0.1:{self.port}/" + (f"#token={token}" if token else ""))
		b.wait(SEEN)
		b.run("obsim.walk.end()")
		return b

	def keep(self, b, name):
		folder = os.environ.get("OBSIM_PICTURES")
		if folder:
			self.still(b)
			b.picture(os.path.join(folder, name))

	def drawn(self, b):
		"""The picture without the page around it, with all requested content."""
		frames = b.run("return obsim.frames()")
		b.wait(f"obsim.frames() > {frames} + 1")
		return b.run("return document.querySelector('#picture').toDataURL()")

	def still(self, b):
		"""The same, once it no longer changes."""
		pictures = [None]
		def again():
			pictures.append(self.drawn(b))
			return pictures[-1] == pictures[-2]
		self.assertTrue(program.wait_until(again))
		return pictures[-1]

	def test_two_people(self):
		self.serve()
		one, other = self.open(), self.open()
		before = other.run("return obsim.universe.objects.size")
		one.key("n")
		one.wait("!document.querySelector('#maker').hidden")
		one.click(700, 420)
		new = other.wait(f"obsim.universe.objects.size > {before} && Math.max(...obsim.universe.objects.keys())")
		self.assertEqual(other.run("return obsim.universe.objects.get(arguments[0]).name", new), "box")
		other.wait(f"obsim.universe.objects.get({new}).motion?.kind === 0") # it has come to rest
		shown = other.run("return obsim.universe.pose(obsim.universe.objects.get(arguments[0])).p", new)
		witness = self.viewer()
		witness.send(do="inspect", id=new)
		witness.until(lambda: "details" in witness.told)
		for a, b in zip(shown, witness.told["details"]["p"]):
			self.assertAlmostEqual(a, b, delta=.01)
		self.keep(one, "created.png")
		self.keep(other, "seen.png")
		one.key("n")
		one.key("t") # and one is thrown
		other.wait(f"obsim.universe.objects.size > {before + 1}")
		for b in one, other:
			self.assertEqual(b.console(), [])
		self.end()

	@unittest.skipUnless(program.MESHES, "built without tinygltf")
	def test_meshes(self):
		"""An object with a mesh is drawn with it, and picked by its collision shape."""
		for name, mesh in ("cube.glb", glb.cube(1, (0, .5, 0))), ("picture.glb", glb.cube(1, (1, 1, 1), picture=glb.QUARTERS)):
			with open(self.path(name), "wb") as f:
				f.write(mesh)
		with open(self.path("scene.lua"), "w") as f:
			f.write("ground {}\ncamera 'main' { eye = { 0, -6, 1 }, target = { 0, 0, 1 } }\n"
				"sphere { radius = .2, at = { 0, 0, 1 }, static = true, colour = '#ff0000', mesh = 'cube.glb', name = 'small' }\n"
				"sphere { radius = .2, at = { 2.5, 0, 1 }, static = true, mesh = 'cube.glb' }\n"
				"sphere { radius = .2, at = { -2.5, 0, 1 }, static = true, mesh = 'picture.glb' }\n")
		self.serve_file(self.path("scene.lua"))
		b = self.open()
		b.wait("obsim.drawing().looks.size === 2 && obsim.frames() > 6")
		# Beyond the spheres: the one's own colour takes precedence over its mesh's, the other shows its mesh's
		seen = b.run("""const from = document.querySelector('#picture'), c = new OffscreenCanvas(from.width, from.height).getContext('2d', { willReadFrequently: true });
			c.drawImage(from, 0, 0);
			const perMetre = from.height / 2 / (Math.tan(arguments[0] / 2) * 5); // at the cubes' faces
			const at = (x, z) => [...c.getImageData(from.width / 2 + x * perMetre, from.height / 2 - (z - 1) * perMetre, 1, 1).data];
			return [[-.8, 1.8], [2.2, 1.8], [-2.9, 1.5], [-2, 1.5], [-2.9, .5], [-2, .5]].map((p) => at(...p));""",
			0.6981317)
		self.assertGreater(seen[0][0], 2 * max(seen[0][1:3]), seen)
		self.assertGreater(seen[1][1], 2 * max(seen[1][0], seen[1][2]), seen)
		for k, (*rgb, _) in enumerate(seen[2:5]): # quarters of the third one's picture: red, green, blue, and grey
			self.assertGreater(rgb[k], 1.5 * max(rgb[:k] + rgb[k + 1:]), seen)
		self.assertLess(max(seen[5][:3]), 1.3 * min(seen[5][:3]), seen)
		self.assertEqual(b.console(), [])
		self.keep(b, "meshes.png")
		self.end()

	def test_frozen(self):
		"""A frozen object is marked, and the page counts and explains it, by default."""
		self.serve("-D", "n=8", "--isolation", "process", "--workers", "objects", "--on-death", "freeze", "--room", "0",
			scene="falling_boxes")
		b, witness = self.open(), self.viewer()
		i = next(i for i, o in witness.objects.items() if not o["static"])
		witness.send(do="inspect", id=i)
		witness.until(lambda: witness.told.get("details", {}).get("id") == i)
		os.kill(witness.told["details"]["pid"], signal.SIGKILL)
		b.wait(f"obsim.universe.objects.get({i}).frozen")
		b.run(f"obsim.pick({i})")
		b.wait("document.querySelector('#details dl').textContent.includes('frozen')")
		b.wait("document.querySelector('#statistics').textContent.includes(', 1 frozen')")
		b.run("obsim.pick(null)")
		self.keep(b, "frozen.png")
		self.assertEqual(b.console(), [])
		self.end(saying="was killed by SIGKILL")

	def test_simulators(self):
		"""Colours and the strip of workers show who simulates what; lines, what the picked object reads."""
		self.serve("-D", "n=8", "--isolation", "process", "--workers", "2", "--duration", "6", scene="falling_boxes")
		b = self.open()
		b.wait("obsim.universe.told > 2")
		b.key("m")
		b.wait("document.querySelectorAll('#strip li').length === 2 && obsim.universe.simulators.size === 8")
		colours = "const s = document.querySelector('#colours'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))"
		b.key(" ")
		b.wait("obsim.universe.paused")
		pictures = []
		for key in ("own", "simulator", "rest"):
			b.run(colours, key)
			pictures.append(self.still(b))
		b.run("obsim.pick([...obsim.universe.simulators.keys()][0])")
		b.wait("document.querySelector('#details dl').textContent.includes('reads')")
		pictures.append(self.still(b))
		self.assertEqual(len(set(pictures)), 4)
		b.key(" ")
		told = b.run("document.querySelector('[data-do=restart]').click(); return obsim.universe.told")
		b.wait(f"obsim.universe.told < {told} - .5")
		b.wait("obsim.universe.told > .5")
		b.run("document.querySelector('[data-do=kill]').click()") # while boxes land
		b.wait("document.querySelector('#notice').textContent.includes('SIGKILL')")
		self.keep(b, "killed.png")
		b.wait("document.querySelector('#notice').textContent.includes('The run has ended')")
		self.assertIn(program.report(program.scene("falling_boxes"), "-D", "n=8", "--duration", "6")["state_hash"],
			b.run("return document.querySelector('#notice').textContent"))
		self.keep(b, "simulators.png")
		self.assertEqual(b.console(), [])
		self.end(saying="was killed by SIGKILL")

	def test_own_times(self):
		"""In a free run the ribbon shows own times: while a simulator stands, others are ahead. It can be killed; time can stand."""
		self.serve("--sync", "free", "-D", "n=8", "--isolation", "process", "--workers", "4", scene="falling_boxes")
		b = self.open()
		b.key("m")
		leads = "[...obsim.universe.simulators.values()].map((s) => s.lead)"
		b.wait(f"obsim.universe.told > .5 && obsim.universe.simulators.size === 8 && Math.max(...{leads}) > 0")
		b.wait("obsim.workers.list.map((w) => w.objects).reduce((a, x) => a + x, 0) === 8") # each worker's own ones
		b.wait("!document.querySelector('#times').hidden && document.querySelectorAll('#times rect').length > 0")
		picked, pid = b.run("const [id, s] = [...obsim.universe.simulators][0]; obsim.pick(id); return [id, obsim.workers.list[s.home].pid]")
		os.kill(pid, signal.SIGSTOP)
		b.wait(f"Math.max(...{leads}) > .2 && obsim.universe.simulators.get({picked}).lead < .05")
		b.run("const s = document.querySelector('#colours'); s.value = 'lag'; s.dispatchEvent(new Event('change'))")
		self.keep(b, "own-times.png")
		os.kill(pid, signal.SIGCONT)
		b.wait(f"Math.max(...{leads}) < .1")
		b.wait("!document.querySelector('[data-do=kill]').hidden && !document.querySelector('[data-do=kill]').disabled")
		b.run("document.querySelector('[data-do=kill]').click()")
		b.wait("document.querySelector('#notice').textContent.includes('It goes on where it had published')")
		b.key(" ")
		b.wait("obsim.universe.paused")
		stood = b.wait("obsim.universe.told")
		b.key(".")
		b.wait(f"obsim.universe.told > {stood} && obsim.universe.told < {stood} + .02")
		b.key(" ")
		b.wait(f"obsim.universe.told > {stood} + .1")
		count = b.run("return obsim.universe.objects.size")
		b.key("t")
		b.wait(f"obsim.universe.objects.size > {count}")
		self.assertEqual(b.console(), [])
		self.end(saying="was killed by SIGKILL")

	def test_hand(self):
		"""A visitor drags a picked box, edits and pushes it; another sees it."""
		with open(self.path("scene.lua"), "w") as f:
			f.write("ground {}\ncamera 'main' { eye = { 0, -6, .5 }, target = { 0, 0, .5 } }\n"
				"box { size = { 1, 1, 1 }, at = { 0, 0, .5 }, name = 'crate', script = [[ function on_message(_, what) self:colour(what) end ]] }\n")
		self.serve_file(self.path("scene.lua"))
		b, witness = self.open(), self.viewer()
		at = "obsim.universe.pose([...obsim.universe.objects.values()].find((o) => o.name === 'crate')).p"
		middle = b.run("const r = document.querySelector('#picture').getBoundingClientRect(); return [r.width / 2, r.height / 2]")
		b.click(*middle)
		b.wait("document.querySelector('#details h2').textContent === 'crate'")
		b.key("o") # all objects, the picked one's plots, and this viewpoint's address
		b.wait("['height', 'energy', 'penetration', 'cpu'].every((name) => !document.querySelector('#plot-' + name).hidden)")
		b.run("const s = document.querySelector('#search'); s.value = 'CRA'; s.dispatchEvent(new Event('input'))")
		self.assertEqual(b.run("return [...document.querySelectorAll('#tree button')].map((x) => x.textContent)"), ["crate"])
		b.run("document.querySelector('#tree button').click(); document.querySelector('[data-do=link]').click()")
		self.assertEqual(b.run("return location.hash"), "#view=0%2C-6%2C0.5%2C0%2C0%2C0.5")
		b.key("o")
		forward = b.run("return obsim.camera.forward")
		b.pointer(("move", *middle), ("down", 0), ("move", middle[0], middle[1] - 150))
		b.wait(f"{at}[2] > 1.2")
		b.pointer(("up", 0))
		b.wait(f"{at}[2] < .51")
		self.assertEqual(b.run("return obsim.camera.forward"), forward)
		b.run("obsim.panel.edit('at', '1 0 .5')")
		b.wait(f"{at}[0] > .9")
		b.run("obsim.panel.edit('attitude', '0 0 2 30')")
		b.wait("Math.abs(obsim.universe.pose([...obsim.universe.objects.values()].find((o) => o.name === 'crate')).q[3] - Math.sin(Math.PI / 12)) < 1e-3")
		b.wait("document.querySelector('#edit [name=attitude]').value === '0 0 1 30'")
		b.run("obsim.panel.edit('attitude', '0 0 0 30')")
		b.wait("document.querySelector('#notice').textContent.includes('an axis and degrees')")
		b.run("const f = document.querySelector('#talk'); f.elements.text.value = '#00ff00'; f.requestSubmit()")
		b.wait("[...obsim.universe.objects.values()].some((o) => o.name === 'crate' && o.colour[1] > .9)")
		b.run("document.querySelector('[data-hold=push]').dispatchEvent(new Event('pointerdown'))")
		b.wait(f"{at}[1] > .3")
		b.run("document.querySelector('[data-hold=push]').dispatchEvent(new Event('pointerup'))")
		i = next(i for i, o in witness.objects.items() if not o["static"])
		witness.send(do="inspect", id=i)
		witness.until(lambda: witness.told.get("details", {}).get("p", [0, 0, 0])[1] > .3)
		self.assertEqual(b.console(), [])
		self.end()

	def test_record(self):
		"""A visitor records what happens by a button: a page that plays it back without the server."""
		self.serve("--isolation", "process", "--workers", "2")
		b = self.open()
		self.assertEqual(b.run("obsim.ask = () => document.querySelector('[data-do=record]').click(); obsim.ask(); return obsim.recorder.on"), True)
		b.wait("obsim.recorder.end > obsim.recorder.begin")
		b.run("obsim.universe.send({ do: 'create', shape: 'sphere', size: [.3, 0, 0], at: [4, 0, 6], mass: 90, name: 'visitor' })")
		b.wait("[...obsim.universe.objects.values()].some((o) => o.name === 'visitor')")
		since = b.run("return obsim.universe.told")
		b.run("obsim.universe.send({ do: 'anew' })") # as a viewer that has lost messages
		b.wait(f"obsim.recorder.end > {since} + .6")
		with open(self.path("session.html"), "w") as f:
			f.write(b.run("obsim.ask(); return obsim.recorder.page"))
		objects = b.run("return obsim.universe.objects.size")
		self.assertEqual(b.console(), [])
		self.end()
		b = browser.Browser(self.driver)
		self.addCleanup(b.close)
		b.go("file://" + self.path("session.html"))
		b.wait(SEEN)
		named = "[...obsim.universe.objects.values()].find((o) => o.name === 'visitor')"
		height = lambda t: b.run(f"obsim.universe.seek(arguments[0]); const o = {named}; return o ? obsim.universe.pose(o).p[2] : null", t)
		begin, end = b.run("obsim.universe.paused = true; return [obsim.universe.begin, obsim.universe.end]")
		self.assertIsNone(height(begin)) # not there yet
		self.assertLess(height(end), 5.5) # it has fallen
		self.assertEqual(b.run("return obsim.universe.objects.size"), objects)
		self.assertGreater(b.run("return obsim.universe.simulators.size"), 0)
		self.assertEqual(b.run("return [obsim.workers.list.length, document.querySelector('#colours [value=worker]').hidden]"), [2, False])
		self.assertIsNone(height(begin))
		self.keep(b, "session.png")
		self.assertEqual(b.console(), [])

	def test_avatar(self):
		"""A visitor's avatar walks by keys, the viewpoint behind it, and pushes a crate, which another visitor sees."""
		with open(self.path("scene.lua"), "w") as f:
			f.write("""ground {}
local n = param("n", 1, { min = 1, max = 9 })
for i = 1, n do box { name = "crate " .. i, size = { 1, 1, 1 }, at = { 3 * i, 0, .5 }, density = 20 } end
camera "main" { eye = { 0, -9, 5 }, target = { 0, 0, .5 } }
camera "behind" { on = "guest", eye = { -4, 0, 2 }, target = { 2, 0, 0 } }
box { avatar = true, name = "guest", size = { .5, .5, .5 }, at = { 0, 0, .25 }, friction = .1, script = [[
function on_message(_, what, x)
	if what == "go" then self.state.x = x end
end
function on_step()
	self:force(600 * (self.state.x or 0), 0, 0)
end]] }
controls { key = "w", label = "Ahead", sends = "go", values = { 1 } }
controls { gamepad = 2, label = "Back", sends = "go", values = { -1 } }
""")
		self.serve_file(self.path("scene.lua"))
		one, other = self.open(), self.open()
		one.wait("obsim.avatar() && obsim.universe.objects.has(obsim.avatar().id) && obsim.camera.goes")
		crate = "obsim.universe.pose([...obsim.universe.objects.values()].find((o) => o.name === 'crate 1')).p[0]"
		own = one.run("return obsim.avatar().id")
		place = f"obsim.universe.pose(obsim.universe.objects.get({own})).p"
		self.assertNotEqual(own, other.wait("obsim.avatar()?.id"))
		eye = one.run("return obsim.camera.eye[0]")
		keys = lambda *actions: one.ask("POST", "/actions", {"actions": [{"type": "key", "id": "keys",
			"actions": [{"type": what, "value": "w"} for what in actions]}]})
		keys("keyDown")
		other.wait(f"{crate} > 3.3")
		keys("keyUp")
		one.wait(f"obsim.camera.eye[0] > {eye} + 1")
		self.assertGreater(other.run(f"return {place}[0]"), 1)
		# a gamepad: a button of the scene, then the stick and the arrow for W, until it is taken away
		pad = lambda stick, *pressed: one.run("navigator.getGamepads = () => [null, arguments[0] && { axes: [0, arguments[0][0]], "
			"buttons: Array.from({ length: 17 }, (_, i) => ({ pressed: arguments[1].includes(i) })) }]", stick and [stick], pressed)
		pad(.01, 2)
		one.wait("[...obsim.offers.held].some((c) => c.gamepad === 2)")
		other.wait(f"{place}[0] < 0")
		pad(-1)
		one.wait("[...obsim.offers.held].map((c) => c.key).join() === 'w'")
		pad(.01, 12)
		one.wait("[...obsim.offers.held].map((c) => c.key).join() === 'w'")
		pad(None)
		one.wait("obsim.offers.held.size === 0")
		self.keep(one, "avatar.png")
		self.keep(other, "avatar-seen.png")
		one.run("const n = document.querySelector('#params input'); n.value = 4; n.dispatchEvent(new Event('change'))")
		for b in one, other: # who is there again
			b.wait("obsim.universe.objects.size === 1 + 4 + 2")
			b.wait("obsim.avatar() && obsim.universe.objects.has(obsim.avatar().id)")
		self.keep(one, "again.png")
		one.run("window.obsim.universe.socket.close()")
		for b in one, other:
			self.assertEqual(b.console(), [])
		self.end()

	def test_viewpoint(self):
		"""Each looks from elsewhere: round it, along, with the head turned."""
		self.serve("--paused")
		one, other = self.open(), self.open()
		eye = lambda b: b.run("return [...obsim.camera.eye, ...obsim.camera.forward]")
		still, places = eye(other), [eye(one)]
		pictures = [self.drawn(one)]
		one.pointer(("move", 500, 300), ("down", 0), ("move", 600, 340), ("up", 0)) # round
		places.append(eye(one))
		pictures.append(self.drawn(one))
		one.pointer(("move", 500, 300), ("down", 2), ("move", 420, 320), ("up", 2)) # along
		places.append(eye(one))
		pictures.append(self.drawn(one))
		one.key("a") # the head
		places.append(eye(one))
		pictures.append(self.drawn(one))
		self.keep(one, "turned.png")
		self.assertEqual(len(set(pictures)), 4, "two pictures are the same")
		move = lambda a, b: max(abs(x - y) for x, y in zip(a, b))
		self.assertGreater(move(places[0], places[1]), .1)
		self.assertLess(move(places[1][3:], places[2][3:]), 1e-9, "to move along is not to turn")
		self.assertGreater(move(places[1][:3], places[2][:3]), .1)
		self.assertLess(move(places[2][:3], places[3][:3]), 1e-9, "to turn the head is not to move")
		self.assertGreater(move(places[2][3:], places[3][3:]), .01)
		self.assertEqual(eye(other), still)
		one.pointer(("move", 500, 300), ("down", 0), ("move", 500, 20), ("up", 0)) # upwards, not under the ground
		self.assertGreater(eye(one)[2], 0)
		for b in one, other:
			self.assertEqual(b.console(), [])
		self.end()

	def test_touch(self):
		"""One finger goes round, two move and come nearer, a tap picks."""
		self.serve("--paused")
		b = self.open()
		look = lambda: b.run("const { range, target, forward } = obsim.camera; return { range, target, forward }")
		first = look()
		b.touch([(500, 300), (560, 320), (620, 340)])
		round_ = look()
		self.assertNotEqual(round_["forward"], first["forward"])
		self.assertEqual((round_["range"], round_["target"]), (first["range"], first["target"]))
		b.touch([(450, 300), (400, 300), (350, 300)], [(550, 300), (600, 300), (650, 300)]) # apart: from 100 to 300 px
		near = look()
		self.assertAlmostEqual(near["range"], round_["range"] / 3, delta=.02 * round_["range"])
		self.assertEqual(near["forward"], round_["forward"])
		b.touch([(350, 300), (350, 340), (350, 380)], [(650, 300), (650, 340), (650, 380)]) # along, as far apart as they are
		along = look()
		self.assertAlmostEqual(along["range"], near["range"], delta=.02 * near["range"])
		self.assertEqual(along["forward"], near["forward"])
		self.assertGreater(max(abs(x - y) for x, y in zip(along["target"], near["target"])), .1)
		angles = lambda: b.run("return [obsim.camera.azimuth, obsim.camera.elevation, obsim.camera.range]")
		before = angles()
		b.touch([(350, 300), (400, 300), (450, 300), (450, 300), (490, 280), (530, 260)], [(650, 300), (600, 300), (550, 300)])
		after = angles() # together; then one goes up, and the other orbits as if it had come alone
		for a, expected in zip(after, (before[0] - 80 * .006, before[1] + 40 * .006, before[2] * 3)):
			self.assertAlmostEqual(a, expected, delta=.02 * abs(expected))
		self.assertTrue(b.run("return document.querySelector('#details').hidden"))
		b.key("v") # the scene's viewpoint, which looks at the stack, beside the panels
		b.touch([(650, 300)])
		b.wait("document.querySelector('#details dl').textContent.includes('mass')")
		self.assertEqual(b.console(), [])
		self.end()

	def test_follows(self):
		"""The viewpoint follows a picked object, and orbits it, until it is moved away."""
		self.serve("-D", "n=8", "--paused", scene="flock")
		b = self.open()
		bird = b.run("return [...obsim.universe.objects.values()].find((o) => o.name === 'bird 3').id")
		where = lambda: b.run("return obsim.universe.pose(obsim.universe.objects.get(arguments[0])).p", bird)
		off = lambda: b.run("const p = obsim.universe.pose(obsim.universe.objects.get(arguments[0])).p, t = obsim.camera.target; "
			"return Math.hypot(...p.map((x, k) => x - t[k]))", bird)
		b.run("obsim.pick(arguments[0])", bird)
		b.wait("document.querySelector('#details dl').textContent.includes('flock/bird.lua')")
		b.click(*b.run("const r = document.querySelector('[data-do=follow]').getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]"))
		began = where()
		b.run("obsim.universe.send({ do: 'step', steps: 60 })")
		b.wait("obsim.universe.time > .98")
		b.wait("obsim.camera.off && Math.hypot(...obsim.camera.off) < 1e-3")
		self.assertGreater(max(abs(x - y) for x, y in zip(where(), began)), 1)
		self.assertLess(off(), 2e-3)
		self.keep(b, "followed.png")
		forward = b.run("return obsim.camera.forward")
		b.pointer(("move", 300, 300), ("down", 0), ("move", 400, 340), ("up", 0)) # round it
		self.assertNotEqual(b.run("return obsim.camera.forward"), forward)
		b.run("obsim.universe.send({ do: 'step', steps: 30 })")
		b.wait("obsim.universe.time > 1.48")
		self.assertLess(off(), 2e-3)
		b.pointer(("move", 300, 300), ("down", 2), ("move", 330, 340), ("up", 2)) # away
		b.wait("document.querySelector('[data-do=follow]').ariaPressed === 'false'")
		still = b.run("return obsim.camera.target")
		b.run("obsim.universe.send({ do: 'step', steps: 30 })")
		b.wait("obsim.universe.time > 1.98")
		self.assertEqual(b.run("return obsim.camera.target"), still)
		self.assertEqual(b.console(), [])
		self.end()

	def test_attends(self):
		"""The first viewpoint goes with the only mover beside boxes at rest, above the ground; a shared one is another's."""
		with open(self.path("scene.lua"), "w") as f:
			f.write("ground {}\ncamera 'main' { from = { -.5, -.8, .17 }, fov = 30 }\nfor i = 0, 5 do box { size = { .5, .5, .5 }, at = { -4 + .7 * i, 0, .25 } } end\n"
				"sphere { name = 'mover', radius = .3, at = { 0, 1, .3 }, velocity = { 2, 0, 0 }, spin = { 0, 2 / .3, 0 } }\n")
		self.serve_file(self.path("scene.lua"), "--paused", "--listen", "127.0.0.1:0")
		b = self.open()
		self.assertNotIn("0 pictures", b.run("return document.querySelector('#speed').textContent"))
		seen = """const c = obsim.camera, o = [...obsim.universe.objects.values()].find((o) => o.name === 'mover'), p = obsim.universe.pose(o).p;
			const way = p.map((x, k) => x - c.eye[k]), far = Math.hypot(...way);
			return { x: p[0], height: c.eye[2], off: Math.acos(way.reduce((s, x, k) => s + x * c.forward[k], 0) / far) };"""
		for second in range(1, 5):
			b.run("obsim.universe.send({ do: 'step', steps: 60 })")
			b.wait(f"obsim.universe.time > {second} - .01")
			self.still(b)
			found = b.run(seen)
			self.assertGreater(found["height"], .1)
			self.assertLess(found["off"], .48) # rad: within the picture
		self.assertGreater(found["x"], 7)
		self.keep(b, "attends.png")
		b.run("obsim.pick([...obsim.universe.objects.values()].find((o) => o.name === 'box#1').id)")
		b.wait("document.querySelector('#details dl').textContent.includes('none: it rests')")
		b.pointer(("move", 480, 300), ("down", 0), ("move", 520, 330), ("up", 0)) # this viewpoint stays
		b.run("document.querySelector('[data-do=link]').click()")
		other = browser.Browser(self.driver)
		self.addCleanup(other.close)
		other.go(b.run("return location.href"))
		other.wait(SEEN)
		eye = "return [...obsim.camera.eye, ...obsim.camera.forward]"
		for x, y in zip(b.run(eye), other.run(eye)):
			self.assertAlmostEqual(x, y, delta=2e-3)
		self.assertEqual(b.console() + other.console(), [])
		self.end()

	def test_rest(self):
		"""A universe at rest is not drawn again while time goes on, and has all pixels; without a GPU, fewer while it moves."""
		with open(self.path("scene.lua"), "w") as f:
			f.write("ground {}\nbox { size = { 1, 1, 1 }, at = { 0, 0, .5 } }\n")
		self.serve_file(self.path("scene.lua"))
		b = self.open()
		b.run("const d = obsim.drawing(), draw = d.draw; window.drawn = 0; d.draw = (...words) => { window.drawn++; draw.apply(d, words); }")
		full = lambda: b.run("const c = document.querySelector('#picture'); return [c.width, c.height, c.clientWidth, c.clientHeight]")
		def stands():
			b.run("window.drawn = 0")
			told = b.run("return obsim.universe.time")
			b.wait(f"obsim.universe.time > {told} + 1")
			return b.run("return window.drawn") == 0
		self.assertTrue(program.wait_until(stands))
		width, height, *client = full()
		self.assertEqual([width, height], client)
		b.key("t")
		b.wait("window.drawn > 3")
		self.assertLessEqual(full()[0], width)
		self.assertEqual(b.console(), [])
		self.end()

	def test_clock(self):
		"""Pause, a step and the pace, by their buttons."""
		self.serve()
		b = self.open()
		button = lambda what: b.run("document.querySelector(`[data-do=${arguments[0]}]`).click()", what)
		button("pause")
		b.wait("obsim.universe.paused")
		told = b.run("return obsim.universe.told")
		button("step")
		b.wait(f"obsim.universe.told > {told}")
		self.assertAlmostEqual(b.run("return obsim.universe.told") - told, 1 / 60, delta=1e-6)
		b.run("const r = document.querySelector('#rate'); r.value = '0.05'; r.dispatchEvent(new Event('change'))")
		b.wait("Math.abs(obsim.universe.rate - .05) < 1e-6")
		button("pause")
		b.wait("!obsim.universe.paused")
		slow = b.run("return [obsim.universe.told, performance.now()]")
		b.wait(f"obsim.universe.told > {slow[0]} + .05")
		passed = b.run("return [obsim.universe.told, performance.now()]")
		self.assertLess((passed[0] - slow[0]) / ((passed[1] - slow[1]) / 1000), .2, "s a second, at a twentieth of the pace")
		self.assertEqual(b.console(), [])
		self.end()

	def test_tools(self):
		self.serve("--paused")
		b = self.open()
		b.key(".")
		b.wait("obsim.universe.told > 0")
		told = b.run("return obsim.universe.told")
		b.key(" ")
		b.wait(f"obsim.universe.told > {told} + .3")
		b.key(" ")
		b.wait("obsim.universe.paused")
		pictures = [self.still(b)]
		b.key("c")
		b.wait("obsim.universe.contacts.length > 0")
		pictures.append(self.still(b))
		b.key("b")
		pictures.append(self.still(b))
		self.assertEqual(len(set(pictures)), 3, "what was laid over the picture is not seen")
		b.run("obsim.pick(1)")
		b.wait("document.querySelector('#details dl').textContent.includes('mass')")
		b.key("?")
		self.assertTrue(b.run("return !document.querySelector('#help').hidden"))
		self.keep(b, "tools.png")
		b.key("\ue00c") # escape closes help first, and then the panel
		self.assertEqual(b.run("return ['help', 'details'].map((id) => document.querySelector('#' + id).hidden)"), [True, False])
		b.key("\ue00c")
		self.assertTrue(b.run("return document.querySelector('#details').hidden"))
		b.run("obsim.pick(1)")
		b.key("\ue017") # delete
		b.wait("!obsim.universe.objects.has(1)")
		self.assertEqual(b.console(), [])
		self.end()

	def test_joints(self):
		with open(self.path("swing.lua"), "w") as f:
			f.write("""ground {} sphere { name = "bob", radius = .2, at = { 1, 0, 2 }, mass = 1 }
				hinge { "bob", name = "eye", at = { 0, 0, 2 }, axis = { 0, 1, 0 }, breaks_at = { force = 20 } }""")
		self.serve_file(self.path("swing.lua"), "--paused", "--listen", "127.0.0.1:0")
		b = self.open()
		without = self.still(b)
		b.key("j")
		b.wait("obsim.universe.joints.length === 1")
		self.assertNotEqual(self.still(b), without)
		self.assertEqual(b.run("return obsim.universe.joints[0].ends.map((e) => e.id)"), [1, 2 ** 32 - 1])
		self.keep(b, "joints.png")
		b.key(" ")
		b.wait("obsim.universe.joints.length === 0") # it breaks
		self.assertEqual(b.console(), [])
		self.end()

	def test_server_comes_back(self):
		self.serve()
		b = self.open()
		port = self.port
		self.end()
		b.wait("!document.querySelector('#notice').hidden")
		self.run_ = self.start_universe(program.scene("cradle"), "--listen", f"127.0.0.1:{port}", command="serve")
		b.wait("document.title.startsWith('Newton')")
		b.wait(SEEN)
		self.end()


if __name__ == "__main__":
	unittest.main()
