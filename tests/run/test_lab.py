"""The lab as a program: its files, its resumption, and its output for scripts."""

import csv
import json
import os
import re
import signal
import subprocess
import time
import unittest

import program

SMALL = ["lab", "projectile", "head-on", "--engines", "obsim,ode-quick", "--sweep", "substeps=1,4"]
NUMBERS = ["cpu_s", "wall_s", "bodies_times_simulated_s", "cpu_s_per_body_and_simulated_s", "step_s", "substeps", "lag"]


class Lab(program.Case):
	def lab(self, *words, code=0):
		done = program.call(*words, "--out", self.path("out"))
		self.assertEqual(done.returncode, code, done.stderr)
		return done

	def rows(self):
		with open(self.path("out/results.csv"), newline="") as f:
			return list(csv.DictReader(f, strict=True))

	def start(self, *words, **more):
		run = subprocess.Popen([program.OBSIM, *words, "--out", self.path("out")], stdout=subprocess.PIPE, text=True,
			**{"stderr": subprocess.PIPE, **more})
		self.addCleanup(lambda: (run.poll() is None and run.kill(), run.wait(), run.stdout.close(),
			run.stderr and run.stderr.close()))
		return run

	def test_usage(self):
		self.refuse("lab", "stack-01", saying="no case 'stack-01': did you mean stack-10?")
		self.refuse("lab", "stak", saying="no case 'stak': did you mean stack-10, or all that begin with 'stack'?")
		self.refuse("lab", "zebra", saying="no case 'zebra': obsim lab --list shows all")
		self.refuse("lab", "99", saying="no case '99'")
		self.refuse("lab", "--engines", "obsim,oed-quick", saying="no engine 'oed-quick': did you mean ode-quick?")
		self.refuse("lab", "--engines", "zebra", saying="only: obsim, ")
		self.refuse("lab", "--sweep", "substeps=0", saying="whole number from 1")
		self.refuse("lab", "--sweep", "tolerance=2", saying="above 0, at most 1 m")
		self.refuse("lab", "--repeats", "99", saying="expected 1 to 15")
		self.refuse("lab", "--limit", "0", saying="more than 0")
		self.refuse("lab", "--quick", "pile", saying="'pile'")
		self.refuse("lab", "--engines", "ode-quick", "--check", saying="--check is about obsim")
		self.refuse("lab", "--audit", "--sweep", "none", saying="--audit is a choice of settings")
		self.refuse("lab", "--list", "--json", saying="leave --json away")
		self.refuse("lab", "--lst", saying="did you mean --list?")
		self.assertEqual(os.listdir(self.directory.name), [])

	def own(self, text, name="own.lua"):
		with open(self.path(name), "w") as f:
			f.write(text)
		return self.path(name)

	def test_own_case(self):
		path = self.own("""
			local this = case { runs = 2, variants = { { name = "near", x = 0 }, { name = "far", x = 100 } } }
			scene { title = "A stone, " .. this.name, duration = .5 }
			local stone = box { size = { 1, 1, 1 }, at = { this.x, 0, 9 }, velocity = { 1 + this.run, 0, 0 } }
			expect { "error", below = 1e-9, unit = "m", worst = true, function(run)
				return (run[stone].moved - vector((1 + this.run) * run.time, 0, -9.81 / 2 * run.time ^ 2)):norm()
			end }
			expect { "runs", mean = true, function() return this.run end }
		""")
		done = self.lab("lab", path, "--engines", "obsim,ode-quick", "--sweep", "none", "--json")
		self.assertEqual(done.stderr, "")
		told = {(x["case"], x["engine"]): x["figures"] for x in json.loads(done.stdout)["results"]}
		self.assertEqual(sorted(told), [("far", "obsim"), ("far", "ode-quick"), ("near", "obsim"), ("near", "ode-quick")])
		for case in "near", "far":
			self.assertLess(told[case, "obsim"][0]["value"], 1e-9)
			self.assertGreater(told[case, "ode-quick"][0]["value"], 1e-3)
			self.assertEqual(told[case, "obsim"][1]["value"], .5)
		self.assertEqual({row["case"] for row in self.rows()}, {"near", "far"})
		# another text of the same name is measured anew
		with open(path, "a") as f:
			f.write("expect { 'one', function() return 1 end }\n")
		again = self.lab("lab", path, "--engines", "obsim", "--sweep", "none", "--json")
		self.assertEqual([len(x["figures"]) for x in json.loads(again.stdout)["results"]], [3, 3])

	def test_run_and_lab_agree(self):
		"""A case of the lab, run as any scene and found by its name, has the same figures to the last bit."""
		told = json.loads(self.lab("lab", "sliding", "apexes", "slider-crank", "--engines", "obsim", "--sweep", "none", "--json").stdout)
		figures = {x["case"]: [f["value"] for f in x["figures"]] for x in told["results"]}
		for case, scene, *more in (("sliding", "lab/sliding"), ("apexes", "scenes/lab/bounces.lua", "-D", "variant=apexes"),
				("slider-crank", "lab/linkages", "-D", "variant=slider-crank")):
			report = program.report(scene, *more, "--set", "sleeping=off", "--strict", cwd=self.directory.name)
			self.assertEqual([x["value"] for x in report["expectations"]], figures[case])

	def test_wrong_cases(self):
		ball = 'sphere { name = "ball", radius = 1 }\n'
		expect = 'expect { "x", worst = true, function(run) return run["ball"].at.x end }\n'
		self.refuse("lab", self.own(ball), saying="own.lua:1: expected what must come of it: expect {")
		self.refuse("lab", self.own('sphere { name = "ball", radius = 1, dies = 1 }\n' + expect),
			saying='own.lua: object "ball": the engines of the lab have no births or deaths')
		self.refuse("lab", self.own('sphere { name = "ball", radius = 1, group = 1 }\n' + expect), saying="have no groups")
		self.refuse("lab", self.own(ball + 'expect { "x", worst = true, function(run) return run["bal"].at.x end }'),
			saying='own.lua:2: run: no object "bal", did you mean "ball"?')
		self.refuse("lab", self.own(ball + expect, "projectile.lua"), saying='there is a case "projectile" already')
		self.refuse("lab", self.path("none.lua"), saying="none.lua: cannot read the scene")
		late = self.own(ball + 'expect { "x", function(run) return run["ball"].place.x end }', "late.lua")
		done = self.lab("lab", late, "--engines", "obsim", "--sweep", "none", code=2)
		self.assertIn('late.lua:2: run: an object has no "place"', done.stderr)

	def test_list(self):
		done = program.call("lab", "--list", cwd=self.directory.name)
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		for name in "projectile", "stack-40", "pile", "lag":
			self.assertRegex(done.stdout, rf"(?m)^ *\d+  {name} ")
		some = program.call("lab", "--list", "14", "*-1000", cwd=self.directory.name).stdout
		self.assertIn("stack-20", some)
		self.assertIn("heavy-1000", some)
		self.assertNotIn("pile", some)
		names = re.findall(r"(?m)^ *\d+  (\S+) +\* ", done.stdout)
		quick = program.call("lab", "--list", "--quick", cwd=self.directory.name).stdout
		self.assertEqual(re.findall(r"(?m)^ *\d+  (\S+) ", quick), names)
		self.assertEqual(os.listdir(self.directory.name), [])

	def test_results(self):
		done = self.lab(*SMALL, "--json")
		told = json.loads(done.stdout)
		rows = self.rows()
		self.assertEqual(done.stderr, "")
		# obsim: 8, 1, 4 substeps; ODE: 1, 4
		self.assertEqual([(r["case"], r["engine"], r["substeps"]) for r in rows],
			[(case, engine, n) for case in ("projectile", "head-on") for engine, n in
				[("obsim", "1"), ("obsim", "4"), ("obsim", "8"), ("ode-quick", "1"), ("ode-quick", "4")]])
		self.assertEqual(len(told["results"]), len(rows))
		for row, one in zip(rows, told["results"]):
			self.assertEqual((row["case"], row["engine"], row["reason"]), (one["case"], one["engine"], one["failed"] or ""))
			for name in NUMBERS:
				value = one[name] if name in one else one["settings"][name]
				self.assertEqual(float(row[name] or "nan"), value, name)
			for i, figure in enumerate(one["figures"], 1):
				self.assertIn(f"{i} {figure['name']} ({figure['unit']}", row["figures"])
				value = float(row[f"figure{i}"])
				self.assertEqual(figure["value"], value if abs(value) < 1e300 else None)
				if figure["target"] is not None and not one["failed"]:
					self.assertEqual(figure["met"], value <= figure["target"])
			self.assertEqual(row["figure8"], "")
			self.assertEqual((row["machine"], row["commit"]), (told["machine"], told["commit"]))
		self.assertLessEqual(float(rows[0]["figure1"]), 1e-12)
		self.assertGreater(float(rows[3]["figure1"]), 1e-3) # ODE's projectile
		for name in "report.html", "rows.md", "equal.md", "equal.csv":
			self.assertTrue(os.path.isfile(self.path("out/" + name)), name)
		with open(self.path("out/report.html")) as f:
			self.assertLessEqual({"projectile", "head-on"}, {c["name"] for c in program.charts(f.read())})
		self.assertEqual([name for name in os.listdir(self.path("out")) if name.endswith(".new")], [])

	def test_tables(self):
		said = self.lab("lab", "heavy-1000", "--engines", "obsim,ode-quick", "--sweep", "none").stdout
		self.assertRegex(said, r"(?m)^Row +Case +Figure +obsim +Target")
		self.assertRegex(said, r"(?m)^ *15  1000 : 1")
		self.assertRegex(said, r"(?m)^Case +at an error of +obsim +ode-quick$")
		with open(self.path("out/rows.md")) as f:
			lines = f.read().splitlines()
		self.assertTrue(all(line.startswith("| ") and line.endswith(" |") for line in lines))
		self.assertEqual(len({line.replace("\\|", "").count("|") for line in lines}), 1)

	def test_audit(self):
		said = self.lab("lab", "apexes", "head-on", "--audit").stdout
		self.assertRegex(said, r"(?m)^Row +Case +momentum .*\n +2  Head-on pair( +\S+){3}  kept$")
		self.assertRegex(said, r"(?m)^Row +Case +10 mm +1 mm .* 256 +order")
		self.assertRegex(said, r"(?m)^ +5  Heights of a ball")
		self.assertEqual({r["engine"] for r in self.rows()}, {"obsim"})
		self.assertEqual(len(self.rows()), 2 * (1 + 4 + 7)) # as it comes, by tolerance, by substeps
		with open(self.path("out/audit.md")) as f:
			self.assertIn("| Heights of a ball, e = .8 |", f.read())

	def test_goes_on(self):
		self.lab(*SMALL)
		first = self.rows()
		self.assertEqual(self.lab(*SMALL).stderr, "")
		self.assertEqual(self.rows(), first)
		self.lab("lab", "projectile", "--engines", "obsim", "--sweep", "substeps=1,2")
		more = self.rows()
		self.assertEqual([r for r in more if r["substeps"] != "2"], first)
		self.assertEqual(len(more), len(first) + 1)
		self.lab(*SMALL, "--repeats", "3")
		again = self.rows()
		self.assertEqual([r for r in again if r["repeat"] == "0"], more)
		for one in more:
			same = [r for r in again if (r["case"], r["configuration"]) == (one["case"], one["configuration"])]
			self.assertEqual([r["repeat"] for r in same], ["0"] if one["substeps"] == "2" else ["0", "1", "2"])
		told = json.loads(self.lab(*SMALL, "--repeats", "3", "--json").stdout)["results"]
		times = sorted(float(r["cpu_s"]) for r in again if (r["case"], r["engine"], r["substeps"]) == ("head-on", "ode-quick", "4"))
		self.assertEqual([(r["repeats"], r["cpu_s"]) for r in told][-1], (3, times[1]))
		self.lab("lab", "projectile", "--engines", "obsim", "--sweep", "none", "--fresh")
		fresh = self.rows()
		usual = [r for r in fresh if (r["case"], r["engine"], r["substeps"]) == ("projectile", "obsim", "8")]
		self.assertEqual(len(usual), 1)
		self.assertEqual([r for r in fresh if r not in usual], [r for r in again if r["configuration"] !=
			usual[0]["configuration"] or r["case"] != "projectile"])

	def test_other_program(self):
		self.lab("lab", "projectile", "--engines", "obsim", "--sweep", "none")
		with open(self.path("out/results.csv"), newline="") as f:
			text = f.read()
		commit = self.rows()[0]["commit"]
		for number, other in enumerate([text.replace(commit, "0123456789ab"), "stuff", ""], 1):
			with open(self.path("out/results.csv"), "w", newline="") as f:
				f.write(other)
			said = self.lab("lab", "projectile", "--engines", "obsim", "--sweep", "none").stderr
			self.assertIn(f"results-{number}.csv", said)
			with open(self.path(f"out/results-{number}.csv"), newline="") as f:
				self.assertEqual(f.read(), other)
			self.assertEqual([r["commit"] for r in self.rows()], [commit])

	def test_check(self):
		self.lab("lab", "projectile", "--engines", "obsim,ode-quick", "--sweep", "none", "--check")
		# a run out of time misses its targets
		words = ["lab", "stack-40", "--engines", "obsim", "--sweep", "none", "--check", "--limit"]
		done = self.lab(*words, ".01", code=3)
		self.assertIn("obsim: 3 targets missed", done.stderr)
		self.assertIn("MISSED: ran longer than", done.stdout)
		late = self.rows()[-1]
		self.assertRegex(late["reason"], r"ran longer than (0.01 s of CPU|0.04 s)$")
		self.assertEqual((late["failure"], late["figure1"], late["bodies_times_simulated_s"]), ("time", "", ""))
		self.assertEqual(late["cpu_s_per_body_and_simulated_s"], "")
		self.lab(*words, ".005", code=3)
		self.assertEqual(self.rows()[-1], late) # a lower limit is no reason to try again
		self.lab(*words, ".02", code=3)
		self.assertRegex(self.rows()[-1]["reason"], r"ran longer than (0.02 s of CPU|0.08 s)$")

	def test_quick(self):
		"""--quick tests the usual settings, beside one other engine, in a short time."""
		self.lab("lab", "--quick", "--limit", ".001")
		rows = self.rows()
		self.assertEqual({r["engine"] for r in rows}, {"obsim", "obsim-lag", "ode-quick"})
		self.assertEqual(len({(r["case"], r["engine"]) for r in rows if r["engine"] != "obsim-lag"}),
			len([r for r in rows if r["engine"] != "obsim-lag"]))

	def test_interrupted(self):
		for number in signal.SIGINT, signal.SIGTERM, signal.SIGHUP:
			with self.subTest(number=number):
				run = self.start("lab", "projectile", "stack-40", "--engines", "obsim", "--sweep", "substeps=1024", "--fresh")
				self.assertTrue(program.wait_until(lambda: os.path.exists(self.path("out/results.csv")), program.PATIENCE))
				time.sleep(.3)
				below = program.processes(run.pid)
				run.send_signal(number)
				self.assertEqual(run.wait(program.PATIENCE), 1)
				said = run.stderr.read()
				self.assertRegex(said, r"^obsim: 4 runs, about \d+ ") # before the first run
				self.assertIn("interrupted", said)
				self.assertFalse(any(map(program.alive, below)))
				before = self.rows()
				self.assertGreater(len(before), 0)
				self.lab("lab", "projectile", "--engines", "obsim", "--sweep", "substeps=1024")
				self.assertEqual([r for r in self.rows() if r["case"] == "projectile"],
					[r for r in before if r["case"] == "projectile"])
				os.remove(self.path("out/results.csv"))

	def test_killed(self):
		"""Nothing is left running, and finished results are saved."""
		run = self.start("lab", "projectile", "pile", "--engines", "obsim", "--sweep", "substeps=1024")
		self.assertTrue(program.wait_until(lambda: os.path.exists(self.path("out/results.csv")), program.PATIENCE))
		time.sleep(.3)
		below = program.processes(run.pid)
		run.kill()
		run.wait()
		self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))))
		self.assertGreater(len(self.rows()), 0)

	def test_progress(self):
		leader, terminal = self.open_terminal()
		run = self.start("lab", "projectile", "pile", "--engines", "obsim", "--sweep", "substeps=1024", stderr=terminal)
		os.close(terminal)
		seen, asked = b"", False
		try:
			while chunk := os.read(leader, 65536):
				seen += chunk
				if b" of 4, " in seen and not asked:
					run.send_signal(signal.SIGINT)
					asked = True
		except OSError: # the other end is closed
			pass
		os.close(leader)
		run.wait(program.PATIENCE)
		self.assertRegex(seen.decode(), r"\[#* *\] \d of 4, .* left: \S+, obsim substeps=\d+")
		self.assertIn("\r\033[Kobsim: interrupted", seen.decode())

	def test_unwritable(self):
		with open(self.path("file"), "w"):
			pass
		for folder, why in (self.path("file"), "Not a directory"), (self.path("file/out"), "Not a directory"), ("/proc/obsim", ""):
			done = program.call("lab", "projectile", "--engines", "obsim", "--sweep", "none", "--out", folder)
			self.assertEqual(done.returncode, 1, folder)
			self.assertIn(why, done.stderr)
			self.assertEqual(done.stderr.count("\n"), 1)


unittest.main()
