"""Shell completions know every option, and the shells that are here accept them."""

import glob
import os
import re
import shutil
import subprocess
import unittest

import program

FILES = os.environ["COMPLETIONS"]
COMMANDS = ["run", "serve", "control", "export", "compare", "top", "lab", "paper", "inspect", "send", "scenes", "import"]


def options(command):
	return re.findall(r"^  .{4}(--[a-z-]+)", program.call(command, "--help").stdout, re.M)


class Completions(program.Case):
	def test_every_option(self):
		for name, pattern in ("_obsim", r"{0}\b"), ("obsim.fish", r"-l {1}\b"):
			with open(os.path.join(FILES, name)) as f:
				text = f.read()
			for command in COMMANDS:
				self.assertIn(command, text)
				for option in options(command):
					self.assertRegex(text, pattern.format(option, option[2:]), f"{name}: {option}")

	def test_no_other_option(self):
		known = {o for c in COMMANDS for o in options(c)} | {"--version"}
		with open(os.path.join(FILES, "obsim.fish")) as f:
			self.assertLessEqual({"--" + o for o in re.findall(r"^complete .* -l ([a-z-]+)", f.read(), re.M)}, known)
		with open(os.path.join(FILES, "_obsim")) as f:
			self.assertLessEqual(set(re.findall(r"--[a-z][a-z-]*", f.read())), known)

	def bash(self, *words):
		script = 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _obsim; printf "%s\\n" "${COMPREPLY[@]}"'
		done = subprocess.run(["bash", "-c", script, "bash", os.path.join(FILES, "obsim.bash"), program.OBSIM, *words],
			stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=20, cwd=self.directory.name)
		self.assertEqual((done.returncode, done.stderr), (0, ""))
		return done.stdout.split()

	def test_bash(self):
		self.assertEqual(self.bash("com"), ["compare"])
		self.assertEqual(self.bash("sen"), ["send"])
		requests = re.findall("^  obsim send NAME ([a-z]+)", program.call("send", "--help").stdout, re.M)
		self.assertEqual([w for w in self.bash("send", "mine", "") if w in requests], requests)
		self.assertEqual(self.bash("send", "mine", "wai"), ["wait"])
		for command in COMMANDS:
			self.assertEqual(self.bash(command, "--"), options(command))
		self.assertEqual(self.bash("run", "--arch", "m"), ["monolith"])
		self.assertEqual(self.bash("run", "--set", "so"), ["solver=coloured", "solver=jacobi", "solver=ghost", "solver=lagged"])
		self.assertEqual(self.bash("run", "--set", "solver", "=", "ja"), ["jacobi"])
		self.assertEqual((self.bash("run", "--set", "lo"), self.bash("serve", "--set", "verify")), (["load="], []))
		self.assertEqual(self.bash("lab", "stack-10", "stack-2"), ["stack-20"])
		self.assertEqual(self.bash("lab", "--json", "--che"), ["--check"])
		open(self.path("a scene.lua"), "w").close()
		open(self.path("other.txt"), "w").close()
		os.mkdir(self.path("dir"))
		self.assertEqual(self.bash("run", ""), ["dir/", "a", "scene.lua"])

	def test_syntax(self):
		for shell, name in ("zsh", "_obsim"), ("fish", "obsim.fish"), ("bash", "obsim.bash"):
			if shutil.which(shell):
				subprocess.run([shell, "-n", os.path.join(FILES, name)], check=True, timeout=20)
		self.assertEqual(len(glob.glob(os.path.join(FILES, "*obsim*"))), 3)


unittest.main()
