"""One universe on several ranks, all of them on this machine: the bits of one process, files of rank 0 alone, and one
error for all if a rank is different, or dies. Then each of the others has a checkpoint, from which any number of ranks
resume."""

import fcntl
import json
import mmap
import os
import random
import signal
import struct
import subprocess
import tempfile
import time
import unittest

import program

SCENES = {
	"falling_boxes": ["-D", "n=60", "--duration", "2"],
	"sparse": ["--duration", "1"],
	"pile": ["--duration", ".5"],
	"cradle": ["--duration", "1"],
	"machines": ["--duration", "1"],
	"flock": ["--duration", "1"],
	"wrecking_ball": ["-D", "links=4", "-D", "rows=3", "--duration", "1.4"],
	"bridge": ["-D", "planks=8", "--duration", "1"],
}
# In contact in the first solution of its step 25, and not in the last.
PARTED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes", "parted")


def command(*groups):
	"""mpirun with this number of ranks of each group, each with its own words."""
	words = []
	for ranks, more in groups:
		words += [":"] if words else []
		words += ["-n", str(ranks), program.OBSIM, "run", *map(str, more)]
	return ["mpirun", *words]


def run(*groups):
	return subprocess.run(command(*groups), env=program.RANKS, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
		stderr=subprocess.PIPE, text=True, timeout=program.PATIENCE)


class Ranks(program.Case):
	def hash_of(self, *groups):
		done = run(*groups)
		self.assertEqual(done.returncode, 0, done.stderr)
		return json.loads(done.stdout)["state_hash"]

	def test_single(self):
		"""Commands that show or lead one universe refuse several ranks: one line with the remedy, exit 2."""
		for words in ["serve"], ["serve", "--replay", "record.h5"], ["control"], ["compare", "--live"]:
			words += [] if "record.h5" in words else [program.scene("stack")]
			done = subprocess.run(["mpirun", "-n", "2", program.OBSIM, *words], env=program.RANKS, stdin=subprocess.DEVNULL,
				stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=program.PATIENCE)
			lines = [line for line in done.stderr.splitlines() if line.startswith("obsim: ")]
			self.assertEqual((done.returncode, done.stdout, lines), (2, "", [f"obsim: {words[0]} has a single rank: start it without "
				"mpirun or srun, or use obsim run, which has several"]), done.stderr)

	def test_same_bits(self):
		for name, words in SCENES.items():
			words = [program.scene(name), *words, "--set", "measure=end", "--json", "-"]
			alone = program.report(*words[:-2], "--workers", "1")["state_hash"]
			for ranks, workers in (3, 1), (2, 2):
				with self.subTest(scene=name, ranks=ranks, workers=workers):
					self.assertEqual(self.hash_of((ranks, [*words, "--workers", workers])), alone)

	def test_bodies_come_and_go(self):
		"""Bodies move from one rank's neighbours to another's, by far in a step. Colliding bodies are in
		islands of several ranks' bodies, which merge and split, and no two steps have the same neighbours."""
		for speed, duration in (3, 2), (100, .25):
			words = [program.scene("gas"), "-D", f"speed={speed}", "--duration", duration, "--set", "measure=end", "--json", "-"]
			alone = program.report(*words[:-2], "--workers", "1")["state_hash"]
			for ranks, workers in (4, 1), (2, 2):
				with self.subTest(speed=speed, ranks=ranks):
					self.assertEqual(self.hash_of((ranks, [*words, "--workers", workers])), alone)

	def test_is_whole_where_somebody_looks(self):
		"""Motions that other ranks solve far from a rank's own bodies grow old there, unless a program reads
		its universe."""
		running, bodies = self.start_stepping_ranks([program.scene("sparse"), "--duration", program.FOR_EVER, "--workers", "1",
			"--set", "sleeping=off", "--set", "measure=end"]), 200
		segment = program.segment(f"obsim-{self.ranks_of(running)[0][0]}")
		with open(segment, "rb") as f, mmap.mmap(f.fileno(), 0, prot=mmap.PROT_READ) as memory:
			control, slots = (struct.unpack_from("=Q", memory, 32 + 8 * area)[0] for area in (0, 5)) # table/layout.h, table/slot.h

			def age():
				"""Steps since some motion expired."""
				step, ends = struct.unpack_from("=Q", memory, control)[0], []
				for slot in range(slots + 360, slots + 360 * (1 + bodies), 360): # all but the ground
					version = struct.unpack_from("=Q", memory, slot)[0]
					ends.append(struct.unpack_from("=d", memory, slot + 8 + 176 * (version % 2) + 8)[0]) # ob_motion.valid_until
				return step - 60 * min(ends)

			self.assertTrue(program.wait_until(lambda: age() > 20))
			fcntl.fcntl(f, fcntl.F_OFD_SETLK, struct.pack("hh4xqqi4x", fcntl.F_RDLCK, os.SEEK_SET, 1, 1, 0)) # table/segment.c
			self.assertTrue(program.wait_until(lambda: age() < 5))
			self.assertLess(max(age() for _ in range(20)), 20)

	@unittest.skipIf(len(os.sched_getaffinity(0)) < 2, "there is but one core")
	def test_cores_of_their_own(self):
		"""Ranks on one machine spread over its cores, if the launcher permits them all."""
		running = self.start_stepping_ranks([program.scene("gas"), "--duration", program.FOR_EVER, "--workers", "1"])
		cores = [os.sched_getaffinity(pid) for pid in program.simulators(running.pid) if program.comm(pid) != "sim 3"]
		self.assertEqual(len(cores), 3)
		self.assertEqual(len(set.union(*cores)), min(3, len(os.sched_getaffinity(0))))

	def test_files_are_of_the_first(self):
		words = [program.scene("falling_boxes"), "-D", "n=20", "--duration", ".5"]
		with tempfile.TemporaryDirectory() as folder:
			alone, shared = os.path.join(folder, "alone.csv"), os.path.join(folder, "shared.csv")
			program.report(*words, "--set", "measure=step", "--series", alone)
			done = run((3, [*words, "--workers", "1", "--set", "measure=step", "--series", shared]))
			self.assertEqual(done.returncode, 0, done.stderr)
			self.assertEqual(done.stdout.count("simulated"), 1 + done.stdout.count("per simulated"))
			with open(alone, encoding="utf-8") as a, open(shared, encoding="utf-8") as b:
				self.assertEqual(a.read(), b.read())

	def test_contacts_are_drawn(self):
		"""Contacts of other ranks are drawn, too."""
		words = [program.scene("falling_boxes"), "-D", "n=20", "--duration", "1.6", "--set", "measure=end", "--fps", "2", "--size", "160x120",
			"--overlay", "contacts", "--workers", "1"]
		with tempfile.TemporaryDirectory() as folder:
			pictures = []
			for name, ranks in ("alone", 1), ("shared", 3):
				done = run((ranks, [*words, "--out", os.path.join(folder, name)]))
				self.assertEqual(done.returncode, 0, done.stderr)
				with open(os.path.join(folder, name, "frame-000002.png"), "rb") as f:
					pictures.append(f.read())
			self.assertEqual(*pictures)

	def test_scripts_are_drawn(self):
		"""Rank 0 alone draws, and it alone would pause for that: all ranks reach the same scripts in the same
		step. A resumed run has a first frame, too."""
		words = [program.scene("flock"), "--set", "measure=end", "--workers", "1"]
		draws = ["--fps", "6", "--size", "64x48", "--json", "-"]
		with tempfile.TemporaryDirectory() as folder:
			whole = program.report(*words, "--duration", ".5")["state_hash"]
			program.report(*words, "--duration", ".25", "--checkpoint", os.path.join(folder, "kept"))
			for begin in words, ["--resume", os.path.join(folder, "kept"), *words[1:]]:
				with self.subTest(begin=begin):
					more = ["--duration", ".5", "--out", os.path.join(folder, str(len(begin))), *draws]
					self.assertEqual(self.hash_of((2, [*begin, *more])), whole)

	def test_goes_on_from_a_checkpoint(self):
		words = [program.scene("falling_boxes"), "-D", "n=20"]
		expected = program.report(*words, "--duration", "1", "--workers", "1")["state_hash"]
		with tempfile.TemporaryDirectory() as folder:
			kept = os.path.join(folder, "kept")
			done = run((2, [*words, "--duration", ".5", "--workers", "1", "--checkpoint", kept]))
			self.assertEqual(done.returncode, 0, done.stderr)
			for file in kept, kept + ".1":
				more = ["--resume", file, "--duration", "1", "--workers", "1", "--json", "-"]
				self.assertEqual(self.hash_of((3, more)), expected)

	def test_goes_on_while_boxes_land(self):
		"""From one process's checkpoints: bodies about to touch belong to two ranks now."""
		with tempfile.TemporaryDirectory() as folder:
			kept = os.path.join(folder, "kept")
			for moment in 1.1, 1.2, 1.3:
				program.report(program.scene("falling_boxes"), "-D", "n=300", "--duration", str(moment), "--workers", "1", "--set", "measure=end",
					"--checkpoint", kept)
				more = ["--resume", kept, "--duration", str(moment + .05), "--workers", "1", "--set", "measure=end"]
				alone = program.report(*more)["state_hash"]
				for ranks in 2, 3:
					self.assertEqual(self.hash_of((ranks, [*more, "--json", "-"])), alone)

	def test_checkpoints_are_alike(self):
		"""The checkpoint of each rank equals that of one process, except for its time and its counters."""
		later = ".4", "1.1" # records have changed their rank before
		for name, more, moments in ("falling_boxes", ["-D", "n=20", "--set", "sleeping=off"], later), \
				("falling_boxes", ["-D", "n=20", "--set", "solver=ghost"], ["1.5"]), ("gas", ["-D", "n=100"], later), ("machines", [], later), \
				("pile", [], later), (PARTED, ["--set", "narrow=aabb"], [".4166"]):
			for seconds in moments:
				with self.subTest(name=name, seconds=seconds), tempfile.TemporaryDirectory() as folder:
					kept, alone = os.path.join(folder, "kept"), os.path.join(folder, "alone")
					words = [program.scene(name), *more, "--duration", seconds, "--set", "measure=end", "--workers", "1", "--checkpoint"]
					program.report(*words, alone)
					done = run((3, [*words, kept]))
					self.assertEqual(done.returncode, 0, done.stderr)
					for file in kept, kept + ".1", kept + ".2":
						self.assertEqual(program.checkpoint_areas(file), program.checkpoint_areas(alone))

	def test_moves(self):
		"""Simulators move from rank to rank, by requests to rank 0."""
		words = [program.scene("falling_boxes"), "-D", "n=30", "--duration", "3", "--set", "sleeping=off"]
		alone = program.report(*words, "--workers", "1")["state_hash"]
		with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as said:
			running = subprocess.Popen(command((2, [*words, "--workers", "2", "--pace", ".25", "--name", self.name, "--json", "-"])),
				env=program.RANKS, stdin=subprocess.DEVNULL, stdout=out, stderr=said, text=True)
			try:
				self.assertTrue(program.wait_until(lambda: program.steps(self.name) > 0 or running.poll() is not None))
				self.assertIsNone(running.poll())
				moves, seen = 0, 0
				while running.poll() is None:
					box, worker = random.randint(1, 30), random.randint(0, 3)
					moves += program.call("send", self.name, "move", box, worker).returncode == 0
					home = program.home_of(self.name, box)
					seen += home == str(worker)
				self.assertEqual(running.wait(program.PATIENCE), 0)
			finally:
				running.kill()
				running.wait()
			self.assertGreater(moves, 1)
			self.assertGreater(seen, 0)
			out.seek(0)
			self.assertEqual(json.load(out)["state_hash"], alone)

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
		"""If simulators of one rank write where they should not, the run ends with an error, or in the right
		bits: they can change nothing but their own results."""
		words = [program.scene("gas"), "--duration", "2", "--workers", "1", "--isolation", "process", "--set", "measure=end",
			"--json", "-"]
		right, ended = self.hash_of((2, words)), 0
		for seed in range(1, 6):
			done = run((1, words), (1, [*words, "--fault", f"scribble:p=.05,seed={seed}"]))
			if done.returncode:
				ended += 1
				self.assertRegex(done.stderr, "is of rank 1, which|has left the run|was killed by|does not bear its checksum|interrupted|makes no sense|no state that makes sense|was not given")
			else:
				self.assertEqual(json.loads(done.stdout)["state_hash"], right)
		self.assertGreater(ended, 0)

	def test_another_processor(self):
		"""The second rank uses no fused operations, as on an older processor."""
		words = [program.scene("flock"), "--duration", "1", "--workers", "1", "--set", "measure=end", "--json", "-"]
		older = ["env", "GLIBC_TUNABLES=" + program.OLDER_PROCESSOR, program.OBSIM, "run", *words]
		launched = [*command((1, words)), ":", "-n", "1", *older]
		done = subprocess.run(launched, env=program.RANKS, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
			text=True, timeout=program.PATIENCE)
		self.assertEqual(done.returncode, 0, done.stderr)
		self.assertEqual(json.loads(done.stdout)["state_hash"], program.report(*words[:-4], "--set", "measure=end")["state_hash"])

	def test_one_wrong_bit(self):
		"""Flips the last bit of each velocity in the second rank's memory. A late flip is overwritten, and a
		flip far from all bodies of this rank has no effect. So flips are repeated, as motions are published."""
		words = [program.scene("gas"), "--duration", program.FOR_EVER, "--workers", "1", "--set", "measure=end"]
		running, bodies = self.start_stepping_ranks(words), 200
		segment = program.segment(f"obsim-{self.ranks_of(running)[1][0]}")
		with open(segment, "r+b") as f, mmap.mmap(f.fileno(), 0) as memory:
			slots = struct.unpack_from("=Q", memory, 32 + 8 * 5)[0] # table/layout.h, table/slot.h
			harmed = {}
			while running.poll() is None:
				for slot in range(slots, slots + 360 * bodies, 360):
					version = struct.unpack_from("=Q", memory, slot)[0]
					if harmed.get(slot) != version:
						memory[slot + 8 + 176 * (version % 2) + 72] ^= 1 # ob_motion.v
						harmed[slot] = version
				time.sleep(.01)
			_, said = running.communicate(timeout=program.PATIENCE)
		self.assertRegex(said, r'is of rank 1, which (in step \d+ has other bits than it had found of the motion of|'
			r'has other bits than rank \d in step \d+, first of) object "')

	def test_a_death_ends_all(self):
		words = [program.scene("gas"), "--duration", program.FOR_EVER, "--workers", "1"]
		running = self.start_stepping_ranks(words)
		os.kill(self.process_of(self.ranks_of(running)[1], "sim 1"), signal.SIGKILL)
		_, said = running.communicate(timeout=program.PATIENCE)
		self.assertNotEqual(running.returncode, 0)
		self.assertIn("was killed by SIGKILL", said)
		self.assertIn("another rank has left the run", said)

	def test_goes_on_after_a_death(self):
		"""A random process of a rank is killed at a random moment. The run ends, only checkpoints are left, and
		the checkpoint of any other rank leads to the same end. The run keeps real time, so that it has not
		ended before."""
		words = [program.scene("falling_boxes"), "-D", "n=20", "--set", "sleeping=off", "--set", "measure=end"]
		right = program.report(*words, "--duration", "4", "--workers", "1")["state_hash"]
		for victim, again in ("obsim", 2), ("obsim-fork", 4), ("sim 3", 3):
			with self.subTest(victim=victim), tempfile.TemporaryDirectory() as folder:
				kept = os.path.join(folder, "kept")
				running = self.start_stepping_ranks([*words, "--duration", "4", "--pace", "1", "--workers", "1", "--checkpoint", kept,
					"--set", "every=.1"])
				time.sleep(random.uniform(0, 2))
				ranks, below = self.ranks_of(running), program.processes(running.pid)
				hit = random.randrange(3)
				os.kill(self.process_of(ranks[hit], victim), signal.SIGKILL)
				_, said = running.communicate(timeout=program.PATIENCE)
				self.assertNotEqual(running.returncode, 0)
				files = [kept, kept + ".1", kept + ".2"]
				self.check_nothing_left(below)
				# a rank that is killed while it writes leaves its unfinished file
				self.assertLessEqual({os.path.join(folder, name) for name in os.listdir(folder)}, {*files, files[hit] + ".part"})
				others = [file for file in files if file != files[hit]]
				for file in others:
					self.assertIn(f"obsim run --resume {file}\n", said)
					self.assertEqual(program.call("inspect", file).returncode, 0)
				self.assertEqual(self.hash_of((again, ["--resume", random.choice(others), "--workers", "1", "--json", "-"])), right)

	def test_a_stopped_rank_delays(self):
		words = [program.scene("falling_boxes"), "-D", "n=20", "--set", "sleeping=off", "--duration", "2", "--set", "measure=end", "--json", "-"]
		right = program.report(*words[:-2], "--workers", "1")["state_hash"]
		running = self.start_stepping_ranks([*words, "--pace", "1", "--workers", "1"])
		stopped = self.ranks_of(running)[1]
		for number in signal.SIGSTOP, signal.SIGCONT:
			for pid in stopped:
				os.kill(pid, number)
			time.sleep(3 if number == signal.SIGSTOP else 0)
		out, said = running.communicate(timeout=program.PATIENCE)
		self.assertEqual(running.returncode, 0, said)
		self.assertEqual(json.loads(out)["state_hash"], right)

	def start_stepping_ranks(self, words):
		"""Starts three ranks, and returns once each has made a step."""
		running = subprocess.Popen(command((3, words)), env=program.RANKS, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
			stderr=subprocess.PIPE, text=True)
		self.addCleanup(lambda: (running.poll() is None and running.terminate(), running.wait(), running.stdout.close(), running.stderr.close()))
		self.assertTrue(program.wait_until(lambda: self.have_stepped(running) or running.poll() is not None))
		self.assertIsNone(running.poll(), "the run ended before it was looked at")
		return running

	@staticmethod
	def have_stepped(running):
		names = [f"obsim-{pid}" for pid in program.processes(running.pid)]
		return sum(program.steps(name) > 0 for name in names) == 3

	@staticmethod
	def ranks_of(running):
		"""Processes of each rank, the rank itself first; mpirun starts the ranks in order."""
		first = [pid for pid in program.processes(running.pid) if program.comm(pid) == "obsim"]
		return [[pid, *program.processes(pid)] for pid in sorted(first)]

	def process_of(self, rank, name):
		found = [pid for pid in rank if program.comm(pid) == name]
		self.assertEqual(len(found), 1, name)
		return found[0]

	def check_nothing_left(self, below):
		self.assertTrue(program.wait_until(lambda: not any(map(program.alive, below))))
		self.assertEqual([pid for pid in below if os.path.exists(program.segment(f"obsim-{pid}"))], [])


unittest.main()
