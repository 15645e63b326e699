"""The report: its keys are stable, its figures are plausible, and the manual names them all."""

import csv
import json
import os
import re
import unittest

import program

KEYS = """objects steps simulated_s wall_s cpu_s body_step_cpu_us state_hash energy_start energy_end energy_gain_max
momentum_error penetration_max_m penetration_mean_m worst_penetration_m fps frames workers isolation arch commit scene
step substeps solver integrator seed startup_s step_p50_s step_p99_s memory_bytes outcome bodies iterations total_s
frame_rate worst_penetration_time_s lag tolerance error_reached substeps_min substeps_median substeps_max islands_redone
islands_over depth_reached creep_reached bounce_reached deviation_reached bounded_share unbounded_steps estimates
verified_steps unverified_steps verified_p50_m verified_p90_m verified_p99_m verified_max_m
verified_second_p50_m verified_second_p90_m verified_second_p99_m verified_second_max_m verified_share energy_recovered narrow load box_tests step_p90_s step_max_s critical_s critical_16_s work_s held_s gate_s gate_cpu_s idle_s
elapsed_s host_cpu_s renderer_cpu_s switches deaths worker_memory_bytes separation_max_m separation_mean_m trace_events
trace_lost resumed_s checkpoints checkpoint_bytes checkpoint_s faults fault_kinds faults_overwritten frozen
scripts_stopped scripts_warned sync coupling update_rate max_lag jitter delay updates waits wait_s lag_mean_s lag_max_s""".split()


class Report(program.Case):
	def test_falling_boxes(self):
		r = program.report(program.scene("falling_boxes"), "-D", "n=20", "--duration", "1", "--workers", "2")
		self.assertEqual(sorted(r), sorted(KEYS))
		self.assertEqual((r["steps"], r["objects"], r["bodies"], r["workers"]), (60, 21, 20, 2))
		self.assertEqual((r["arch"], r["isolation"], r["outcome"]), ("obs", "thread", "finished"))
		self.assertAlmostEqual(r["simulated_s"], 1, delta=1e-9)
		self.assertAlmostEqual(r["step"], 1 / 60, delta=1e-15)
		for key in "wall_s", "cpu_s", "startup_s", "memory_bytes", "step_p50_s", "body_step_cpu_us", "energy_start":
			self.assertGreater(r[key], 0, key)
		self.assertLessEqual(r["wall_s"], r["total_s"])
		self.assertLessEqual(r["step_p50_s"], r["step_p99_s"])
		self.assertLessEqual(r["penetration_mean_m"], r["penetration_max_m"])
		self.assertLessEqual(r["penetration_max_m"], r["worst_penetration_m"])
		self.assertAlmostEqual(r["body_step_cpu_us"], 1e6 * r["cpu_s"] / (20 * 60), delta=1e-6)
		self.assertLess(r["energy_end"], r["energy_start"])
		self.assertLess(r["energy_gain_max"], 1e-3)
		self.assertEqual((r["tolerance"], r["substeps"], r["substeps_min"]), (1e-3, 0, 1))
		self.assertLessEqual(r["error_reached"], 1e-3)
		self.assertEqual((r["frames"], r["fps"], r["frame_rate"], r["momentum_error"]), (0, None, None, None))

	def test_fixed_substeps(self):
		r = program.report(program.scene("falling_boxes"), "-D", "n=20", "--duration", "1", "--set", "substeps=4")
		self.assertEqual((r["tolerance"], r["error_reached"], r["substeps"], r["substeps_max"]), (None, None, 4, 0))

	def test_tolerance(self):
		words = [program.scene("falling_boxes"), "-D", "n=60", "--duration", "3"]
		coarse, fine = (program.report(*words, "--tolerance", t) for t in ("5mm", ".5mm"))
		for r, tolerance in (coarse, 5e-3), (fine, .5e-3):
			self.assertAlmostEqual(r["tolerance"], tolerance, delta=1e-15)
			self.assertEqual(r["error_reached"] > tolerance, r["islands_over"] > 0)
			self.assertLessEqual(r["worst_penetration_m"], tolerance)
			self.assertEqual((r["substeps"], r["iterations"]), (0, 64))
			self.assertLessEqual(r["substeps_min"], r["substeps_median"])
			self.assertLessEqual(r["substeps_median"], r["substeps_max"])
		self.assertEqual(coarse["islands_over"], 0)
		self.assertLess(fine["worst_penetration_m"], coarse["worst_penetration_m"])
		self.assertLess(coarse["islands_redone"], fine["islands_redone"])
		self.assertLess(coarse["substeps_max"], fine["substeps_max"])

	def test_missed_tolerance(self):
		"""Impacts that are solved by too few iterations, however many substeps there are."""
		words = ["run", program.scene("falling_boxes"), "-D", "n=20", "--duration", "1.2", "--set", "measure=end", "--set", "iterations=1"]
		for strict, code in ([], 0), (["--strict"], 1):
			done = program.call(*words, "--tolerance", "1um", *strict)
			self.assertEqual(done.returncode, code, done.stderr)
			self.assertRegex(done.stderr, r"^obsim: warning: the tolerance of .* was missed in \d+ island steps?; .*\n$")
			self.assertIn("MISSED", done.stdout)
		done = program.call("run", program.scene("stack"), "--duration", "1", "--strict")
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		self.assertIn(" kept, ", done.stdout)
		self.refuse("run", program.scene("stack"), "--set", "substeps=4", "--strict", saying="no tolerance")

	def test_one_verdict(self):
		"""A strict run fails where depth, slip, an estimate of motion, or a step that was solved again tells it to, and only there."""
		told = set()
		for name, *words in ["stack"], ["falling_boxes", "-D", "n=8"], ["cradle"], ["machines"], ["shapes"]:
			for verify in "off", "on":
				done = program.call("run", program.scene(name), *words, "--duration", "1.5", "--strict", "--set", "verify=" + verify, "--json", self.path("r"))
				r = json.load(open(self.path("r")))
				wrong = r["islands_over"] > 0 or r["unbounded_steps"] > 0 or (r["verified_share"] or 1) < 1
				self.assertEqual(done.returncode, int(wrong), (name, verify, done.stderr))
				self.assertEqual("obsim: warning: " in done.stderr, wrong, done.stderr)
				told.add(wrong)
		self.assertEqual(told, {False, True})

	def test_script_errors(self):
		"""A script that fails is named with its line and its step, also when its object has gone, and fails a strict run."""
		with open(self.path("door.lua"), "w") as f:
			f.write("""
scene { duration = .5 }
script("door", "function on_step()\\n if time() > .2 and self:id() > 0 then self.hinge.x = 1 end end")
for i = 1, 3 do sphere { radius = .1, at = { i, 0, 9 }, script = "door", dies = i == 3 and .3 or nil } end
""")
		for words in [], ["--isolation", "process", "--workers", "1"], ["--isolation", "process", "--harden"], ["--arch", "monolith"]:
			for strict, code in ([], 0), (["--strict"], 1):
				done = program.call("run", self.path("door.lua"), *words, *strict, "--json", self.path("r"))
				self.assertEqual(done.returncode, code, done.stderr)
				with open(self.path("r")) as f:
					report = json.load(f)
				self.assertEqual((report["scripts_stopped"], [(e["object"], e["step"]) for e in report["script_errors"]]), (2, [(1, 14), (2, 14)]))
				self.assertTrue(all(e["what"].startswith("door:2: ") for e in report["script_errors"]))
				self.assertIn("  scripts      2 stopped by an error, 0 with something in vain\n", done.stdout)
				self.assertRegex(done.stdout, r"(?m)^ +object \d \(sphere#\d\) in step 14: door:2: ")

	def test_verify(self):
		"""Errors of a sample of steps: fewer substeps show larger ones, and nothing else changes."""
		words = [program.scene("falling_boxes"), "-D", "n=30", "--duration", "2", "--set", "measure=end", "--workers", "1"]
		plain = program.report(*words)
		r, fine = (program.report(*words, "--set", "verify=on", *more) for more in ([], ["--set", "substeps=128"]))
		self.assertEqual(r["state_hash"], plain["state_hash"])
		for key in "substeps_median", "islands_redone", "box_tests", "error_reached", "energy_recovered":
			self.assertEqual(r[key], plain[key], key)
		self.assertEqual((plain["verified_steps"], plain["verified_max_m"], r["unverified_steps"]), (0, None, 0))
		self.assertGreater(r["verified_steps"], 20)
		for name in "verified_", "verified_second_":
			errors = [r[name + what] for what in ("p50_m", "p90_m", "p99_m", "max_m")]
			self.assertEqual(errors, sorted(errors))
			self.assertLess(fine[name + "p50_m"], errors[0])
		self.assertLess(r["verified_p99_m"], r["verified_second_p99_m"])
		self.assertTrue(0 <= r["verified_share"] <= 1)
		self.assertIsNone(fine["verified_share"])
		done = program.call("run", *words, "--set", "verify=on")
		self.assertRegex(done.stdout, r"verified     \d+ body steps with 512 substeps: errors of a step .* in the median")
		self.refuse("run", *words, "--arch", "monolith", "--set", "verify=on", saying="monolith")

	def test_hits_in_the_air_keep_the_tolerance(self):
		"""Hulls that hit each other while they fall: two of them jam as bodies that float do."""
		shapes = os.path.join(program.SCENES, "..", "bench", "shapes.lua")
		done = program.call("run", shapes, "-D", "points=8", "-D", "upright=true", "--seed", "3", "--duration", ".75", "--strict")
		self.assertNotIn("MISSED", done.stdout)
		self.assertIn(" kept, ", done.stdout)

	def test_rolling_is_refined(self):
		"""A disk that rolls takes more substeps once its errors are seen, and keeps its energy from then on."""
		disk = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes", "disk.lua")
		for degrees in "3", "5", "10":
			first, second = (program.report(disk, "-D", f"degrees={degrees}", "--duration", d) for d in ("1", "2"))
			self.assertIn(second["substeps_max"], (32, 64), degrees)
			self.assertLess(abs(second["energy_end"] / first["energy_end"] - 1), 1e-4, degrees)
			self.assertEqual((first["bounded_share"], second["bounded_share"]), (0, .5), degrees)

	def test_tolerance_by_size(self):
		"""A share is one of the thinnest object's thickness; a length that is coarse for it is warned of."""
		disk = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes", "disk.lua")
		share, length = (program.report(disk, "-D", "radius=.5", "--tolerance", t, "--duration", ".1") for t in ("10%", "1mm"))
		for key in "tolerance", "state_hash", "iterations", "error_reached":
			self.assertEqual(share[key], length[key], key)
		for share in "0%", "101%", "1%x", "%":
			self.refuse("run", disk, "--tolerance", share, saying="a share above 0%, up to 100%")
		self.refuse("run", disk, "-D", "radius=.01", "--tolerance", ".1%", saying="thinnest")
		coarse, fine = (program.call("run", disk, "--tolerance", t, "--duration", ".1") for t in ("1mm", "20%"))
		self.assertEqual((coarse.returncode, fine.returncode, fine.stderr), (0, 0, ""))
		self.assertRegex(coarse.stderr, r"^obsim: warning: the tolerance of 1.00 mm is coarse for the thinnest object, of 5.00 mm: .*\n$")

	def test_motion_is_estimated(self):
		"""A disk that rolls loses energy at the default, and no contact shows it: the estimate does."""
		disk = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes", "disk.lua")
		for words, bounded in ([disk], False), ([program.scene("stack")], True):
			r = program.report(*words, "--duration", "1")
			self.assertEqual((r["islands_over"], r["deviation_reached"] <= r["tolerance"]), (0, bounded), words)
			self.assertEqual(r["bounded_share"], 1 - r["unbounded_steps"] / 60)
			self.assertEqual(r["unbounded_steps"] == 0, bounded)
			self.assertEqual(max(r["depth_reached"], r["creep_reached"], r["bounce_reached"]), r["error_reached"])
		done = program.call("run", disk, "-D", "radius=1", "--strict")
		self.assertEqual(done.returncode, 1)
		self.assertRegex(done.stderr, r"^obsim: warning: motion may be off by more than 1.00 mm a second for 100 % of the time of objects, .*\n$")
		self.assertIn("; motion is within 1.00 mm a second for 0 % of the time of objects, else one of many that may come, up to ", done.stdout)
		full = program.call("run", disk, "-D", "radius=1", "--report", "full")
		self.assertIn("motion       within 1.00 mm a second for 0 % of the time of objects, else", full.stdout)

	def test_five_lines(self):
		"""The short report has the run, the verdict, speed, simulators, hash; a full report begins and ends with the same."""
		for words in ([], ["--isolation", "process"], ["--set", "substeps=4"], ["--arch", "monolith"], ["--sync", "free"], ["--set", "measure=end"]):
			short, full = (program.call("run", program.scene("stack"), "--duration", ".2", *words, *more).stdout.splitlines()
				for more in ([], ["--report", "full"]))
			self.assertEqual([line.split()[0] for line in short[1:]], ["error", "speed", "simulators", "state"], short)
			self.assertGreater(len(full), len(short) + 3)
			if "free" not in words:
				self.assertEqual((short[0], short[-1]), (full[0], full[-1]))
			if not words:
				self.assertEqual(full[1].split()[:4], ["tolerance", *short[1].split()[1:4]])
		killed = program.call("run", program.scene("stack"), "--duration", "1", "--isolation", "process", "--fault", "kill:p=.1,seed=1")
		self.assertEqual([line.split()[0] for line in killed.stdout.splitlines()[1:]], ["error", "speed", "simulators", "deaths", "faults", "state"])
		self.refuse("run", program.scene("stack"), "--report", "long", saying="--report long: expected one of short|full")

	def test_explain(self):
		cradle = program.call("run", program.scene("cradle"), "--set", "substeps=8", "--explain")
		self.assertEqual((cradle.returncode, cradle.stderr), (0, ""))
		for line in ("gyroscope    none: all are spheres", "friction     none: no object has any", "renderer     none",
				"recorder     none", "Lua          none", "tolerance    none"):
			self.assertIn(line, cradle.stdout)
		self.assertRegex(cradle.stdout, r"restitution  \d+ impacts")
		wheel = self.path("wheel.lua")
		with open(wheel, "w", encoding="utf-8") as f:
			f.write("scene { duration = .2 }\ncylinder { name = 'wheel', radius = .3, length = .1, at = { 0, 0, 2 }, mass = 1, spin = { 0, 0, 12 } }\n"
				"hinge { 'wheel', at = { 0, 0, 2 }, axis = { 0, 0, 1 } }\n")
		for turning in ([wheel], [program.scene("hills"), "--duration", ".5"], [program.scene("tower"), "--duration", "1.5"]):
			self.assertIn("gyroscope    Euler's equations in", program.call("run", *turning, "--explain").stdout, turning)
		boxes = program.call("run", program.scene("falling_boxes"), "-D", "n=8", "--duration", "2", "--explain", "--json=-")
		for line in "restitution  none: no object has any", "flight       closed form", "collision", "Coulomb's cone":
			self.assertIn(line, boxes.stderr)
		shares = [float(x) for x in re.findall(r"([\d.]+) %  ", boxes.stderr)]
		self.assertEqual(len(shares), 14)
		self.assertAlmostEqual(sum(shares), 100, delta=2)

	def test_energy_is_exact(self):
		"""Before anything touches, energy is that of free fall: no change beyond rounding."""
		r = program.report(program.scene("falling_boxes"), "-D", "n=8", "--duration", ".1")
		self.assertLess(abs(r["energy_end"] / r["energy_start"] - 1), 1e-12)
		self.assertEqual(r["worst_penetration_m"], 0)

	def test_momentum(self):
		"""A closed scene has a momentum error at the level of rounding."""
		r = program.report(program.scene("cradle"))
		self.assertIsNotNone(r["momentum_error"])
		self.assertLess(r["momentum_error"], 1e-12)

	def test_measure_end(self):
		words = [program.scene("stack"), "--duration", ".5", "--workers", "1"]
		every, parts, ends = (program.report(*words, "--set", f"measure={when}") for when in ("step", "profile", "end"))
		for key in "energy_gain_max", "worst_penetration_m", "worst_penetration_time_s":
			self.assertIsNone(ends[key])
			self.assertIsNone(parts[key])
			self.assertIsNotNone(every[key])
		for key in "step_p50_s", "step_p90_s", "step_p99_s", "step_max_s", "switches":
			self.assertGreater(ends[key], 0, key)
		self.assertLessEqual(ends["step_p50_s"], ends["step_p90_s"])
		self.assertLessEqual(ends["step_p99_s"], ends["step_max_s"])
		for key in "critical_s", "critical_16_s", "work_s", "held_s", "gate_s", "gate_cpu_s":
			self.assertIsNone(ends[key], key)
		self.assertGreater(parts["work_s"], 0)
		for key in "state_hash", "energy_start", "energy_end", "penetration_max_m", "penetration_mean_m", "steps":
			self.assertEqual(ends[key], every[key], key)
			self.assertEqual(parts[key], every[key], key)

	def test_where_the_time_goes(self):
		"""Working, waiting for a core, waiting at the gate: together this is all of the workers' time."""
		for way in ["--workers", "2"], ["--workers", "objects"], ["--workers", "2", "--isolation", "process"], ["--arch", "monolith"]:
			r = program.report(program.scene("falling_boxes"), "-D", "n=60", "--duration", "4", "--set", "measure=profile", *way)
			had = r["workers"] * r["elapsed_s"]
			self.assertGreater((r["work_s"] + r["held_s"] + r["gate_s"] + r["idle_s"]) / had, .95, way)
			self.assertLess((r["work_s"] + r["held_s"] + r["gate_s"] + r["idle_s"]) / had, 1.05, way)
			self.assertLessEqual(r["critical_s"], 1.01 * r["work_s"] + .01, way)
			self.assertGreaterEqual(1.05 * r["critical_s"] + .01, r["work_s"] / r["workers"], way)
			if "objects" in way:
				self.assertIsNone(r["critical_16_s"])
				continue
			self.assertLessEqual(r["critical_16_s"], 1.05 * r["work_s"] + .01, way)
			self.assertGreaterEqual(1.05 * r["critical_16_s"] + .01, r["work_s"] / 16, way)
			if "monolith" in way: # its one task cannot be shared
				self.assertGreaterEqual(1.05 * r["critical_16_s"] + .01, r["work_s"], way)

	def test_monolith(self):
		r = program.report(program.scene("pile"), "--arch", "monolith", "--duration", ".3")
		self.assertEqual((r["arch"], r["workers"], r["substeps"], r["bodies"]), ("monolith", 1, 1, 216))
		again = program.report(program.scene("pile"), "--arch", "monolith", "--duration", ".3", "--set", "measure=end")
		self.assertEqual(r["state_hash"], again["state_hash"])
		finer = program.report(program.scene("pile"), "--arch", "monolith", "--duration", ".3", "--set", "substeps=4")
		self.assertEqual(finer["substeps"], 4)

	def test_seed(self):
		words = [program.scene("falling_boxes"), "-D", "n=8", "--duration", ".1", "--set", "measure=end"]
		a, b, c = (program.report(*words, "--seed", s) for s in ("5", "6", "5"))
		self.assertEqual((a["seed"], b["seed"]), (5, 6))
		self.assertNotEqual(a["state_hash"], b["state_hash"])
		self.assertEqual(a["state_hash"], c["state_hash"])

	def test_files(self):
		words = ["run", program.scene("stack"), "--duration", ".25"]
		done = program.call(*words, "--json", "r.json", "--series", "s.csv", cwd=self.directory.name)
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		self.assertIn(": 11 objects, ", done.stdout)
		with open(self.path("r.json")) as f:
			r = json.load(f)
		with open(self.path("s.csv"), newline="") as f:
			series = list(csv.DictReader(f))
		self.assertEqual([int(row["step"]) for row in series], list(range(r["steps"] + 1)))
		self.assertEqual(float(series[0]["energy_j"]), r["energy_start"])
		self.assertEqual(float(series[-1]["energy_j"]), r["energy_end"])
		worst = max(float(row["penetration_max_m"]) for row in series)
		self.assertAlmostEqual(worst, r["worst_penetration_m"], delta=1e-8 * worst)

	def test_no_progress_in_a_pipe(self):
		done = program.call("run", program.scene("stack"), "--duration", "1")
		self.assertEqual(done.stderr, "")
		self.assertNotIn("\r", done.stdout)

	def test_manual(self):
		manual = os.environ["MANUAL"]
		with open(manual) as f:
			text = f.read().replace("\\-", "-")
		for key in KEYS:
			self.assertRegex(text, r"\b" + key + r"\b")
		for command in "run", "compare", "top", "inspect":
			options = re.findall(r"^  .{4}(--[a-z]+)", program.call(command, "--help").stdout, re.M)
			self.assertGreater(len(options), 1)
			for option in options:
				if option != "--help":
					self.assertRegex(text, re.escape(option) + r"\b", option)


	def test_front_page(self):
		"""README's overlaps are those of this program, to the digits that it shows."""
		with open(os.path.join(os.path.dirname(program.SCENES), "README.md"), encoding="utf-8") as f:
			shown = dict(re.findall(r"^\| deepest overlap, mm: ([\w ]+) \| ([\d.]+) ", f.read(), re.M))
		for what, words in ("one ODE world", ["--arch", "monolith"]), ("simulators", []):
			figures = program.report(program.scene("falling_boxes"), "-D", "n=100", "--duration", 3, *words)
			digits = len(shown[what].partition(".")[2])
			self.assertEqual(f"{1e3 * figures['worst_penetration_m']:.{digits}f}", shown[what], what)


unittest.main()
