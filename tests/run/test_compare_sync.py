"""obsim compare --sync lockstep,free: one page that answers from figures of both."""

import csv
import os
import unittest

import program

SCENE = """
local n = param('n', 3)
scene { duration = 1 }
ground {}
for i = 1, n do box { size = {.5, .5, .5}, at = {random(-.1, .1), 0, .6 * i} } end
"""


class CompareSync(program.Case):
	def scene(self, text=SCENE):
		path = self.path("scene.lua")
		with open(path, "w") as f:
			f.write(text)
		return path

	def test_page(self):
		scene, out = self.scene(), self.path("out")
		words = ["compare", scene, "--sync", "lockstep,free", "--seeds", 1, "--duration", .5, "--out", out]
		done = program.call(*words)
		self.assertEqual(done.returncode, 0, done.stderr)
		self.assertIn("Lockstep kept bodies within", done.stdout)
		with open(os.path.join(out, "report.html")) as f:
			page = f.read()
		for part in "Question", "Recommendation", "Figures", "Method", "Threats to validity", "group, process each", "<b>1 seed</b>":
			self.assertIn(part, page)
		self.assertNotIn("{{", page)
		self.assertEqual([c["name"] for c in program.charts(page)], ["error", "rate", "energy", "cost"])
		with open(os.path.join(out, "results.csv")) as f:
			rows = list(csv.DictReader(f))
		self.assertEqual(len(rows), 22)
		lags = {r["configuration"]: r["latency_mean_s"] for r in rows}
		self.assertGreater(float(lags["own_lag_30ms"]), float(lags["own_lag_3ms"]))
		again = program.call(*words)
		self.assertEqual(again.stdout, done.stdout) # nothing is run again

	def test_sweep(self):
		"""The point nearest to a hundred objects runs all, others a few; three seeds give intervals."""
		out = self.path("out")
		done = program.call("compare", self.scene(), "--sync", "lockstep,free", "--vary", "n=2,3", "--seeds", 3, "--duration", .1,
			"--out", out)
		self.assertEqual(done.returncode, 0, done.stderr)
		with open(os.path.join(out, "results.csv")) as f:
			cases = [r["case"].split(" @")[0] for r in csv.DictReader(f)]
		self.assertEqual((cases.count("scene.lua n=2"), cases.count("scene.lua n=3")), (3 * 4, 3 * 22))
		with open(os.path.join(out, "report.html")) as f:
			page = f.read()
		self.assertRegex(page, r"took [\d.]+ \([\d.]+ to [\d.]+\) times the CPU")
		self.assertLessEqual({"objects-cpu", "objects-error"}, {c["name"] for c in program.charts(page)})

	def test_refusals(self):
		scene = self.scene()
		for words, named in [(["--sync", "free"], "lockstep,free"), (["--sync", "lockstep,free", "--workers", 2], "workers"),
			(["--sync", "lockstep,free", "--repeats", 2], "repeats"), (["--sync", "lockstep,free", "--fresh"], "fresh"),
			(["--sync", "lockstep,free", "--vary", "m=1"], "m"), (["--sync", "lockstep,free", "--seeds", 0], "seeds")]:
			done = program.call("compare", scene, *words)
			self.assertEqual((done.returncode, named in done.stderr), (2, True), done.stderr)
			self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
		done = program.call("compare", self.scene("ground {}"), "--sync", "lockstep,free")
		self.assertEqual((done.returncode, "nothing moves" in done.stderr), (2, True), done.stderr)
		done = program.call("run", scene, "--sync", "lockstep,free")
		self.assertEqual((done.returncode, "obsim compare" in done.stderr), (2, True), done.stderr)


if __name__ == "__main__":
	unittest.main()
