"""The viewer in browsers: two people look at one universe, each from a viewpoint of their own, and one of them changes it.

Where OBSIM_PICTURES names a directory, what they saw is kept there.
"""

import os
import signal
import unittest

import browser
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
		return b

	def keep(self, b, name):
		folder = os.environ.get("OBSIM_PICTURES")
		return b.picture(os.path.join(folder, name) if folder else None)

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

	def test_frozen(self):
		"""What is frozen is shown in a frame of its own, without being asked for, and says so."""
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

	def test_viewpoint(self):
		"""Each looks from elsewhere: round it, along, with the head turned."""
		self.serve("--paused")
		one, other = self.open(), self.open()
		eye = lambda b: b.run("return [...obsim.camera.eye, ...obsim.camera.forward]")
		still, places = eye(other), [eye(one)]
		pictures = [one.picture()]
		one.pointer(("move", 500, 300), ("down", 0), ("move", 600, 340), ("up", 0)) # round
		places.append(eye(one))
		pictures.append(one.picture())
		one.pointer(("move", 500, 300), ("down", 2), ("move", 420, 320), ("up", 2)) # along
		places.append(eye(one))
		pictures.append(one.picture())
		one.key("a") # the head
		places.append(eye(one))
		pictures.append(self.keep(one, "turned.png"))
		self.assertEqual(len(set(pictures)), 4, "two pictures are the same")
		move = lambda a, b: max(abs(x - y) for x, y in zip(a, b))
		self.assertGreater(move(places[0], places[1]), .1)
		self.assertLess(move(places[1][3:], places[2][3:]), 1e-9, "to move along is not to turn")
		self.assertGreater(move(places[1][:3], places[2][:3]), .1)
		self.assertLess(move(places[2][:3], places[3][:3]), 1e-9, "to turn the head is not to move")
		self.assertGreater(move(places[2][3:], places[3][3:]), .01)
		self.assertEqual(eye(other), still)
		for b in one, other:
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
		b.key("c")
		b.wait("obsim.universe.contacts.length > 0")
		b.key("b")
		b.run("obsim.pick(1)")
		b.wait("document.querySelector('#details dl').textContent.includes('mass')")
		b.key("?")
		self.assertTrue(b.run("return !document.querySelector('#help').hidden"))
		self.keep(b, "tools.png")
		b.key("\ue017") # delete
		b.wait("!obsim.universe.objects.has(1)")
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
