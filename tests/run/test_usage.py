"""Errors of users: one line with the cause and the remedy, exit code 2, nothing left behind."""

import json
import os
import re
import resource
import subprocess
import unittest

import program

STACK = program.scene("stack")


class Usage(program.Case):
	def test_scenes(self):
		"""The scenes that come with obsim are listed with their titles, and found by name beside a folder of that name."""
		listed = dict(line.split(maxsplit=1) for line in program.call("scenes").stdout.splitlines())
		self.assertEqual(set(listed), {f[:-4] for f in os.listdir(program.SCENES) if f.endswith(".lua")})
		self.assertEqual(listed["plaza"], "A plaza")
		os.mkdir(self.path("stack"))
		for name in "stack", "scenes/stack.lua": # as documents have it
			done = program.call("run", name, "--duration", ".05", "--set", "measure=end", cwd=self.directory.name)
			self.assertEqual(done.returncode, 0, done.stderr)
			self.assertNotIn("/../", done.stdout)
		for name in "scenes/stak.lua", "scenes/stack", "other/stack.lua":
			self.refuse("run", name, saying=f"{name}: cannot read the scene: No such file")
		self.refuse("scenes", "plaza", saying="it takes no name")

	def test_options(self):
		self.refuse("run", saying="no scene given")
		self.refuse("run", STACK, "--durration", "1", saying="did you mean --duration?")
		self.refuse("run", STACK, "--duration", "soon", saying="expected a number")
		self.refuse("run", STACK, "--duration", saying="needs a value")
		self.refuse("run", STACK, "--duration", "1", "--duration", "2", saying="given twice")
		self.refuse("run", STACK, "--arch", "monolith", "--workers", "2", saying="one worker")
		self.refuse("run", STACK, "--fps", "60", saying="--fps needs --out")
		self.refuse("run", STACK, "--json", "/no/such/dir/x.json", saying="no directory /no/such/dir")
		self.refuse("run", STACK, "--json", "-", "--out", "-", saying="both write standard output")
		self.refuse("run", STACK, "--out", "x.rgb", "--camera", "nowhere", saying="the scene has none of this name")
		self.refuse("run", STACK, "--out", "x.rgb", "--set", "gpu=big", saying="--set gpu=big: expected surfaceless")
		self.refuse("run", STACK, STACK, saying="one scene at a time")
		self.refuse("run", STACK, "-D", "n=x", saying="n")
		self.refuse("run", STACK, "-D", "mystery=1", saying="mystery")
		self.refuse("compare", STACK, "--workers", "objects", saying="--workers objects")
		self.refuse("compare", STACK, "--frames", "x", saying="unknown option --frames")
		self.refuse("top", "--interval", "0", saying="more than 0")
		self.assertEqual(os.listdir(self.directory.name), [])

	def test_settings(self):
		"""Settings have names; an option that has become one says so; --set help lists those of a command."""
		for words, now in (["--lag", "3"], "--set lag=K"), (["--max-lag=1"], "--set max_lag=S|none"), (["--verify"], "--set verify=off|on"):
			self.refuse("run", STACK, *words, saying=f"{words[0].split('=')[0]} is now {now}")
		self.refuse("serve", STACK, "--verify", saying="unknown option --verify")
		self.refuse("compare", STACK, "--set", "jitter=.1", saying="there is no such setting here; --set help lists them")
		listed = {c: program.call(c, "--set", "help").stdout for c in ("run", "serve", "control", "compare")}
		names = {c: re.findall(r"^  (\w+)=", text, re.M) for c, text in listed.items()}
		self.assertEqual({c: len(n) for c, n in names.items()}, {"run": 22, "serve": 15, "control": 10, "compare": 8})
		self.assertTrue(all(set(n) <= set(names["run"]) for n in names.values()))
		self.assertTrue(all(len(line) <= 120 for line in listed["run"].splitlines()))
		self.assertLessEqual(len(re.findall(r"^  .{4}--", program.call("run", "--help").stdout, re.M)), 36) # of them --help

	def test_commands(self):
		self.refuse("rnu", saying="did you mean 'obsim run'?")
		self.refuse("dance", saying="obsim --help")
		self.refuse(STACK, saying="obsim run " + STACK)
		self.refuse("--versoin", saying="unknown command")
		self.assertEqual(program.call().returncode, 2)

	def test_missing_scenes(self):
		self.refuse("run", "missing.lua", saying="missing.lua")
		self.refuse("compare", "missing.lua", saying="missing.lua")
		self.refuse("run", self.directory.name, saying=self.directory.name)
		self.refuse("run", "falling_bxes", saying="falling_bxes")

	def test_scenes_of_obsim(self):
		"""The command that the help proposes works anywhere; a file of the name that is given comes first."""
		(proposed,) = [line.split()[2:] for line in program.call("--help").stdout.splitlines() if line.startswith("Try:")]
		words = [*proposed, "--duration", ".02"]
		done = program.call(*words, cwd=self.directory.name)
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		name = words[1]
		with open(self.path(name), "w", encoding="utf-8") as f:
			f.write("no scene")
		self.assertEqual(program.call(*words, cwd=self.directory.name).returncode, 2)

	def test_overlap_at_the_start(self):
		"""Objects that begin deep inside each other are named, and the run goes on."""
		with open(self.path("deep.lua"), "w", encoding="utf-8") as f:
			f.write("for i, x in ipairs { 0, .2, 5, 5.999 } do box { name = 'b' .. i, size = { 1, 1, 1 }, at = { x, 0, 0 } } end")
		done = program.call("run", self.path("deep.lua"), "--duration", ".1")
		self.assertEqual(done.returncode, 0)
		self.assertRegex(done.stderr, r'^[^\n]*"b1" \(object 0\) and "b2" \(object 1\) begin 800 mm inside each other')

	def test_help_is_of_its_command(self):
		"""No help has the words of another command, none is cut off, and that of send has all requests."""
		commands = re.findall(r"^  obsim (\w+)", program.call("--help").stdout, re.M)
		self.assertGreater(len(commands), 11)
		for command in commands:
			text = program.call(command, "--help").stdout
			self.assertNotRegex(text, rf"[(;] ?(?!{command}\b)({'|'.join(commands)}):")
			for other in {"lab", "paper"} - {command}:
				self.assertNotIn("obsim-" + other, text)
			for line in text.splitlines():
				self.assertEqual(line, line.rstrip())
		requests = re.search(r"with one of (.*)", program.call("send", "none").stderr)[1].split(", ")
		self.assertGreater(len(requests), 30)
		self.assertEqual(re.findall(r"^  obsim send NAME (\w+)", program.call("send", "--help").stdout, re.M), requests)
		keys = "own|simulator|worker|process|rank|island|rest|cost|lag"
		self.assertIn(f"--colour-by {keys}\n", program.call("run", "--help").stdout)

	def test_static_objects_alone(self):
		"""Nothing moves: there is no cost per body, in the text as in JSON."""
		with open(self.path("still.lua"), "w", encoding="utf-8") as f:
			f.write("ground {} box { size = { 1, 1, 1 }, static = true }")
		done = program.call("run", self.path("still.lua"), "--duration", ".1", "--json", self.path("r.json"))
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		self.assertNotRegex(done.stdout, r"\b(inf|nan)\b|per body")
		with open(self.path("r.json"), encoding="utf-8") as f:
			self.assertIsNone(json.load(f)["body_step_cpu_us"])

	def test_video_without_ffmpeg(self):
		"""Refused before anything is begun."""
		done = subprocess.run([program.OBSIM, "run", STACK, "--out", self.path("v.mp4"), "--record", self.path("r.h5")],
			env={**os.environ, "PATH": self.directory.name}, capture_output=True, text=True, timeout=program.PATIENCE)
		self.assertEqual((done.returncode, done.stdout), (2, ""))
		self.assertRegex(done.stderr, r"^obsim: --out: [^\n]*install ffmpeg[^\n]*\n\Z")
		self.assertEqual(os.listdir(self.directory.name), [])

	def test_help(self):
		for words in ["--help"], ["help"], ["-h"], ["run", "--help"], ["compare", "-h"], ["top", "--help"], ["help", "run"]:
			with self.subTest(words=words):
				done = program.call(*words)
				self.assertEqual((done.returncode, done.stderr), (0, ""))
				self.assertIn("Usage: obsim", done.stdout)
				self.assertTrue(all(len(line) <= 120 for line in done.stdout.splitlines()))
		# help takes precedence over missing arguments
		self.assertEqual(program.call("run", "--help").returncode, 0)

	def test_version(self):
		done = program.call("--version")
		self.assertEqual(done.returncode, 0)
		self.assertRegex(done.stdout, r"^obsim \d+\.\d+\.\d+ \(commit [0-9a-f]+\+?|unknown\)\n")
		for library in "ODE", "Lua", "liburcu", "HDF5", "libpng":
			self.assertIn(library + " ", done.stdout)

	def test_full_disk(self):
		"""A report that cannot be written is a failed run, not a silent one."""
		short = "run", STACK, "--duration", ".1"
		for option in "--json", "--series", "--trace", "--record":
			with self.subTest(option=option):
				done = program.call(*short, option, "/dev/full")
				self.assertEqual(done.returncode, 1)
				self.assertRegex(done.stderr, "/dev/full: .*No space left")
		with open("/dev/full", "w") as full:
			for words in short, ["--help"], ["lab", "--list"], ["top", "--help"]:
				with self.subTest(words=words):
					done = program.call(*words, stdout=full)
					self.assertEqual(done.returncode, 1)
					self.assertIn("standard output cannot be written: No space left", done.stderr)

	def test_file_limit(self):
		"""A limit on the size of files (ulimit -f) is an error with a name, too, and leaves no universe."""
		limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (10240, 10240))
		done = program.call("run", STACK, "--duration", ".1", "--name", self.name, preexec_fn=limit)
		self.assertEqual(done.returncode, 1)
		self.assertIn("File too large", done.stderr)

	def test_reader_that_has_seen_enough(self):
		with subprocess.Popen(["true"], stdin=subprocess.PIPE) as ended:
			ended.wait()
			done = program.call("run", STACK, "--duration", ".1", stdout=ended.stdin)
		self.assertEqual((done.returncode, done.stderr), (0, ""))

	def test_closed_pipe(self):
		with subprocess.Popen(["true"], stdin=subprocess.PIPE) as ended:
			ended.wait()
			done = program.call("run", STACK, "--duration", ".1", "--json", "-", stdout=ended.stdin)
		self.assertEqual(done.returncode, 1)
		self.assertIn("Broken pipe", done.stderr)


unittest.main()
