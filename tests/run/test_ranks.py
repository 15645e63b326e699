"""One universe on several ranks, all of them on this machine: the bits of one process, files of rank 0 alone, and one error
for all where a rank is different, or dies."""

import json
import os
import signal
import subprocess
import tempfile
import time
import unittest

import program

RANKS = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
	"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}
SCENES = {
	"falling_boxes": ["-D", "n=60", "--duration", "2"],
	"sparse": ["--duration", "1"],
	"pile": ["--duration", ".5"],
	"cradle": ["--duration", "1"],
	"machines": ["--duration", "1"],
	"flock": ["--duration", "1"],
}


def command(*groups):
	"""mpirun with so many ranks of each group, each with its own words."""
	words = []
	for ranks, more in groups:
		words += [":"] if words else []
		words += ["-n", str(ranks), program.OBSIM, "run", *map(str, more)]
	return ["mpirun", *words]


def run(*groups):
	return subprocess.run(command(*groups), env=RANKS, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
		stderr=subprocess.PIPE, text=True, timeout=program.PATIENCE)


class Ranks(program.Case):
	def hash_of(self, *groups):
		done = run(*groups)
		self.assertEqual(done.returncode, 0, done.stderr)
		return json.loads(done.stdout)["state_hash"]

	def test_same_bits(self):
		for name, words in SCENES.items():
			words = [program.scene(name), *words, "--measure", "end", "--json", "-"]
			alone = program.report(*words[:-2], "--workers", "1")["state_hash"]
			for ranks, workers in (3, 1), (2, 2):
				with self.subTest(scene=name, ranks=ranks, workers=workers):
					self.assertEqual(self.hash_of((ranks, [*words, "--workers", workers])), alone)

	def test_files_are_of_the_first(self):
		words = [program.scene("falling_boxes"), "-D", "n=20", "--duration", ".5"]
		with tempfile.TemporaryDirectory() as folder:
			alone, shared = os.path.join(folder, "alone.csv"), os.path.join(folder, "shared.csv")
			program.report(*words, "--measure", "step", "--series", alone)
			done = run((3, [*words, "--workers", "1", "--measure", "step", "--series", shared]))
			self.assertEqual(done.returncode, 0, done.stderr)
			self.assertEqual(done.stdout.count("simulated"), 1 + done.stdout.count("per simulated"))
			with open(alone, encoding="utf-8") as a, open(shared, encoding="utf-8") as b:
				self.assertEqual(a.read(), b.read())

	def test_goes_on_from_a_checkpoint(self):
		words = [program.scene("falling_boxes"), "-D", "n=20"]
		expected = program.report(*words, "--duration", "1", "--workers", "1")["state_hash"]
		with tempfile.TemporaryDirectory() as folder:
			kept = os.path.join(folder, "kept")
			done = run((2, [*words, "--duration", ".5", "--workers", "1", "--checkpoint", kept]))
			self.assertEqual(done.returncode, 0, done.stderr)
			more = ["--resume", kept, "--duration", "1", "--workers", "1", "--json", "-"]
			self.assertEqual(self.hash_of((3, more)), expected)

	def test_refused(self):
		words = [program.scene("falling_boxes"), "-D", "n=20", "--duration", "1"]
		for other, said in ((["--workers", "1", "--seed", "5"], "runs another scene"),
				(["--workers", "2"], "another number of workers"),
				(["--workers", "1", "--step", "1/61"], "other settings")):
			with self.subTest(other=other):
				done = run((2, [*words, "--workers", "1"]), (1, [*words, *other]))
				self.assertNotEqual(done.returncode, 0)
				self.assertIn("rank 2", done.stderr)
				self.assertIn(said, done.stderr)

	def test_no_wrong_result(self):
		"""Where simulators of one rank write what they should not, the run ends with an error, or in the right bits."""
		words = [program.scene("gas"), "--duration", "2", "--workers", "1", "--isolation", "process", "--measure", "end",
			"--json", "-"]
		right, ended = self.hash_of((2, words)), 0
		for seed in range(1, 6):
			done = run((1, words), (1, [*words, "--fault", f"scribble:p=.02,seed={seed}"]))
			if done.returncode:
				ended += 1
				self.assertRegex(done.stderr, "is of rank 1, which|has left the run|was killed by|interrupted")
			else:
				self.assertEqual(json.loads(done.stdout)["state_hash"], right)
		self.assertGreater(ended, 0)

	def test_a_death_ends_all(self):
		words = [program.scene("gas"), "--duration", program.FOR_EVER, "--workers", "1"]
		running = subprocess.Popen(command((3, words)), env=RANKS, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
			stderr=subprocess.PIPE, text=True)
		try:
			os.kill(self.simulator_of(running.pid, "sim 1"), signal.SIGKILL)
			_, said = running.communicate(timeout=program.PATIENCE)
		finally:
			running.kill()
		self.assertNotEqual(running.returncode, 0)
		self.assertIn("was killed by SIGKILL", said)
		self.assertIn("another rank has left the run", said)

	def simulator_of(self, launcher, name):
		end = time.monotonic() + program.PATIENCE
		while time.monotonic() < end:
			for pid in program.processes(launcher):
				try:
					with open(f"/proc/{pid}/comm", encoding="utf-8") as f:
						if f.read().strip() == name and self.has_stepped(launcher):
							return pid
				except OSError:
					pass
			time.sleep(.05)
		self.fail(f"{name} does not come")

	@staticmethod
	def has_stepped(launcher):
		names = [f"obsim-{pid}" for pid in program.processes(launcher)]
		return sum(program.steps(name) > 0 for name in names) == 3


unittest.main()
