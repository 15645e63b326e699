"""Commands of the README and the guides run as they are written, one document after another, each in a folder of its
own with the document's scenes (Lua blocks that begin with `-- NAME.lua`). Pictures are drawn small, and long commands
are shortened by the words of SHORTER. A command that is left to run (`&`, `obsim serve`) ends with its document.
"""

import os
import re
import shlex
import subprocess
import time
import unittest

import program

ROOT = os.path.dirname(program.SCENES)
DOCUMENTS = ["README.md", "docs/tutorial.md", "docs/scenes.md", "docs/records.md", "docs/serving.md", "docs/scripting.md",
	"docs/experiments.md", "docs/reliability.md", "docs/tracing.md"]
# Commands that other tests run, or that need another machine.
ELSEWHERE = r"obsim import|obsim lab(?! \w+\.lua)|obsim paper|\./tools/|apt-get|mpirun|srun|python3 bench|python3 tests|build|export |meson|Rscript|using "
SHORTER = [(r"^obsim run .*--out ", "--size 160x90 --duration .2"), (r"^obsim compare (?!.*--(sync|live))", "--duration .1 --repeats 1"),
	(r"^obsim compare .*--sync", "--duration .1 --seeds 1"), (r"^obsim run (?!.*--(duration|replay|resume))", "--duration 5")]


def commands_of(text):
	"""Indented lines that begin like a command, without their remarks."""
	for line in text.split("\n"):
		match = re.match(r"    ((?:obsim|\./|python3|mpirun|srun|apt-get|build|kill) .*|obsim)$", line)
		if match:
			yield re.sub(r"\s+#\s.*$", "", match[1]).strip()


def scenes_of(text):
	"""(name, text) of each Lua block that begins with its file's name."""
	for block in re.findall(r"```lua\n(.*?)```", text, re.DOTALL):
		match = re.match(r"-- (\w+\.lua)\b", block)
		if match:
			yield match[1], block


def shortened(command):
	"""The command with the words of SHORTER in place of its own values of the same options."""
	for pattern, words in SHORTER:
		if re.search(pattern, command):
			for option, value in re.findall(r"(--\w+) (\S+)", words):
				command = re.sub(rf" {option} \S+", "", command) + f" {option} {value}"
	return command


class Documents(program.Case):
	def follow(self, document):
		with open(os.path.join(ROOT, document), encoding="utf-8") as f:
			text = f.read()
		os.symlink(program.SCENES, self.path("scenes"))
		for name, scene in scenes_of(text):
			with open(self.path(name), "w", encoding="utf-8") as f:
				f.write(scene)
		left_running = []
		try:
			for command in commands_of(text):
				if not re.match(ELSEWHERE, command) and not command.startswith("kill"):
					with self.subTest(document=document, command=command):
						self.run_one(command, left_running)
		finally:
			self.end(left_running)

	def end(self, left_running):
		while left_running:
			process = left_running.pop()
			process.terminate()
			process.communicate(timeout=program.PATIENCE)

	def run_one(self, command, left_running):
		if "--replay-requests" in command: # a log is whole when its run has ended
			self.end(left_running)
		serves = " serve " in command or " --live" in command
		background = command.endswith("&") or serves or "--pace realtime" in command
		command = command.rstrip("& ")
		words = [program.OBSIM, *shlex.split(command if background else shortened(command))[1:]]
		if background:
			if serves:
				words += ["--listen", "127.0.0.1:0"]
			process = subprocess.Popen(words, cwd=self.directory.name, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
			left_running.append(process)
			if serves:
				self.assertIn("http://", process.stdout.readline())
			name = re.search(r"--name (\w+)", command)
			while name and not os.path.exists(program.segment(name[1])) and process.poll() is None:
				time.sleep(.01)
			self.assertIsNone(process.poll())
			return
		done = subprocess.run(words, cwd=self.directory.name, stdin=subprocess.DEVNULL, capture_output=True, text=True,
			timeout=program.PATIENCE)
		self.assertEqual(done.returncode, 0, done.stderr)


def add(document):
	name = "test_" + re.sub(r"\W+", "_", document.removesuffix(".md")).lower()
	setattr(Documents, name, lambda self: self.follow(document))


for one in DOCUMENTS:
	add(one)

if __name__ == "__main__":
	unittest.main()
