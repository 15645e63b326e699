"""The built obsim as a program: runs it as a user would, with a limit on time, and checks the remains.

The environment names the program and the scenes (OBSIM, SCENES); meson sets it.
"""

import glob
import json
import os
import pty
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

OBSIM = os.environ["OBSIM"]
SCENES = os.environ["SCENES"]
MESHES = os.environ.get("MESHES") # set if obsim can read them
FOR_EVER = "7e7"  # s to simulate, about the largest possible duration: at rest, millions of steps pass in a second
RANKS = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
	"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}  # for mpirun, on however few cores
OLDER_PROCESSOR = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2"  # the C library then uses none of these instructions (GLIBC_TUNABLES)
SANITIZED = bool(os.environ.get("SANITIZED"))
PATIENCE = 600  # s, for one call; a sanitizer slows it down about ten times, and so may other users of the machine

# Runs its arguments; then the last line of standard error is the peak, kB.
PEAK = """import resource, subprocess, sys
limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (300, 300))
code = subprocess.run(sys.argv[1:], preexec_fn=limit).returncode
print(end="\\n" + str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss), file=sys.stderr)
sys.exit(code if code >= 0 else 128 - code)"""
LEAK_DETECTOR_FAILED = "LeakSanitizer has encountered a fatal error"


def scene(name):
	return os.path.join(SCENES, name + ".lua")


def ways(*all_of_them):
	"""Ways to run one thing whose bits are compared. With a sanitizer, which checks the code that all of them
	share, only the first and the last."""
	return all_of_them[::len(all_of_them) - 1] if SANITIZED else all_of_them


def call(*words, timeout=PATIENCE, **more):
	"""obsim WORDS to its end; text in and out, without the lines of progress that a slow machine prints."""
	more.setdefault("stdout", subprocess.PIPE)
	more.setdefault("stderr", subprocess.PIPE)
	done = subprocess.run([OBSIM, *map(str, words)], timeout=timeout, text=True, **more)
	for _ in range(3): # gcc's leak detector itself sometimes fails, at exit, among the threads of a graphics driver
		if not SANITIZED or LEAK_DETECTOR_FAILED not in (done.stderr or ""):
			break
		done = subprocess.run([OBSIM, *map(str, words)], timeout=timeout, text=True, **more)
	if done.stderr:
		done.stderr = re.sub(r"^\[#* *\] \d+ of \d+, .* left: .*\n", "", done.stderr, flags=re.MULTILINE)
	return done


def peak(*words, timeout=PATIENCE):
	"""obsim WORDS to its end, as its exit code, its standard error, and the most memory that a process of it held, MB.
	A process that computes for very long is ended."""
	done = subprocess.run([sys.executable, "-c", PEAK, OBSIM, *map(str, words)], timeout=timeout, text=True, stdout=subprocess.DEVNULL,
		stderr=subprocess.PIPE)
	*lines, last = done.stderr.split("\n")
	return done.returncode, "\n".join(lines), int(last) >> 10


def start(*words, **more):
	"""obsim WORDS, left running; the caller ends it."""
	return subprocess.Popen([OBSIM, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)


def report(*words, **more):
	"""The report of a run that must succeed."""
	done = call("run", *words, "--json", "-", **more)
	if done.returncode != 0:
		raise AssertionError(f"obsim run {' '.join(map(str, words))}: exit {done.returncode}\n{done.stderr}")
	return json.loads(done.stdout)


def charts(page):
	"""Descriptions of the diagrams that the script of a report's page draws."""
	return [json.loads(text) for text in re.findall(r'<script class="chart" type="application/json">(.*?)</script>', page)]


def home_of(name, object):
	"""The worker of an object according to obsim top, as text; None: the universe, or the object, does not
	exist."""
	for line in call("top", name, "--once", "--interval", ".01").stdout.splitlines():
		words = line.split()
		if len(words) > 5 and words[0] == str(object) and words[2] in ("box", "sphere", "plane"):
			return words[4]
	return None


def segment(name):
	return "/dev/shm/obsim." + name


def steps(name):
	"""Steps that this universe has made, or 0; as its readers find them (table/layout.h)."""
	try:
		with open(segment(name), "rb") as f:
			f.seek(32) # ob_header.area
			f.seek(struct.unpack("=Q", f.read(8))[0])
			return struct.unpack("=Q", f.read(8))[0]
	except (OSError, struct.error):
		return 0


def checkpoint_areas(file):
	"""Contents of a checkpoint without its time and its counters: the elements of each area, and their checksum
	(checkpoint/file.h, checkpoint/saved_run.c)."""
	with open(file, "rb") as f:
		table = f.read(4096)[128:]
	lines = [struct.unpack_from("=4Q", table, 32 * i) for i in range(22)]
	return [(element, count, checksum) for i, (element, count, _, checksum) in enumerate(lines) if i not in (0, 4)]


def processes(parent):
	"""Ids of all processes that descend from this one now."""
	children = {}
	for stat in glob.glob("/proc/[0-9]*/stat"):
		try:
			with open(stat) as f:
				pid, rest = f.read().split(" ", 1)
		except OSError:
			continue
		children.setdefault(int(rest.rpartition(")")[2].split()[1]), []).append(int(pid))
	found, ahead = [], [parent]
	while ahead:
		below = children.get(ahead.pop(), [])
		found += below
		ahead += below
	return found


def alive(pid):
	"""Neither gone nor a zombie."""
	try:
		with open(f"/proc/{pid}/stat") as f:
			return f.read().rpartition(")")[2].split()[0] != "Z"
	except OSError:
		return False


def comm(pid):
	"""Command name of the process; "": it has ended."""
	try:
		with open(f"/proc/{pid}/comm") as f:
			return f.read().rstrip("\n")
	except OSError:
		return ""


def parent(pid):
	"""Id of its parent; 0: it has ended."""
	try:
		with open(f"/proc/{pid}/stat") as f:
			return int(f.read().rpartition(")")[2].split()[1])
	except OSError:
		return 0


def simulators(parent):
	"""Ids of all simulators of this run that are processes of their own."""
	return [pid for pid in processes(parent) if comm(pid).startswith("sim ")]


def fork_server(parent):
	"""Id of the fork server of this run."""
	for pid in processes(parent):
		if comm(pid) == "obsim-fork":
			return pid
	raise AssertionError("no fork server")


def end(pid):
	"""Kills the process, if it still exists."""
	try:
		os.kill(pid, signal.SIGKILL)
		return True
	except ProcessLookupError:
		return False


class Led:
	"""Control of a run of obsim control by its packets (control/packet.h), as a program without libobsim."""

	HELLO, STEP, KILL, SAVE = 0, 1, 19, 22

	def __init__(self, name):
		self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
		self.socket.settimeout(PATIENCE)
		self.socket.connect("\0obsim." + name)
		self.call(self.HELLO)

	def call(self, command, number=0, count=0, payload=b""):
		self.socket.send(struct.pack("=8s4IQd", b"OBSIMCT1", command, count, len(payload), 0, number, 0) + payload)
		answer = self.socket.recv(10000)
		error = answer[:answer.find(b"\0")].decode()
		if error or not answer:
			raise AssertionError(error or "the run has ended")

	def step(self, steps):
		self.call(self.STEP, steps)

	def kill(self, object):
		"""Kills the worker that simulates the object."""
		self.call(self.KILL, 0, 1, struct.pack("=2I13d", object, 0, *13 * [0]))

	def save(self, path):
		self.call(self.SAVE, 0, 1, path.encode() + b"\0")

	def close(self):
		"""Ends the run."""
		self.socket.close()


def deaths(name):
	"""Deaths of simulators so far, according to obsim top."""
	found = re.search(r"^deaths (\d+)", call("top", name, "--once", "--interval", ".01").stdout, re.MULTILINE)
	return int(found[1]) if found else 0


def wait_until(condition, seconds=PATIENCE):
	"""True once the condition holds. Patient: these tests do not depend on the speed of a machine."""
	end = time.monotonic() + seconds
	while not condition():
		if time.monotonic() > end:
			return False
		time.sleep(.01)
	return True


class Case(unittest.TestCase):
	"""A test in an empty directory of its own; no universe may be left."""

	def setUp(self):
		self.directory = tempfile.TemporaryDirectory(prefix="obsim-test-")
		self.addCleanup(self.directory.cleanup)
		self.name = f"test-{os.getpid()}-{self._testMethodName}"[:47]

	def tearDown(self):
		self.assertFalse(os.path.exists(segment(self.name)), "the universe's memory is left behind")

	def open_terminal(self):
		"""The two ends of a terminal. Call it first: a bare chroot may have none (no /dev/pts)."""
		try:
			return pty.openpty()
		except OSError as error:
			self.skipTest(str(error))

	def path(self, name):
		return os.path.join(self.directory.name, name)

	def start_universe(self, *words, command="run"):
		"""Starts a run under self.name, and returns once it is under way."""
		run = start(command, *words, "--name", self.name)
		self.addCleanup(lambda: (run.poll() is None and run.kill(), run.wait(), run.stdout.close(), run.stderr.close()))
		self.assertTrue(wait_until(lambda: os.path.exists(segment(self.name)) or run.poll() is not None))
		self.assertIsNone(run.poll(), "the run ended before it was looked at")
		return run

	def start_stepping(self, *words):
		"""The same, once it has made a step: all its processes exist."""
		run = self.start_universe(*words)
		self.assertTrue(wait_until(lambda: steps(self.name) > 0 or run.poll() is not None))
		self.assertIsNone(run.poll(), "the run ended before it was looked at")
		return run

	def refuse(self, *words, saying, code=2):
		"""obsim WORDS must end with this code and one line with the text."""
		done = call(*words, cwd=self.directory.name)
		self.assertEqual(done.returncode, code, f"{words}: {done.stderr}")
		self.assertIn(saying, done.stderr, words)
		self.assertEqual(done.stderr.count("\n"), 1, f"{words}: more than one line: {done.stderr}")
		self.assertTrue(done.stderr.startswith("obsim: "), done.stderr)
		self.assertEqual(done.stdout, "")
		return done
