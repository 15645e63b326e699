"""The viewer's page as people see and use it: nothing clipped, nothing over anything else, text that can be read, all controls by
keyboard, the first steps, and a death that is seen. With names of scenes: only whether their panels are clipped or overlap.

If OBSIM_PICTURES names a directory, screenshots of all panels are kept there.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import browser
import program
import server

SIZES = (1280, 720), (390, 844), (1920, 1080)
NAMED = sys.argv[1:]
SCENES = NAMED or sorted(name[:-4] for name in os.listdir(os.environ["SCENES"]) if name.endswith(".lua"))
PICTURES = os.environ.get("OBSIM_PICTURES")
SEEN = "window.obsim && obsim.frames() > 1 && obsim.universe.objects.size > 0 && document.querySelector('#statistics').textContent"

# Elements with text of their own, controls and pictures; the part of their rectangle that the columns show.
LEAVES = """
const card = 'header, #strip, .panel, nav .group, #notice', own = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim());
const name = (e) => `${e.localName}${e.id && '#' + e.id}${e.dataset.do ? ' ' + e.dataset.do : ''} "${e.textContent.trim().slice(0, 30)}"`;
const scrolls = (e) => (({ display, overflowY }) => display !== 'contents' && ['auto', 'scroll'].includes(overflowY))(getComputedStyle(e));
const shown = (e) => {
	let { left, top, right, bottom } = e.getBoundingClientRect();
	for (let p = e.parentElement; p; p = p.parentElement) {
		if (!scrolls(p))
			continue;
		const box = p.getBoundingClientRect();
		[left, top, right, bottom] = [left, Math.max(top, box.top), right, Math.min(bottom, box.bottom)];
	}
	return { left, top, right, bottom };
};
// The sign that covers the end of a column that scrolls.
const sign = (p) => { const s = getComputedStyle(p, '::after'); return s.content !== 'none' && s.position === 'sticky' && Number(s.opacity) > .9 ? parseFloat(s.height) : 0; };
const parts = new Map([...document.querySelectorAll('#page *')].filter((e) => e.checkVisibility()).map((e) => [e, shown(e)]));
const visible = (e) => (({ left, top, right, bottom }) => right - left > 1 && bottom - top > 1)(parts.get(e));
const all = [...parts.keys()].filter(visible), cards = all.filter((e) => e.matches(card));
const leaves = all.filter((e) => e.matches('button, select, input, svg, #strip i, #strip b') || own(e) && !e.closest('svg, select'));
"""

FAULTS = LEAVES + """
const faults = [], [whole] = arguments;
for (const p of [...document.querySelectorAll('#page, #page *')].filter((e) => e.checkVisibility() && scrolls(e))) {
	const below = p.scrollHeight - p.clientHeight - p.scrollTop;
	if (below > 1 && !sign(p))
		faults.push(`hides ${below} px without a sign: ${p.id}`);
	if (below > 1 && whole && p.id !== 'tree')
		faults.push(`hides ${below} px of ${[...p.querySelectorAll('.panel')].filter((e) => e.checkVisibility()).map((e) => e.id)}: ${p.id}`);
}
for (const e of leaves) {
	const box = e.getBoundingClientRect(), text = document.createRange();
	text.selectNodeContents(e);
	const wide = own(e) && !e.matches('select, input') ? text.getBoundingClientRect() : box;
	if (e.matches('input') && e.placeholder && !e.value ? e.scrollWidth > e.clientWidth + 1 : e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0)
		faults.push(`clipped: ${name(e)}: ${e.scrollWidth} of ${e.clientWidth} px`);
	for (let p = e; p && p.id !== 'page'; p = p.parentElement) {
		const room = p.matches(card) || scrolls(p) ? p.getBoundingClientRect() : null;
		if (room && (wide.left < room.left - 1 || wide.right > room.right + 1 || (!scrolls(p) && (wide.top < room.top - 1 || wide.bottom > room.bottom + 1))))
			faults.push(`beyond its ${p.id || p.className || p.localName}: ${name(e)}`);
	}
	const seen = parts.get(e);
	if (seen.left < 0 || seen.right > innerWidth + .5 || seen.top < 0 || seen.bottom > innerHeight + .5)
		faults.push(`out of the window: ${name(e)}`);
}
const over = (list) => list.forEach((a, i) => list.slice(i + 1).forEach((b) => {
	const p = parts.get(a), q = parts.get(b);
	if (Math.min(p.right, q.right) - Math.max(p.left, q.left) > 1 && Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top) > 1 &&
		!a.contains(b) && !b.contains(a))
		faults.push(`${name(a)} over ${name(b)}`);
}));
over(cards);
over(leaves);
return [faults, leaves.filter((e) => e.closest('.panel')).length];
"""

# Opens one panel, or all, with the picked object's fields where they are asked for.
OPEN = """
const [panel, picked] = arguments, { on } = obsim.panel, set = (what, value) => on[what] === value || obsim.panel.ask(what);
for (const what of ['offers', 'simulators', 'objects', 'make', 'help'])
	set(what, what === panel || panel === 'all');
obsim.pick(['details', 'edit', 'all'].includes(panel) ? picked : null);
document.querySelector('#edit').open = panel !== 'details';
"""

# Draws nothing: without a GPU pictures take most of the time, and these tests look at the page around them.
BLIND = "for (const what of ['drawArrays', 'drawElements', 'drawArraysInstanced', 'drawElementsInstanced']) WebGL2RenderingContext.prototype[what] = () => {}"

# Contrast as in WCAG 2.2, 1.4.3, over the lighter and the darker of all pictures.
CONTRAST = LEAVES + """
const parse = (text) => { const [r, g, b, a = 1] = text.match(/[\\d.]+/g).map(Number); return { rgb: [r, g, b], a }; };
const onto = (under, { rgb, a }) => under.map((u, k) => u + a * (rgb[k] - u));
const light = (rgb) => rgb.map((x) => (x /= 255) <= .04045 ? x / 12.92 : ((x + .055) / 1.055) ** 2.4).reduce((s, x, k) => s + x * [.2126, .7152, .0722][k], 0);
const faint = [];
for (const e of leaves.filter((x) => (own(x) || x.matches('select, input:not([type=range])')) && !x.matches(':disabled'))) {
	const grounds = [];
	for (let p = e; p; p = p.parentElement)
		if (p.id === 'page') break; else grounds.unshift(parse(getComputedStyle(p).backgroundColor));
	for (const pseudo of e.placeholder ? [undefined, '::placeholder'] : [undefined])
		for (const picture of [0, 255]) {
			const under = grounds.reduce(onto, [picture, picture, picture]);
			const [a, b] = [light(onto(under, parse(getComputedStyle(e, pseudo).color))), light(under)].sort((x, y) => y - x);
			if ((a + .05) / (b + .05) < 4.5)
				faint.push(`${name(e)}: ${((a + .05) / (b + .05)).toFixed(2)} over ${picture}`);
		}
}
return faint;
"""

# Elements that have text, or may have: those that can be read now, and all of the page as it is sent.
KEY = "const key = (e) => `${e.closest('[id]').id} ${e.localName} ${e.dataset.do ?? e.name ?? ''}`;"
MET = LEAVES + KEY + "return leaves.map(key)"
EVERYTHING = KEY + """return fetch('/').then((answer) => answer.text()).then((text) =>
	[...new DOMParser().parseFromString(text, 'text/html').querySelectorAll('#page *')]
		.filter((e) => !e.matches('svg, div, dl, ol, option, #marks, #marks *') && !e.querySelector('*')).map(key))"""


@unittest.skipUnless(browser.CHROMIUM and browser.DRIVER, "no Chromium with its driver")
class Page(server.Case):
	def setUp(self):
		super().setUp()
		self.driver = browser.Driver()
		self.addCleanup(self.driver.end)

	def window(self):
		b = browser.Browser(self.driver)
		self.addCleanup(b.close)
		if not PICTURES:
			b.devtools("Page.addScriptToEvaluateOnNewDocument", source=BLIND)
		return b

	def open(self, size=SIZES[0], b=None, **media):
		"""A page of just this size, in a window of its own unless one is given, and with preferences of its visitor."""
		b = b or self.window()
		self.emulate(b, size, **media)
		b.go(f"http://127.0.0.1:{self.port}/")
		b.wait(SEEN)
		return b

	def emulate(self, b, size, **media):
		b.devtools("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=size[0] < 500)
		b.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-" + k.replace("_", "-"), "value": v} for k, v in media.items()])

	def keep(self, b, *words):
		if PICTURES:
			b.picture(os.path.join(PICTURES, "-".join(map(str, words)) + ".png"))

	def look(self, b, whole, *words):
		"""Nothing is clipped, covered or over anything else; with whole, nothing has to be scrolled."""
		with self.subTest(" ".join(map(str, words))):
			b.run("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))") # signs follow
			faults, seen = b.run(FAULTS, whole)
			self.assertEqual(faults, [])
			self.assertGreater(seen, 2 if "offers" not in words else -1) # a scene may offer nothing
		self.keep(b, *words)

	def test_panels(self):
		"""All panels of all scenes at three sizes, at a first visit and later: nothing is clipped or over anything else. A panel
		that is open alone, beside the first steps, too, is whole; where several are open, or an object is edited, a column says
		that it scrolls."""
		b = self.window()
		for scene in SCENES:
			self.serve("--workers", "4", scene=scene)
			self.open(b=b)
			b.wait("obsim.workers.list.length === 4 && (obsim.walk.steps.length || obsim.workers.world)")
			picked = b.run("return [...obsim.universe.objects.values()].find((o) => !o.fixed)?.id ?? 0")
			steps, own = b.run("return [obsim.walk.steps.length, obsim.panel.on.offers ? 'offers' : 'none']") # the page opens it itself
			for visit in "first", "later":
				for size in SIZES:
					self.emulate(b, size)
					b.run(OPEN, own, picked)
					b.run("if (arguments[0]) obsim.panel.ask('walk')", visit == "first")
					for step in range(steps if visit == "first" else 0):
						b.run("if (arguments[0]) obsim.walk.next()", step)
						self.look(b, True, scene, *size, visit, "step", step, "offers")
					for panel in "offers", "simulators", "objects", "details", "make", "help", "edit", "all":
						b.run(OPEN, panel, picked)
						if panel in ("details", "edit", "all"):
							b.wait("!document.querySelector('#details').hidden && document.querySelector('#details dl').childElementCount > 0")
						self.look(b, panel not in ("edit", "all"), scene, *size, visit, panel)
				b.run("obsim.walk.end()")
			self.assertEqual(b.console(), [])
			b.go("about:blank") # a page whose server has ended tries again
			self.end()

	def test_opened(self):
		"""A panel that is opened is in sight, whatever else is open."""
		self.serve("--workers", "3", scene="plaza")
		b = self.open()
		b.run("for (const what of ['simulators', 'objects', 'make']) obsim.panel.ask(what); obsim.pick([...obsim.universe.objects.values()].find((o) => !o.fixed).id)")
		b.wait("document.querySelector('#details dl').childElementCount > 4")
		for size in SIZES:
			self.emulate(b, size)
			for what, panel in ("make", "#maker"), ("objects", "#objects"), ("help", "#help"), ("simulators", "#workers"):
				b.run("document.querySelectorAll('#left, #right, #panels').forEach((e) => { e.scrollTop = 0; }); const panel = document.querySelector(arguments[1]); for (let i = panel.hidden ? 1 : 2; i--;) obsim.panel.ask(arguments[0])", what, panel)
				top, nav = b.run("return [document.querySelector(arguments[0]).getBoundingClientRect().top, document.querySelector('nav').getBoundingClientRect().top]", panel)
				self.assertTrue(0 < top < nav - 80, (size, what, top, nav))
		self.end()

	def test_fold(self):
		"""Rows of workers fold into bars where that alone makes the panels below whole, and unfold after."""
		self.serve("--workers", "8", scene="falling_boxes")
		b = self.open()
		b.wait("obsim.workers.list.length === 8")
		height = "document.querySelector('#strip').offsetHeight"
		rows = b.run(f"return {height}")
		for panel, folds in ("objects", True), ("simulators", False), ("all", False), ("objects", True), ("none", False):
			b.run(OPEN, panel, 0)
			b.wait(f"({height} < {rows}) === {'true' if folds else 'false'}")
			self.look(b, panel != "all", panel, "offers")
		self.end()

	def test_colour(self):
		"""The field of a picked object's colour shows it."""
		self.serve("--workers", "2", "-D", "n=1", scene="falling_boxes")
		b = self.open()
		b.run("const box = [...obsim.universe.objects.values()].find((o) => !o.fixed); obsim.pick(box.id)")
		b.wait("document.querySelector('#details dl').childElementCount > 4")
		b.run("const field = document.querySelector('[name=colour]'); field.value = '#336699'; field.dispatchEvent(new Event('change', { bubbles: true })); field.value = '#000000'")
		b.wait("document.querySelector('[name=colour]').value === '#336699'")
		self.end()

	def reads(self, b, met):
		"""Reads the page in both schemes; met: elements that were read, as MET names them."""
		for scheme in "dark", "light":
			for size in SIZES[1], (1280, 4000): # all panels are in sight
				self.emulate(b, size, color_scheme=scheme)
				self.assertEqual(b.run(CONTRAST), [])
				met.update((scheme, name) for name in b.run(MET))
			self.keep(b, "scheme", scheme, len(met))

	def test_reading(self):
		"""Text has a contrast of 4.5 to 1 at least, in the dark and in the light scheme: all that the page can show."""
		met = set()
		with tempfile.TemporaryDirectory(prefix="obsim-page-") as scratch:
			self.serve("--workers", "3", "--checkpoint", os.path.join(scratch, "checkpoint"), scene="plaza")
			b = self.open()
			b.wait("obsim.workers.list.length === 3")
			b.run("for (const what of ['simulators', 'objects', 'make', 'help', 'boxes']) obsim.panel.ask(what); obsim.workers.choose('cost'); obsim.pick([...obsim.universe.objects.values()].find((o) => o.name.startsWith('person')).id)")
			b.wait("document.querySelector('#details dl').childElementCount > 4")
			b.run("document.querySelector('#edit').open = true; obsim.panel.notice('a notice', 0); obsim.workers.hear = () => {}; document.querySelector('#strip li').classList.add('died'); document.querySelector('#strip .rest').textContent = 'and 3 more'")
			self.reads(b, met)
			everything = b.run(EVERYTHING)
			self.end()
			self.serve("--sync", "free", "--isolation", "thread", "--workers", "2", scene="falling_boxes")
			self.open(b=b)
			b.run("obsim.panel.ask('simulators'); obsim.pick([...obsim.universe.objects.values()].find((o) => !o.fixed).id)")
			b.wait("!document.querySelector('#times').hidden && document.querySelector('#details dl').childElementCount > 4")
			self.reads(b, met)
			self.end()
			record = os.path.join(scratch, "record.h5")
			program.report(program.scene("stack"), "--duration", "1", "--record", record)
			self.run_ = program.start("serve", "--replay", record, "--listen", "127.0.0.1:0")
			self.addCleanup(lambda: self.run_.poll() is None and self.run_.kill())
			self.port = int(self.run_.stdout.readline().rstrip("/\n").rsplit(":", 1)[1])
			self.open(b=b)
			self.reads(b, met)
			self.end()
		self.assertEqual({(scheme, name) for name in everything for scheme in ("dark", "light")} - met, set(), "never read")

	def test_keyboard(self):
		"""Each control is reached by Tab, with a focus that is seen, and in sight."""
		self.serve("--isolation", "process", "--workers", "3", scene="plaza")
		b = self.open()
		b.wait("obsim.workers.list.length === 3")
		b.run("for (const what of ['simulators', 'objects', 'make', 'help']) obsim.panel.ask(what); obsim.pick([...obsim.universe.objects.values()].find((o) => !o.fixed).id)")
		b.wait("document.querySelector('#details dl').childElementCount > 4")
		b.run("""document.querySelector('#edit').open = true;
			window.controls = () => [...document.querySelectorAll('canvas, button, select, input, summary')].filter((e) => e.checkVisibility() && !e.disabled);
			window.met = new Map();
			window.nameOf = (e) => `${e.localName} ${e.id || e.dataset.key || e.dataset.do || e.name || e.textContent}`;
			document.addEventListener('focusin', ({ target }) => {
				const { outlineStyle, outlineWidth } = getComputedStyle(target), box = target.getBoundingClientRect();
				met.set(nameOf(target), outlineStyle !== 'none' && parseFloat(outlineWidth) >= 2 && box.top > -1 && box.bottom < innerHeight + 1 && box.right < innerWidth + 1);
			});""")
		for _ in range(b.run("return controls().length") + 10):
			b.key("\ue004")
		self.assertEqual(b.run("return controls().map(nameOf).filter((e) => !met.has(e) && !/^button (sphere|[0-9])/.test(e))"), [], "not reached") # drops come and go
		self.assertEqual(b.run("return [...met].filter(([, seen]) => !seen).map(([e]) => e)"), [], "the focus is not seen")
		self.assertEqual(b.run("return [...document.querySelectorAll('button')].filter((e) => !(e.ariaLabel || /\\w/.test(e.textContent))).map((e) => e.outerHTML)"), [])
		b.run("document.querySelector('[data-hold=push]').focus(); window.sent = []; obsim.universe.send = (c) => sent.push(c.do)")
		b.key(" ")
		self.assertEqual(b.run("return sent.filter((what) => what !== 'pause')"), ["push", "release"])
		self.assertEqual(b.console(), [])
		self.end()

	def test_calm(self):
		"""Where a visitor wants little motion, the viewpoint stands until they move it."""
		self.serve("--paused", scene="falling_boxes")
		calm, other = self.open(reduced_motion="reduce"), self.open(reduced_motion="no-preference")
		eye = lambda b: b.run("return obsim.camera.eye")
		before = eye(calm), eye(other)
		calm.run("obsim.universe.send({ do: 'step', steps: 60 })")
		for b in calm, other:
			b.wait("obsim.universe.time > .99")
		self.assertEqual(eye(calm), before[0])
		other.wait(f"obsim.camera.eye.some((x, k) => Math.abs(x - {before[1]}[k]) > .05)")
		self.end()

	def test_still(self):
		"""A picture that stands has all pixels, and several samples of each: a paused one, the first one, one of objects that rest."""
		still = "shown?.every((x, k) => x === [1280, 720, true, 1][k])"
		spy = """const { prototype } = obsim.drawing().constructor, { draw } = prototype;
			prototype.draw = function (...words) { draw.apply(this, words); window.shown = [this.canvas.width, this.canvas.height, ...words.slice(4)]; };"""
		self.serve("-D", "n=3", "--paused", scene="falling_boxes")
		b = self.open()
		b.wait("(({ multi, canvas }) => multi?.width === 1280 && multi.height === 720 && canvas.width === 1280)(obsim.drawing())")
		b.run(spy)
		b.run("obsim.universe.send({ do: 'resume' })")
		b.wait("window.shown && !shown[2]") # it moves
		b.run("obsim.universe.send({ do: 'pause' })")
		b.wait(still)
		self.assertGreater(b.run("obsim.universe.send({ do: 'resume' }); window.shown = null; return obsim.universe.told"), 0)
		b.wait("[...obsim.universe.objects.values()].every((o) => obsim.universe.rests(o))")
		b.wait(still)
		self.assertFalse(b.run("return obsim.universe.paused"))
		self.assertEqual(b.console(), [])
		self.end()

	def test_sensors(self):
		"""Sensors are drawn apart from what casts shadows; what is not visible is not drawn, and not picked."""
		with open(self.path("scene.lua"), "w") as f:
			f.write("""ground {}
				for k, more in ipairs { {}, { sensor = true }, { visible = false } } do
					local o = { name = "box " .. k, size = { 1, 1, 1 }, at = { 0, 2 - 2 * k, .5 }, static = true }
					for key, value in pairs(more) do o[key] = value end
					box(o)
				end
				camera "main" { eye = { -6, -2, 5 }, target = { 0, -2, 0 } }""")
		self.serve_file(self.path("scene.lua"))
		b = self.open()
		b.run("""const d = obsim.drawing();
			window.drawn = {};
			for (const what of ['drawShadowMap', 'drawColour', 'drawThrough']) {
				const draw = d[what];
				d[what] = (list, ...words) => { draw.call(d, list, ...words); drawn[what] = list.map((b) => b.name).join(); };
			}
			obsim.panel.ask('boxes');""")
		b.wait("drawn.drawThrough !== undefined")
		self.assertEqual(b.run("return drawn"), {"drawShadowMap": "box 1", "drawColour": "box 1", "drawThrough": "box 2"})
		self.assertEqual(b.console(), [])
		self.end()

	def test_cameras(self):
		"""Pictures of a camera on an object come again and again, and are what it sees."""
		with open(self.path("scene.lua"), "w") as f:
			f.write("""ground {}
				box { name = "car", size = { .2, .2, .2 }, at = { 0, 0, 1 }, static = true }
				box { size = { .1, 6, 6 }, at = { 3, -3, 1 }, static = true, colour = "#ff0000" }
				camera { on = "car", name = "eye", at = { .2, 0, 0 }, width = 640, height = 300, rate = 20 }
				camera "main" { eye = { -6, -2, 5 }, target = { 0, -2, 0 } }""")
		self.serve_file(self.path("scene.lua"))
		b = self.open()
		b.wait("document.querySelector('#pictures img')?.naturalWidth > 0")
		self.assertEqual(b.run("""const i = document.querySelector('#pictures img'), canvas = document.createElement('canvas');
			window.first = i.src;
			canvas.width = 320;
			window.sees = () => { // the sky on the left, a red wall on the right
				const c = canvas.getContext('2d', { willReadFrequently: true });
				c.drawImage(i, 0, 0); // nothing, while the next one comes
				const [left, right] = [20, 300].map((x) => c.getImageData(x, 30, 1, 1).data);
				return left[2] > left[0] && right[0] > right[2];
			};
			return [i.naturalWidth, i.naturalHeight]"""), [320, 150])
		b.wait("sees()")
		b.wait("document.querySelector('#pictures img').src !== first")
		self.assertEqual(b.run("return document.querySelector('#pictures figcaption').textContent"), "eye")
		self.assertEqual(b.console(), [])
		self.end()

	def test_visits(self):
		"""The first visit shows four steps, which can be walked or skipped; a later one does not. Panels stay as they were left."""
		self.serve("--isolation", "process", "--workers", "3", scene="falling_boxes")
		b = self.open()
		text = "document.querySelector('#walk p').textContent"
		button = lambda what: b.run("document.querySelector(`[data-do=${arguments[0]}]`).click()", what)
		hidden = lambda: b.run("return document.querySelector('#walk').hidden")
		again = lambda: (b.go("about:blank"), b.go(f"http://127.0.0.1:{self.port}/"), b.wait(SEEN))
		steps = []
		b.wait("!document.querySelector('#walk').hidden")
		keys = []
		while not hidden():
			steps.append(b.run(f"return {text}"))
			keys.append(b.run("return obsim.workers.key"))
			button("next")
		self.assertEqual((len(set(steps)), keys), (4, ["own", "worker", "own", "own"]))
		self.assertEqual(b.run("return [obsim.workers.key, document.querySelectorAll('.shown').length]"), ["own", 0])
		button("objects")
		b.run("document.querySelector('#objects').open = false")
		b.wait("localStorage['obsim.folded']?.includes('objects')")
		again()
		self.assertTrue(hidden())
		self.assertEqual(b.run("const o = document.querySelector('#objects'); return [o.hidden, o.open]"), [False, False])
		button("objects")
		b.run("localStorage.removeItem('obsim.walked')")
		again()
		self.assertFalse(hidden())
		button("skip")
		again()
		self.assertEqual(b.run("return [document.querySelector('#walk').hidden, document.querySelector('#objects').hidden]"), [True, True])
		self.assertEqual(b.console(), [])
		self.end()

	def test_death(self):
		"""A death is seen in the strip and in the picture: the dead one's objects turn pale, and come back. The hash is as without it."""
		self.serve("-D", "n=8", "--isolation", "process", "--workers", "3", "--paused", scene="falling_boxes")
		b = self.open()
		b.run("obsim.universe.send({ do: 'until', value: 1 })")
		b.wait("obsim.workers.list.length === 3 && obsim.universe.told > .9 && obsim.universe.paused && [...obsim.workers.homes.values()].every((w) => w >= 0)")
		self.assertIn("8 simulators in 3 processes: click one, kill one", b.run("return document.querySelector('#idea').textContent"))
		b.run("""const [worker] = obsim.workers.homes.values(), die = obsim.workers.die;
			window.dead = new Set();
			window.home = [...obsim.workers.homes].filter(([, w]) => w === worker).map(([id]) => id);
			obsim.workers.die = (...words) => { die.apply(obsim.workers, words); for (const id of obsim.workers.pale.keys()) dead.add(id); };
			document.querySelectorAll('#strip .kill')[worker].click();""")
		b.wait("document.querySelector('#strip .died')?.textContent.includes('died')")
		self.keep(b, "death")
		dead, home = b.run("obsim.universe.send({ do: 'until', value: 3 }); return [[...dead], home]")
		self.assertEqual(sorted(dead), sorted(home))
		b.wait("!document.querySelector('#strip .died') && [...dead].every((id) => obsim.workers.paleness(id) === 0)")
		b.wait("document.querySelector('#statistics').textContent.includes(', 1 death') && obsim.universe.told > 2.99")
		self.assertIn("hash " + program.report(program.scene("falling_boxes"), "-D", "n=8", "--duration", "3")["state_hash"],
			b.wait("document.querySelector('#statistics').textContent.match(/.*hash.*/)?.[0]"))
		self.assertEqual(b.console(), [])
		self.end(saying="was killed by SIGKILL")

	def test_late(self):
		"""A death is seen though the page hears of it after its simulators have left their homes, as on a busy machine."""
		self.serve("-D", "n=1", "--paused", scene="falling_boxes")
		b = self.open()
		self.assertEqual(b.run("""const w = new obsim.workers.constructor(), at = (...homes) => w.times(new Map(homes.map((home, id) => [id, { home, lead: NaN }])));
			at(0, 1);
			at(-1, -1);
			w.hear([[5, 0, 1, 0, null, 0], [6, 0, 1, 0, null, false]], String, performance.now() / 1000 + .1);
			return [...w.pale.keys()]"""), [0])
		self.end()

	def test_tour(self):
		"""The tour goes to its end: simulators are killed and come back, one is slow, and the hash is the same each time."""
		self.serve(scene="tour")
		b = self.open()
		loaded = b.run("return performance.getEntries().reduce((sum, e) => sum + (e.transferSize ?? 0), 0) + obsim.universe.bytes")
		self.assertLess(loaded, 1e6, "bytes to load")
		told, text = [], "document.querySelector('#walk p').textContent"
		b.wait("obsim.walk.steps.length")
		while not b.run("return document.querySelector('#walk').hidden"):
			b.wait("!obsim.tour.act || obsim.tour.act.done", 900) # the slow one is, on a machine that does other work
			told.append(b.run(f"return {text}"))
			self.keep(b, "tour", len(told))
			b.run("document.querySelector('[data-do=next]').click()")
		self.assertEqual(len(told), 5, told)
		hashes = [line.split("hash at 4 s: ")[1][:16] for line in told[:4]]
		self.assertEqual(len(set(hashes)), 1, told)
		self.assertEqual(hashes[0], program.report(program.scene("tour"), "--duration", "4")["state_hash"])
		self.assertEqual([("the same as before" in line, " 1 death;" in line, " 3 deaths;" in line) for line in told[:4]],
			[(False, False, False), (True, True, False), (True, False, True), (True, False, False)], told)
		self.assertIn("simulated seconds a second", told[3])
		for command in "obsim serve tour --sync free only those near the slow one wait: simulators are up to 200 ms", "mpirun -n 2 obsim run tour --duration 4, ", f"the same hash, {hashes[0]}.":
			self.assertIn(command, told[4]) # the first one is run by test_free_tour
		if shutil.which("mpirun") and "Open MPI" in program.call("--version").stdout:
			ranks = subprocess.run(["mpirun", "-n", "2", program.OBSIM, "run", program.scene("tour"), "--duration", "4", "--json", "-"],
				env=program.RANKS, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=program.PATIENCE, check=True)
			self.assertEqual(json.loads(ranks.stdout)["state_hash"], hashes[0])
		b.wait("!obsim.universe.paused")
		self.assertEqual(b.console(), [])
		self.end(saying="was killed by SIGKILL")

	def test_free_tour(self):
		"""In a free run the tour pauses and kills, too, and only those near wait; simulators are as far ahead as the other tour says."""
		self.serve("--sync", "free", scene="tour")
		b = self.open()
		b.wait("obsim.walk.steps.length === 4")
		b.wait("obsim.tour.act?.done", 900)
		self.assertIn("ms ahead", b.run("return document.querySelector('#walk p').textContent"))
		b.run("document.querySelector('[data-do=next]').click()")
		b.wait("obsim.tour.act?.deaths === 1 && obsim.tour.act.done", 900)
		self.assertIn("1 death; at most ", b.run("return document.querySelector('#walk p').textContent"))
		b.run("document.querySelector('[data-do=next]').click()")
		b.wait("obsim.tour.act?.deaths === 3 && obsim.tour.act.done", 900)
		b.run("document.querySelector('[data-do=next]').click()")
		most = int(re.search(r"up to (\d+) ms ahead", b.run("return document.querySelector('#walk p').textContent"))[1])
		self.assertTrue(0 < most <= 200, most)
		self.assertEqual(b.console(), [])
		self.end(saying="was killed by SIGKILL")


if __name__ == "__main__":
	unittest.main(argv=sys.argv[:1], defaultTest="Page.test_panels" if NAMED else None)
