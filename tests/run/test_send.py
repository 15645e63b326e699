"""obsim send: another program sends requests to a running universe."""

import os
import re
import socket
import subprocess
import sys
import unittest

import program

SCENE = """
ground {}
script("it", "function on_message(from, ...) print('got', from:exists(), ...) end")
sphere { name = "listener", radius = .3, at = { 0, 0, .3 }, script = "it" }
box { name = "crate", size = { 1, 1, 1 }, at = { 3, 0, .5 } }
box { name = "lift", size = { 1, 1, .1 }, at = { 6, 0, 1 }, kind = "kinematic" }
"""


class Send(program.Case):
	def setUp(self):
		super().setUp()
		with open(self.path("scene.lua"), "w") as f:
			f.write(SCENE)
		self.run_ = self.start_universe(self.path("scene.lua"), "--pace", "realtime", "--duration", program.FOR_EVER,
			"--workers", "2")
		self.assertTrue(program.wait_until(lambda: "listener" in self.objects()))

	def tearDown(self):
		if self.run_.poll() is None:
			self.run_.terminate()
			self.run_.wait(program.PATIENCE)
		super().tearDown()

	def objects(self):
		done = program.call("top", self.name, "--once", "--interval", ".01")
		return [line.split()[1] for line in done.stdout.splitlines() if line.split()[:1] and line.split()[0].isdigit()]

	def send(self, *words, code=0, saying=""):
		done = program.call("send", *words)
		self.assertEqual(done.returncode, code, done.stderr)
		if saying:
			self.assertRegex(done.stderr, saying)

	def test_contacts(self):
		"""The crate stands on its four corners; the lift touches nothing."""
		found = lambda *words: [line.split("  ") for line in program.call("send", self.name, "contacts", *words).stdout.splitlines()]
		self.assertTrue(program.wait_until(lambda: len(found("crate")) == 4))
		for first, second, place, normal, impulse in found("crate"):
			self.assertEqual({first, second}, {"crate", "ground"})
			x, y, z = map(float, place.split())
			for distance in abs(x - 3), abs(y):
				self.assertAlmostEqual(distance, .5, delta=.01)
			self.assertAlmostEqual(z, 0, delta=.01)
			self.assertAlmostEqual(abs(float(normal.split()[2])), 1, delta=1e-6)
			self.assertGreaterEqual(float(impulse), 0)
		self.assertEqual(found("lift"), [])
		self.assertGreater(len(found()), 4)
		self.send(self.name, "contacts", "crat", code=1, saying='did you mean "crate"')

	def test_all(self):
		self.send(self.name, "message", "listener", "hello", "3", "2.5", "true", "-1", "-.5", "--", "-x")
		self.send(self.name, "create", "sphere { name = 'new', radius = .2, at = { 0, 3, 2 } }")
		self.assertTrue(program.wait_until(lambda: "new" in self.objects()))
		self.send(self.name, "create", "hull { name = 'shard', points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, at = { 0, 6, 2 } }")
		self.assertTrue(program.wait_until(lambda: "shard" in self.objects()))
		self.send(self.name, "colour", "new", "#00ff00")
		self.send(self.name, "remove", "crate")
		self.assertTrue(program.wait_until(lambda: "crate" not in self.objects()))
		self.send(self.name, "remove", "crate", code=1, saying='has no object "crate"')
		self.send(self.name, "message", "new", "x", code=1, saying="has no script")
		self.send(self.name, "create", "plane {}", code=1, saying="only objects with a size")
		self.send(self.name, "create", "hull { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } } }", code=1, saying="four different points")
		self.send(self.name, "create", "sphere { radius = -1 }", code=1, saying=r"sphere\.radius: expected a number from 1e-06")
		self.send(self.name, "colour", "new", "green", code=1, saying="#rrggbb")
		self.send(self.name, "move", "listener", "1")
		self.assertTrue(program.wait_until(lambda: program.home_of(self.name, 1) == "1"))
		self.send(self.name, "move", "listener", "0")
		self.assertTrue(program.wait_until(lambda: program.home_of(self.name, 1) == "0"))
		self.assertEqual(program.home_of(self.name, 0), "-")
		self.send(self.name, "move", "listener", "2", code=1, saying="there is no worker 2 for objects: they are 0 to 1")
		self.send(self.name, "move", "listener", "x", code=1, saying='expected the number of a worker, got "x"')
		self.send(self.name, "move", "0", "1", code=1, saying="has no simulator")
		self.send(self.name, "drag", "new", "0", "3", "2", "0", "0", ".2")
		self.send(self.name, "push", "new", "0", "0", "1")
		self.send(self.name, "torque", "new", "0", "0", ".1")
		self.send(self.name, "release", "new")
		for verb in "place", "velocity", "force", "kick":
			self.send(self.name, verb, "new", "0", "-1", "-.5")
		self.send(self.name, "friction", "new", ".1")
		self.send(self.name, "friction", "new", "-1", code=1, saying="friction: expected")
		self.send(self.name, "drag", "0", "0", "3", "2", code=1, saying="does not move by forces")
		self.send(self.name, "drag", "new", "0", "3", "x", code=1, saying='three numbers after the object, got "x"')
		self.send(self.name, "kill", "new", code=1, saying="--isolation process")
		self.send(self.name, "attitude", "new", ".6", "0", "0", ".8")
		self.send(self.name, "spin", "new", "0", "0", "1")
		self.send(self.name, "attitude", "new", "1", "1", "0", "0", code=1, saying="unit quaternion")
		self.send(self.name, "surface", "lift", ".1", "0", "0")
		self.send(self.name, "surface", "new", ".1", "0", "0", code=1, saying="static or kinematic")
		self.send(self.name, "remove", "lisener", code=1, saying='did you mean "listener"?')
		for verb in "keep", "return", "restart":
			self.send(self.name, verb, code=1, saying="obsim serve can")
		for words in ["pause"], ["resume"], ["step"], ["until", "9"], ["rate", "2"]:
			self.send(self.name, *words, code=1, saying="obsim serve takes such requests")
		self.send("nobody", "remove", "x", code=1, saying="nobody")
		for words, saying in ((), "no universe given"), ((self.name,), "create, remove, colour, message"), \
				((self.name, "drag", "new", "1", "2"), "drag OBJECT X Y Z"), \
				((self.name, "remov", "x"), "did you mean remove"), ((self.name, "remove"), "remove OBJECT"):
			self.send(*words, code=2, saying=saying)
		self.run_.terminate()
		self.assertIn("got false hello 3 2.5 true -1 -0.5 -x", self.run_.communicate(timeout=program.PATIENCE)[1])

	def height_of_lift(self):
		for line in program.call("top", self.name, "--once", "--interval", ".01").stdout.splitlines():
			words = line.split()
			if words[1:2] == ["lift"]:
				return float(words[7])
		return None

	def test_path(self):
		"""A kinematic object goes where it is sent, and stands there."""
		self.send(self.name, "path", "lift", ".2 6 0 2.5", "1 6 0 4.25")
		self.assertTrue(program.wait_until(lambda: self.height_of_lift() == 4.25))
		self.send(self.name, "path", "lift", ".2 6 0 2.5 .8 .6 0 0", "1 6 0 4.25 1 0 0 0", "loop")
		for words, saying in ((["x"], "expected points as"), (["1 2 3"], "expected points as"), (["1 6 0 2", "2 6 0 2 1 0 0 0"], "each of them"),
				(["1 6 0 2", "1 6 0 3"], "times that grow"), (["0 6 0 2"], "times that grow"), (["loop"], "expected 2 to 1024, got 1"),
				(["1 6 0 2 1 1 0 0"], "unit quaternion"), (["1 6 0 9e9"], "points: expected from")):
			self.send(self.name, "path", "lift", *words, code=1, saying=saying)
		self.send(self.name, "path", "crate", "1 6 0 2", code=1, saying="expected a kinematic object")
		self.send(self.name, "path", "lift", code=2, saying="path OBJECT")

	def call_silently(self, count):
		"""Connects a number of times, and sends nothing."""
		for _ in range(count):
			s = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
			self.addCleanup(s.close)
			s.connect("\0obsim." + self.name) # blocks while too many wait for accept

	def test_joints(self):
		joined = "slider { 'listener', name = 'rail', axis = { 0, 1, 0 }, motor = { rate = 0 } }"
		self.send(self.name, "unjoin", "rail", code=1, saying='has no joint "rail"')
		self.send(self.name, "create", joined.replace("listener", "lisener"), code=1, saying='expected the name of an object, got "lisener"')
		self.send(self.name, "create", joined)
		self.assertTrue(program.wait_until(lambda: program.call("send", self.name, "motor", "rail", ".5").returncode == 0))
		self.send(self.name, "motor", "rial", "1", code=1, saying='has no joint "rial": did you mean "rail"')
		self.send(self.name, "motor", "rail", "fast", code=1, saying='expected a number, got "fast"')
		self.send(self.name, "unjoin", "rail")
		self.assertTrue(program.wait_until(lambda: program.call("send", self.name, "unjoin", "rail").returncode == 1))

	def test_manual(self):
		"""The manual has all requests."""
		with open(os.environ["MANUAL"]) as f:
			section = re.sub(r"\\f[BIR]", "", f.read().split(".SH SEND")[1].split(".SH ")[0])
		for request in re.findall("^  obsim send NAME ([a-z]+)", program.call("send", "--help").stdout, re.M):
			self.assertRegex(section, rf"\.B\w* .*\b{request}\b", request)

	def test_silent(self):
		"""Silent callers delay no request: all of them are still connected when another is answered."""
		self.call_silently(18)
		silent = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
		self.addCleanup(silent.close)
		silent.connect("\0obsim." + self.name)
		self.send(self.name, "colour", "crate", "#00ff00")
		silent.setblocking(False)
		with self.assertRaises(BlockingIOError):
			silent.recv(1)
		self.call_silently(200)
		self.send(self.name, "colour", "crate", "#ff0000")
		self.assertIsNone(self.run_.poll())

	def test_squatter(self):
		"""A process that binds the address first is detected, and the run warns."""
		name = self.name + "x"
		with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as s:
			s.bind("\0obsim." + name)
			s.listen()
			run = program.start("run", self.path("scene.lua"), "--pace", "realtime", "--duration", program.FOR_EVER, "--name", name)
			self.assertTrue(program.wait_until(lambda: program.steps(name) > 0 or run.poll() is not None))
			self.send(name, "remove", "crate", code=1, saying=f"process {os.getpid()} of user \\d+ listens at its address, not its host {run.pid}")
			run.terminate()
			self.assertIn(f'obsim send cannot reach universe "{name}": another process has taken its address', run.communicate(timeout=program.PATIENCE)[1])

	def test_rubbish(self):
		"""Other data on the socket is refused, and the run goes on."""
		for rubbish in b"", b"x", b"OBSIMAS1" + bytes(500), bytes(100000):
			with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as s:
				s.settimeout(program.PATIENCE)
				s.connect("\0obsim." + self.name)
				if rubbish:
					s.send(rubbish)
					self.assertIn(b"not of this version", s.recv(10000))
		self.assertIn("listener", self.objects())
		self.assertIsNone(self.run_.poll())


STRANGER = """
import socket, sys
name, *packets = sys.argv[1:]
for packet in packets:
	with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as s:
		s.connect("\\0obsim." + name)
		try:
			if packet:
				s.send(bytes.fromhex(packet))
			print(s.recv(10000).split(b"\\0")[0].decode())
		except (BrokenPipeError, ConnectionResetError): # it was refused before it had sent all
			print("this universe belongs to another user")
try:
	open("/dev/shm/obsim." + name, "rb")
except PermissionError:
	print("no memory")
"""


class Strangers(program.Case):
	"""Programs of another user, and of another version."""

	def setUp(self):
		super().setUp()
		with open(self.path("scene.lua"), "w") as f:
			f.write(SCENE)
		self.control = program.start("control", self.path("scene.lua"), "--name", self.name, "--isolation", "process")
		self.assertIn("waits as universe", self.control.stdout.readline())

	def tearDown(self):
		self.control.terminate()
		self.control.communicate(timeout=program.PATIENCE)
		super().tearDown()

	@unittest.skipUnless(os.geteuid() == 0, "needs root, to be another user")
	def test_another_user(self):
		"""Another user gets one line for each request, and no state. Then the run's own user leads it."""
		stranger = {"user": 65534, "group": 65534, "extra_groups": [], "cwd": "/"}
		packets = [b"", b"OBSIMCT1" + bytes(32), b"OBSIMAS1" + bytes(4096), b"x"]
		done = subprocess.run([sys.executable, "-c", STRANGER, self.name, *(p.hex() for p in packets)], capture_output=True, text=True,
			timeout=program.PATIENCE, check=True, **stranger)
		self.assertEqual(done.stdout.splitlines(), 4 * ["this universe belongs to another user"] + ["no memory"])
		other = f'obsim: universe "{self.name}" belongs to another user\n'
		for words, saying in ((["send", self.name, "remove", "crate"], other), (["send", self.name, "kill", "crate"], other),
				(["top", self.name, "--once"], "obsim: no universe is running: start one with obsim run SCENE.lua\n")):
			done = program.call(*words, **stranger)
			self.assertEqual((done.returncode, done.stdout, done.stderr), (1, "", saying))
		led = program.Led(self.name)
		led.step(10)
		self.assertEqual((program.steps(self.name), program.deaths(self.name)), (10, 0))
		led.close()

	def test_another_version(self):
		"""A program of the version before gets one line, which names both versions, and does not take control."""
		with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as s:
			s.settimeout(program.PATIENCE)
			s.connect("\0obsim." + self.name)
			s.send(b"OBSIMCT0" + bytes(32))
			self.assertEqual(s.recv(10000).split(b"\0")[0].decode(),
				"this run has control protocol 1, and the program 0: use the same obsim for both")
			self.assertEqual(s.recv(1), b"")
		led = program.Led(self.name)
		led.step(1)
		led.close()


class Starting(program.Case):
	def test_sent_while_it_starts(self):
		"""A universe that has its name but no objects yet gets the request once it runs."""
		scene = self.path("many.lua")
		with open(scene, "w") as f:
			f.write("for i = 1, 3000 do sphere { radius = .1, at = { i, 0, 0 } } end\nscene { gravity = { 0, 0, 0 } }\n")
		for _ in range(3):
			run = self.start_universe(scene, "--pace", "realtime", "--duration", program.FOR_EVER, "--workers", "2")
			done = program.call("send", self.name, "colour", "sphere#2999", "#ffd700")
			self.assertEqual(done.returncode, 0, done.stderr)
			run.terminate()
			run.wait(program.PATIENCE)


unittest.main()
