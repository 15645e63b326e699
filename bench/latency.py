#!/usr/bin/env python3
"""Time from a visitor's key to the picture of another visitor, in two windows of a headless Chromium on this machine.

bench/latency.py OBSIM [--keys 30] [--size 320x240]

Each key sets a visitor's avatar in motion, in an empty place. The other's page notes when the message of it arrives, and when it
has drawn the first frame in which the avatar has moved by a millimetre. Both pages have the clock of this machine.
"""
import argparse
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "run"))
import browser

SCENE = """scene { title = "Latency", gravity = { 0, 0, 0 } }
camera "main" { eye = { 0, -9, 5 }, target = { 0, 0, .5 } }
box { name = "block", size = { 1, 1, 1 }, at = { 0, 0, -2 }, static = true }
box { avatar = true, name = "guest", size = { .5, .5, .5 }, at = { 0, 0, .25 }, script = [[
function on_message(_, what, x) self:push(x * self:mass(), 0, 0) end
]] }
controls { key = "w", sends = "go", values = { 1 } }
"""
# Notes the arrival of the message that the object moves, and the first drawn frame in which it has moved; a read of a pixel waits
# until that is drawn.
WATCH = """const id = arguments[0], u = obsim.universe, object = () => u.objects.get(id), at = () => u.pose(object()).p[0];
const { gl } = obsim.drawing(), draw = obsim.drawing().draw, hear = u.hear;
const now = () => performance.timeOrigin + performance.now();
let from = at();
u.hear = function (data) {
	hear.call(this, data);
	obsim.told ||= Math.hypot(...object().motion.v ?? []) > .5 ? now() : 0;
};
obsim.drawing().draw = function (...words) {
	draw.apply(this, words);
	if (obsim.told && !obsim.seen && Math.abs(at() - from) > .001) {
		gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
		obsim.seen = now();
	}
};
obsim.arm = () => { from = at(); obsim.seen = obsim.told = 0; };"""
# Returns when the key goes down, by the clock that all pages share.
PRESS = """const now = performance.timeOrigin + performance.now();
document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'w', bubbles: true }));
return now;"""
# Stops the avatar.
STILL = """document.body.dispatchEvent(new KeyboardEvent('keyup', { key: 'w', bubbles: true }));
obsim.universe.send({ do: 'edit', id: obsim.avatar().id, generation: obsim.avatar().generation, velocity: [0, 0, 0] });"""


def main():
	words = argparse.ArgumentParser(description=__doc__.split("\n")[0])
	words.add_argument("obsim")
	words.add_argument("--keys", type=int, default=30)
	words.add_argument("--size", default="320x240", help="of a window, in pixels")
	a = words.parse_args()
	if not (browser.CHROMIUM and browser.DRIVER):
		sys.exit("latency.py needs Chromium with its driver (Debian: chromium-driver)")
	wide, high = map(int, a.size.split("x"))
	with tempfile.TemporaryDirectory() as folder:
		scene = pathlib.Path(folder, "latency.lua")
		scene.write_text(SCENE)
		server = subprocess.Popen([a.obsim, "serve", scene, "--listen", "127.0.0.1:0"], stdout=subprocess.PIPE, text=True)
		driver = browser.Driver()
		try:
			address = re.search(r"http://\S+", next(line for line in server.stdout if "http://" in line))[0]
			one, other = (browser.Browser(driver, wide, high) for _ in range(2))
			for b in one, other:
				b.go(address)
				b.wait("window.obsim && obsim.avatar() && obsim.universe.objects.has(obsim.avatar().id) && obsim.frames() > 3")
			guest = one.run("return obsim.avatar().id")
			other.wait(f"obsim.universe.objects.get({guest})?.motion")
			other.run(WATCH, guest)
			told, seen = [], []
			for _ in range(a.keys):
				one.run(STILL)
				time.sleep(.5)
				other.run("obsim.arm()")
				pressed = one.run(PRESS)
				seen.append(other.wait("obsim.seen") - pressed)
				told.append(other.run("return obsim.told") - pressed)
			before = other.run("return [obsim.frames(), performance.now()]")
			time.sleep(3)
			after = other.run("return [obsim.frames(), performance.now()]")
			frames = 1e3 * (after[0] - before[0]) / (after[1] - before[1])
		finally:
			driver.end()
			server.terminate()
			server.wait()
	print(f"{a.keys} keys, windows of {a.size}, {frames:.0f} frames/s in the other's")
	for what, taken in ("key to the message at the other's page", told), ("key to the other's picture", seen):
		taken.sort()
		most = taken[int(.9 * (a.keys - 1))]
		print(f"{what}: median {statistics.median(taken):.0f} ms, 9 of 10 within {most:.0f}, worst {taken[-1]:.0f}")


if __name__ == "__main__":
	main()
