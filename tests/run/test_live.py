"""obsim compare --live: worlds side by side on one page, at one instant, with the figures of runs of their own."""

import glob
import os
import re
import unittest

import browser
import program
import server
from test_page import BLIND, CONTRAST, FAULTS, SIZES

SCENE, SECONDS = ("-D", "n=20", "--duration", "1.2"), 1.2
FIGURES = "worst_penetration_m", "penetration_max_m"
PICTURES = os.environ.get("OBSIM_PICTURES")

# Notes the figures, instants of all pictures and of all worlds, and who glows.
WATCH = """
Object.assign(window, { heard: [], seen: [], lit: [new Set(), new Set(), new Set()] });
obsim.worlds[0].universe.addEventListener('comparison', (e) => heard.push(e.detail));
const look = () => {
	seen.push(obsim.worlds.map((w) => [w.universe.time, w.universe.told]));
	obsim.worlds.forEach((w, i) => w.bodies(performance.now() / 1000).filter((b) => b.glow).forEach((b) => lit[i].add(b.name)));
	requestAnimationFrame(look);
};
look();
"""


@unittest.skipUnless(browser.CHROMIUM and browser.DRIVER, "no Chromium with its driver")
class Live(program.Case):
	def setUp(self):
		super().setUp()
		self.driver = browser.Driver()
		self.addCleanup(self.driver.end)

	def open(self, *words, worlds=3, **media):
		self.run_ = program.start("compare", program.scene("falling_boxes"), "--live", "--listen", "127.0.0.1:0", *words)
		self.addCleanup(lambda: (self.run_.poll() is None and self.run_.kill(), self.run_.wait(), self.run_.stdout.close(), self.run_.stderr.close()))
		address = re.search(r"http://\S+", self.run_.stdout.readline())[0]
		b = browser.Browser(self.driver)
		self.addCleanup(b.close)
		b.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-" + k.replace("_", "-"), "value": v} for k, v in media.items()])
		if not PICTURES: # see test_page
			b.devtools("Page.addScriptToEvaluateOnNewDocument", source=BLIND)
		b.go(address)
		b.wait(f"window.obsim && obsim.worlds.length === {worlds} && obsim.worlds.every((w) => w.look)")
		return b

	def size(self, b, size):
		b.devtools("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=size[0] < 500)

	def ended(self, b, patience=browser.PATIENCE):
		b.wait(f"obsim.worlds.every((w) => w.universe.ended && w.universe.time > {SECONDS - 1e-6})", patience)

	def end(self, saying=""):
		self.run_.terminate()
		_, err = self.run_.communicate(timeout=program.PATIENCE)
		self.assertEqual(self.run_.returncode, 0)
		self.assertIn(saying, err) if saying else self.assertEqual(err, "")
		self.assertEqual(glob.glob(program.segment(f"obsim-{self.run_.pid}*")), [])

	def figures(self, *words):
		report = program.report(program.scene("falling_boxes"), *SCENE, *words)
		return [report[name] for name in FIGURES]

	def test_play(self):
		"""A fall to its end: at each moment one instant, at the end the overlaps of obsim run; the deep ones of the ODE world glow."""
		b = self.open(*SCENE)
		b.run(WATCH)
		self.ended(b)
		b.wait("heard.at(-1)?.ended && heard.at(-1).worlds[0].deep.length")
		heard, seen, lit = b.run("return [heard, seen, lit.map((names) => [...names])]")
		for message in heard:
			self.assertEqual(len({w["time"] for w in message["worlds"]}), 1, message)
		for picture in seen:
			self.assertEqual(len({shown for shown, _ in picture}), 1, picture)
			self.assertTrue(all(shown <= told + 1e-9 for shown, told in picture), picture)
		worlds = heard[-1]["worlds"]
		self.assertEqual([w["name"] for w in worlds], ["One ODE world", *(f"Simulators in {os.cpu_count()} {what}" for what in ("threads", "processes"))])
		for w, words in zip(worlds, (("--arch", "monolith"), ("--isolation", "thread"), ("--isolation", "process"))):
			self.assertEqual([w["deepest"], w["depth"]], self.figures(*words))
			self.assertGreater(w["cpu"], 0)
		self.assertGreater(len(lit[0]), 5)
		self.assertEqual(lit[1:], [[], []])
		self.assertIn("The end: all at the same instant, 1.20 s", b.run("return document.querySelector('#statistics').textContent"))
		self.assertRegex(b.run("return document.querySelector('#worlds').innerText.replace(/\\s+/g, ' ')"),
			r"One ODE world CPU per object and second [\d,]+ µs deepest overlap so far \d+ mm .* deepest overlap so far 0\.\d+ mm")
		self.assertEqual(b.console(), [])
		self.end()

	def test_time(self):
		"""Visitors pause, step and begin anew in all worlds; a death changes no figure."""
		b = self.open(*SCENE)
		click = lambda what: b.run("document.querySelector(`[data-do=${arguments[0]}]`).click()", what)
		b.wait("obsim.worlds[0].universe.time > 0")
		click("pause")
		b.wait("obsim.worlds.every((w) => w.universe.paused && w.universe.time === w.universe.told)")
		before = b.run("return obsim.worlds[0].universe.told")
		click("step")
		b.wait(f"obsim.worlds.every((w) => w.universe.told > {before} && w.universe.time === w.universe.told)")
		self.assertAlmostEqual(b.run("return obsim.worlds[2].universe.told") - before, 1 / 60)
		b.run("const { universe } = obsim.worlds[2], o = [...universe.objects.values()].find((x) => !x.fixed); universe.send({ do: 'kill', id: o.id, generation: o.generation })")
		self.assertTrue(program.wait_until(lambda: b.run("return obsim.worlds[0].universe.paused")))
		click("pause")
		self.ended(b)
		first = self.last(b)
		self.assertEqual(first, self.figures())
		click("again")
		b.wait("!obsim.worlds[0].universe.ended")
		self.ended(b)
		self.assertEqual(self.last(b), first)
		self.assertEqual(b.console(), [])
		self.end(saying="was killed by SIGKILL")

	def last(self, b):
		"""Overlaps of simulators in processes, at the end."""
		b.run("obsim.worlds[0].universe.addEventListener('comparison', (e) => { window.latest = e.detail; }, { once: true }); window.latest = null")
		b.wait("window.latest?.ended")
		return b.run("const { deepest, depth } = latest.worlds[2]; return [deepest, depth]")

	def test_sync(self):
		"""Lockstep and free running beside each other."""
		b = self.open(*SCENE, "--sync", "lockstep,free", "--workers", "2", worlds=2)
		self.ended(b)
		self.assertEqual(b.run("return [...document.querySelectorAll('#worlds h2')].map((e) => e.textContent)"), ["In lockstep, 2 threads", "Free running, 2 threads"])
		self.assertIn("all at the same instant", b.run("return document.querySelector('#statistics').textContent"))
		self.end()

	def test_reading(self):
		"""Nothing is clipped or over anything else, at three sizes; text is readable in both schemes."""
		for scheme in "dark", "light":
			b = self.open(*SCENE, color_scheme=scheme)
			self.ended(b)
			for size in SIZES:
				self.size(b, size)
				faults, seen = b.run(FAULTS)
				self.assertEqual(faults, [], size)
				self.assertGreater(seen, 12)
				self.assertEqual(b.run(CONTRAST), [], size)
				if PICTURES:
					b.wait("obsim.worlds.every((w) => w.canvas.width === w.canvas.clientWidth)")
					b.picture(os.path.join(PICTURES, f"live-{scheme}-{size[0]}x{size[1]}.png"))
			b.close()
			self.end()


class Refused(program.Case):
	def test_refused(self):
		"""One line says what is wrong; a scene that ODE cannot hold is compared without it."""
		live = program.scene("stack"), "--live"
		for words, saying in ((("--out", "there"), "--out does not go with --live"), (("--vary", "n=1,2"), "--vary does not go"),
				(("--sync", "free"), "expected --sync lockstep,free"), (("--listen", "nowhere"), "expected ADDRESS:PORT"),
				(("-D", "nothing=1"), "unknown parameter"), (("--workers", "0"), "expected 1 to")):
			self.refuse("compare", *live, *words, saying=saying)
		self.refuse("compare", "--live", saying="no scene given: obsim compare --live")
		self.refuse("compare", program.scene("stack"), "--listen", "127.0.0.1:0", saying="add --live")
		arch = program.start("compare", program.scene("arch"), "--live", "--listen", "127.0.0.1:0")
		self.assertIn(", 2 worlds side by side", arch.stdout.readline())
		arch.terminate()
		self.assertIn("without the one ODE world", arch.communicate(timeout=program.PATIENCE)[1])
		self.assertEqual(arch.returncode, 0)


if __name__ == "__main__":
	unittest.main()
