#!/usr/bin/env python3
"""Frames that the viewer's page draws in a second, in a headless Chromium without a GPU on this machine, and their CPU.

bench/page.py OBSIM [--size 1280x720] [--rounds 6] [--scene falling_boxes] [-D NAME=VALUE ..]

Each round starts the scene anew and counts the frames that are drawn in two of its seconds, from the first tenth on. CPU is that
of obsim and of each of Chromium's processes, from /proc.
"""
import argparse
import os
import pathlib
import re
import statistics
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "run"))
import browser

# Counts the frames that are drawn from one of the scene's times to another.
COUNT = """const d = obsim.drawing(), draw = d.draw, [from, to] = arguments;
let last = 0;
d.draw = (...words) => {
	draw.apply(d, words);
	const { told } = obsim.universe, now = performance.now();
	if (told < last) // begun anew
		window.round = { frames: 0 };
	last = told;
	if (told < from)
		return;
	if (window.round && told < to)
		Object.assign(window.round, { began: window.round.began ?? now, frames: window.round.frames + 1, ended: now });
	else if (window.round)
		window.round.done = true;
}"""
FROM, TO = .1, 2.1 # s
TICK = 1 / os.sysconf("SC_CLK_TCK") # s


def cpu(server):
	"""CPU, s, of obsim and of Chromium's processes below this one, by kind."""
	parents, used, kinds = {}, {}, {}
	for entry in os.listdir("/proc"):
		try:
			words = pathlib.Path("/proc", entry, "stat").read_text().rsplit(")", 1)[1].split() if entry.isdigit() else None
			line = pathlib.Path("/proc", entry, "cmdline").read_bytes().decode() if words else ""
		except OSError:
			continue
		if words:
			parents[int(entry)], used[int(entry)], kinds[int(entry)] = int(words[1]), TICK * (int(words[11]) + int(words[12])), line
	out = dict.fromkeys(("obsim", "gpu-process", "renderer", "rest"), 0.)
	for pid in parents:
		above = pid
		while above in parents and above not in (server, os.getpid()):
			above = parents[above]
		if above == server:
			out["obsim"] += used[pid]
		elif above == os.getpid() and pid != above:
			kind = re.search(r"--type=([a-z-]+)", kinds[pid])
			out[kind[1] if kind and kind[1] in out else "rest"] += used[pid]
	return out


def main():
	words = argparse.ArgumentParser(description=__doc__.split("\n")[0])
	words.add_argument("obsim")
	words.add_argument("--size", default="1280x720", help="of the picture, in pixels")
	words.add_argument("--rounds", type=int, default=6)
	words.add_argument("--scene", default="falling_boxes")
	words.add_argument("-D", dest="params", action="append", default=[])
	a = words.parse_args()
	if not (browser.CHROMIUM and browser.DRIVER):
		sys.exit("page.py needs Chromium with its driver (Debian: chromium-driver)")
	wide, high = map(int, a.size.split("x"))
	params = [word for p in a.params for word in ("-D", p)]
	server = subprocess.Popen([a.obsim, "serve", a.scene, *params, "--listen", "127.0.0.1:0"], stdout=subprocess.PIPE, text=True)
	driver = browser.Driver()
	rates, spent = [], []
	try:
		address = re.search(r"http://\S+", next(line for line in server.stdout if "http://" in line))[0]
		b = browser.Browser(driver, wide, high)
		high += high - b.run("return innerHeight") # a window's size counts its frame
		b.ask("POST", "/window/rect", {"width": wide, "height": high})
		b.go(address)
		b.wait("window.obsim && obsim.frames() > 3 && obsim.universe.objects.size > 0")
		b.run(COUNT, FROM, TO)
		for _ in range(a.rounds):
			b.run("obsim.universe.send({ do: 'restart' }); window.round = null")
			b.wait("window.round?.began")
			begin, used = b.run("return window.round.frames"), cpu(server.pid)
			time.sleep(.6 * (TO - FROM))
			frames, spent_now = b.run("return window.round.frames") - begin, cpu(server.pid)
			spent.append({kind: 1e3 * (t - used[kind]) / max(1, frames) for kind, t in spent_now.items()})
			round_ = b.wait("window.round.done && window.round")
			rates.append(1e3 * (round_["frames"] - 1) / (round_["ended"] - round_["began"]))
			pixels = b.run("return [obsim.drawing().canvas.width, obsim.drawing().canvas.height]")
			print(f"{rates[-1]:.1f} frames/s, {pixels[0]} x {pixels[1]} pixels; ms of CPU a frame: " + ", ".join(f"{kind} {t:.1f}" for kind, t in spent[-1].items()), flush=True)
	finally:
		driver.end()
		server.terminate()
		server.wait()
	print(f"{a.rounds} rounds, {a.size}: median {statistics.median(rates):.1f} frames/s, {statistics.median(sum(s.values()) for s in spent):.0f} ms of CPU a frame")


if __name__ == "__main__":
	main()
