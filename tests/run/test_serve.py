"""obsim serve: pages over HTTP, the universe over WebSockets, and attacks."""

import glob
import gzip
import math
import os
import random
import re
import signal
import socket
import struct
import time
import unittest

import glb
import program
from server import OPEN, Case, Refused, Viewer


class Serve(Case):
	def test_content(self):
		self.serve()
		head, page = self.http("GET / HTTP/1.1\nHost: HOST\nConnection: close")
		self.assertIn(" 200 ", head)
		self.assertIn(b"main.js", page)
		tag = next(l for l in head.split("\r\n") if l.lower().startswith("etag:")).split(" ", 1)[1]
		head, rest = self.http(f"GET /index.html HTTP/1.1\nHost: HOST\nConnection: close\nIf-None-Match: {tag}")
		self.assertIn(" 304 ", head)
		self.assertEqual(rest, b"")
		head, part = self.http("GET /index.html HTTP/1.1\nHost: HOST\nConnection: close\nRange: bytes=5-24")
		self.assertIn(" 206 ", head)
		self.assertEqual(part, page[5:25])
		head, rest = self.http("HEAD /style.css HTTP/1.1\nHost: HOST\nConnection: close")
		self.assertIn(" 200 ", head)
		self.assertEqual(rest, b"")
		for request, status in ("GET /../../etc/passwd", 404), ("GET /x", 404), ("POST /", 405), ("GET /main.js?x=1", 200):
			head, _ = self.http(f"{request} HTTP/1.1\nHost: HOST\nConnection: close\nContent-Length: 0")
			self.assertIn(f" {status} ", head, request)
		head, metrics = self.http("GET /metrics HTTP/1.1\nHost: HOST\nConnection: close")
		self.assertIn("text/plain", head)
		values = dict(line.rsplit(" ", 1) for line in metrics.decode().splitlines() if not line.startswith("#"))
		self.assertTrue(all(re.fullmatch(r'obsim_[a-z_]+\{universe="[\w.-]+"\}', name) for name in values), values)
		number = {name.split("{")[0]: float(value) for name, value in values.items()}
		self.assertEqual((number["obsim_running"], number["obsim_viewers"]), (1, 0))
		self.assertGreater(number["obsim_objects"], 0)
		self.assertEqual(len(re.findall("^# TYPE ", metrics.decode(), re.M)), len(values))
		head, _ = self.http("HEAD /metrics HTTP/1.1\nHost: HOST\nConnection: close")
		self.assertIn("405", head)
		head, _ = self.http("GET / HTTP/1.1\nHost: stranger.example\nConnection: close")
		self.assertIn(" 403 ", head)
		self.end()

	def test_life(self):
		"""One viewer creates and removes objects; the others see it; a falling object comes to rest at the
		right height."""
		self.serve("--pace", "max")
		one, other = self.viewer(), self.viewer()
		before = len(one.objects)
		one.send(do="create", shape="box", size=[.2, .2, .2], at=[4, 0, 1], mass=5, name="visitor")
		for v in one, other:
			v.until(lambda: len(v.objects) == before + 1)
		new = max(one.objects)
		self.assertEqual(one.objects[new]["name"], "visitor")
		other.until(lambda: other.objects[new].get("kind") == 0)
		self.assertAlmostEqual(other.objects[new]["p"][2], .2, delta=.01)
		other.send(do="inspect", id=new)
		other.until(lambda: other.told.get("details", {}).get("id") == new)
		self.assertAlmostEqual(other.told["details"]["p"][2], other.objects[new]["p"][2], delta=1e-4)
		other.send(do="remove", id=new, generation=one.objects[new]["generation"] + 1) # another object's
		other.send(do="remove", id=new, generation=one.objects[new]["generation"])
		for v in one, other:
			v.until(lambda: new not in v.objects)
		late = self.viewer()
		self.assertEqual(set(late.objects), set(one.objects))
		self.end()

	def test_free_run(self):
		"""While a simulator of a free run stands, a viewer sees that its neighbour waits for it, at the bound of the lag."""
		self.serve("--sync", "free", "--set", "max_lag=.02", "--isolation", "process", "--workers", "objects", "-D", "n=3",
			"--set", "coupling=own", scene="stack")
		v = self.viewer()
		v.send(do="inspect", id=2)
		v.until(lambda: v.told.get("details", {}).get("pid"))
		pid = v.told["details"]["pid"]
		v.send(do="inspect", id=3)
		v.until(lambda: v.told["details"]["id"] == 3 and "ahead_s" in v.told["details"])
		os.kill(pid, signal.SIGSTOP)
		v.until(lambda: v.told["details"].get("waits_for") == 2)
		os.kill(pid, signal.SIGCONT)
		v.until(lambda: "waits_for" not in v.told["details"])
		self.end()

	def test_frozen(self):
		"""An object whose simulator has died stays in place, and all viewers are notified, later ones, too."""
		self.serve("-D", "n=8", "--isolation", "process", "--workers", "objects", "--on-death", "freeze", "--room", "0",
			scene="falling_boxes")
		v = self.viewer()
		i = next(i for i, o in v.objects.items() if not o["static"])
		v.until(lambda: v.objects[i].get("kind") == 2) # it flies
		v.send(do="inspect", id=i)
		v.until(lambda: v.told.get("details", {}).get("id") == i)
		self.assertFalse(v.objects[i]["frozen"])
		os.kill(v.told["details"]["pid"], signal.SIGKILL)
		v.until(lambda: v.objects[i]["frozen"] and v.objects[i]["kind"] == 0)
		v.until(lambda: v.told["details"]["state"] == "frozen" and v.told["statistics"]["frozen"] == 1)
		late = self.viewer()
		late.until(lambda: "p" in late.objects[i])
		self.assertEqual(late.objects[i], v.objects[i])
		self.assertEqual([o["frozen"] for o in late.objects.values()].count(True), 1)
		self.end(saying="was killed by SIGKILL")

	def test_keeps(self):
		"""By default, objects that cannot be solved are frozen, and viewers see it; the universe goes on."""
		self.serve_file(os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes", "overworked.lua"), "--listen", "127.0.0.1:0", "--set", "patience=600")
		v = self.viewer()
		v.until(lambda: any(o["frozen"] for o in v.objects.values()))
		v.until(lambda: v.told["statistics"]["step"] > 3 and v.told["statistics"]["frozen"] > 0)
		v.until(lambda: "notice" in v.told)
		self.assertRegex(v.told["notice"], r"^step \d+ takes more work than a step may: object 1 \(brick 1\).*; frozen for it: 40$")
		self.end(saying="frozen: object 1 (brick 1)")

	def test_frozen_own(self):
		"""The creator of a frozen object is told that it is theirs, and why; others are told why."""
		self.serve("-D", "n=3", "--isolation", "process", "--workers", "objects", "--on-death", "freeze", scene="falling_boxes")
		creator, other = self.viewer(), self.viewer()
		creator.send(do="create", shape="sphere", size=[.2, 0, 0], at=[9, 9, 50], mass=5, name="guest")
		creator.until(lambda: any(o["name"] == "guest" for o in creator.objects.values()))
		i = next(i for i, o in creator.objects.items() if o["name"] == "guest")
		other.send(do="inspect", id=i)
		other.until(lambda: other.told.get("details", {}).get("pid"))
		os.kill(other.told["details"]["pid"], signal.SIGKILL)
		creator.until(lambda: creator.told.get("notice", "").startswith("your"))
		self.assertRegex(creator.told["notice"], rf"^your object {i} \(guest\) was frozen: .*was killed by SIGKILL")
		other.until(lambda: other.told["statistics"]["frozen"] == 1 and other.objects[i]["frozen"] and "notice" in other.told)
		later = other.told["statistics"]["step"] + 60
		other.until(lambda: other.told["statistics"]["step"] > later)
		self.assertRegex(other.told["notice"], r"was killed by SIGKILL.*; frozen for it: 1$")
		self.end(saying="was killed by SIGKILL")

	def test_overlap(self):
		"""Objects that begin deep inside each other are named, as by run."""
		with open(self.path("scene.lua"), "w") as f:
			f.write("for i = 1, 2 do box { size = { 1, 1, 1 }, at = { 0, 0, i * .2 }, name = 'b' .. i } end\n")
		self.serve_file(self.path("scene.lua"))
		self.viewer()
		self.end(saying='"b1" (object 0) and "b2" (object 1) begin 800 mm inside each other')

	def test_clock(self):
		self.serve("--paused")
		v = self.viewer()
		self.assertEqual((v.paused, v.time), (True, 0))
		v.send(do="step", steps=3)
		v.until(lambda: v.time > 0)
		v.until(lambda: "statistics" in v.told and v.told["statistics"]["step"] == 3)
		v.send(do="create", shape="sphere", size=[.1, 0, 0], at=[3, 3, 2], mass=1) # also while it stands
		v.until(lambda: any(o["name"] == "sphere" for o in v.objects.values()))
		self.assertEqual(v.told["statistics"]["step"], 3)
		v.send(do="rate", rate=1000)
		v.send(do="resume")
		v.until(lambda: v.time > 1)
		v.send(do="pause")
		v.until(lambda: v.paused)
		self.end()

	MACHINE = """ground {}
box { name = "post", size = { .2, .2, 2 }, at = { 0, 0, 1 }, kind = "static" }
box { name = "arm", size = { 1, .1, .1 }, at = { .5, .3, 1.5 }, mass = 1 }
hinge { "arm", "post", name = "elbow", at = { 0, .3, 1.5 }, axis = { 0, 1, 0 }, motor = { rate = 0, most = 1000 } }
box { name = "lift", size = { 1, 1, .1 }, at = { 6, 0, 1 }, kind = "kinematic" }
box { name = "load", size = { .2, .2, .2 }, at = { 6, 0, 1.15 }, mass = 1 }
"""

	def test_lead(self):
		"""All that a program may ask for by obsim control, by the page's commands: motors, paths, belts, kicks, and time."""
		self.serve_file(self.write(self.MACHINE), "--listen", "127.0.0.1:0", "--paused")
		v = self.viewer()
		to = {o["name"]: {"id": i, "generation": o["generation"]} for i, o in v.objects.items()}
		def at(name): # x and z; viewers are sent motions, not places
			lines = [line.split() for line in program.call("top", self.name, "--once", "--interval", ".01").stdout.splitlines()]
			return next((float(words[5]), float(words[7])) for words in lines if words[1:2] == [name])
		self.assertIn('no joint "elbo": did you mean "elbow"?', self.refused(v, do="motor", name="elbo", value=1))
		v.send(do="motor", name="elbow", value=2)
		v.send(do="until", value=.5)
		v.until(lambda: v.paused and v.time == .5)
		self.assertAlmostEqual(at("arm")[1], 1.5 - .5 * math.sin(1), 2) # half a metre from the axis, turned by a radian
		self.assertIn("expected a time after 0.5 s", self.refused(v, do="until", value=.25))
		v.send(do="unjoin", name="elbow")
		v.send(do="path", points=[.2, 6, 0, 1.1, 1, 6, 0, 2], **to["lift"])
		v.send(do="rate", rate=0)
		v.send(do="until", value=3)
		v.until(lambda: v.paused and v.time == 3)
		self.assertEqual(at("lift"), (6, 2))
		self.assertLess(at("arm")[1], .2)
		v.send(do="edit", surface=[1, 0, 0], **to["lift"])
		v.send(do="kick", impulse=[0, 0, 5], **to["arm"])
		v.send(do="step", steps=12)
		self.assertTrue(program.wait_until(lambda: at("arm")[1] > .5 and at("load")[0] > 6.01))
		self.assertIn("four numbers", self.refused(v, do="path", points=[1, 2, 3], **to["lift"]))
		v.send(do="resume")
		v.until(lambda: v.time > 4)
		self.assertIn("pause it first", self.refused(v, do="step"))
		self.end()

	def test_sent(self):
		"""Time is led by obsim send, too, and the page shows it."""
		self.serve_file(self.write(self.MACHINE))
		v = self.viewer()
		def send(*words, saying=None):
			done = program.call("send", self.name, *words)
			self.assertEqual(done.returncode, 1 if saying else 0, done.stderr)
			self.assertIn(saying or "", done.stderr)
		send("step", saying="pause it first")
		send("pause")
		v.until(lambda: v.paused)
		before = program.steps(self.name)
		send("step")
		send("step", "9")
		self.assertTrue(program.wait_until(lambda: program.steps(self.name) == before + 10))
		for words, saying in ((["step", "0"], "expected 1 to 1000000"), (["step", "x"], "expected a number"), (["rate", "-1"], "expected a number from 0"),
				(["until", "0"], "expected a time after"), (["until", "nan"], "expected a time after")):
			send(*words, saying=saying)
		send("rate", "0")
		send("until", "100")
		v.until(lambda: v.paused and v.time == 100)
		send("rate", "1")
		send("resume")
		v.until(lambda: v.time > 100)
		self.end()

	def test_strangers(self):
		self.serve()
		with self.assertRaisesRegex(Refused, "403"):
			Viewer(self.port, headers=["Origin: http://stranger.example"])
		with self.assertRaisesRegex(Refused, "403"): # a name of its own for this address
			Viewer(self.port, headers=[f"Host: stranger.example:{self.port}", f"Origin: http://stranger.example:{self.port}"])
		Viewer(self.port, headers=[f"Origin: http://127.0.0.1:{self.port}"]).close()
		self.end()

	@unittest.skipUnless(os.path.exists("/proc/net/tcp6"), "no IPv6 here")
	def test_loopbacks(self):
		"""Programs of the same user operate, by whichever kind of socket."""
		for listen in "127.0.0.1", "[::1]", "[::ffff:127.0.0.1]":
			self.serve_file(program.scene("stack"), "--listen", listen + ":0")
			for address in ["::1"] if listen == "[::1]" else ["127.0.0.1", "::ffff:127.0.0.1"]:
				with self.subTest(listen=listen, address=address):
					v = self.viewer(address=address, headers=[f"Host: localhost:{self.port}"])
					self.assertEqual(v.told["welcome"]["role"], "operate")
			self.end()

	@unittest.skipUnless(program.MESHES, "built without tinygltf")
	def test_meshes(self):
		"""A mesh is content under its hash, for holders of the token."""
		with open(self.path("cube.glb"), "wb") as f:
			f.write(glb.cube(.5, (1, 0, 0), picture=glb.QUARTERS))
		with open(self.path("scene.lua"), "w") as f:
			f.write("ground {}\nfor i = 1, 3 do sphere { radius = .4, at = { 2 * i, 0, .4 }, mesh = 'cube.glb', mesh_scale = i } end\n")
		self.serve_file(self.path("scene.lua"))
		v = self.viewer()
		self.assertEqual([o["mesh"] for o in v.objects.values()], [0, 1, 2, 3])
		paths = v.told["welcome"]["meshes"]
		self.assertEqual(len(set(paths)), 3)
		get = lambda path, more="": self.http(f"GET {path} HTTP/1.1\nHost: HOST\nConnection: close{more}")
		for number, path in enumerate(paths, 1):
			self.assertRegex(path, "^meshes/[0-9a-f]{16}$")
			head, body = get("/" + path)
			self.assertIn(" 200 ", head)
			self.assertIn("immutable", head)
			self.assertEqual(struct.unpack_from("<BBBBII", body), (3, number, 1, 1, 36, 36))
			places = [struct.unpack_from("<12f", body, 12 + 48 * i) for i in range(36)]
			self.assertEqual({abs(x) for p in places for x in p[:3]}, {.5 * number})
			self.assertEqual({p[6:9] for p in places}, {(1, 0, 0)})
			self.assertEqual({p[10:] for p in places}, {(0, 0), (0, 1), (1, 0), (1, 1)})
			at = 12 + 36 * 48 + 36 * 4
			self.assertEqual(struct.unpack_from("<IBBBB", body, at), (36, 1, 0, 0, 0))
			self.assertEqual(struct.unpack_from("<II", body, at + 8), (64, 64))
			self.assertEqual(body[at + 16:], bytes(sum(((*pixel, 255) for row in glb.QUARTERS for pixel in row), ())))
			head, part = get("/" + path, "\nRange: bytes=12-51")
			self.assertIn(" 206 ", head)
			self.assertEqual(part, body[12:52])
			head, rest = get("/" + path, f'\nIf-None-Match: "{path[7:]}"')
			self.assertIn(" 304 ", head)
			self.assertEqual(rest, b"")
		self.assertIn(" 404 ", get("/meshes/0000000000000000")[0])
		send = lambda scale: program.call("send", self.name, "create", f"box {{ size = {{ 1, 1, 1 }}, at = {{ 0, 0, 9 }}, mesh = 'cube.glb', mesh_scale = {scale} }}")
		self.assertEqual(send(2).returncode, 0)
		v.until(lambda: len(v.objects) == 5)
		self.assertEqual(v.objects[max(v.objects)]["mesh"], 2)
		done = send(7)
		self.assertEqual(done.returncode, 1, done.stderr)
		self.assertIn("mesh: expected one that an object of the scene has", done.stderr)
		self.end()
		token = self.serve_file(self.path("scene.lua"), "--listen", "0.0.0.0:0")
		self.assertIn(" 403 ", get("/" + paths[0])[0])
		self.assertIn(" 200 ", get(f"/{paths[0]}?token={token}")[0])
		self.end()

	def test_token(self):
		token = self.start("--listen", "0.0.0.0:0")
		self.assertEqual(len(token), 32)
		roles = {"operate": token}
		for _ in range(2):
			role, url = self.run_.stdout.readline().split(": ")
			roles[role.removeprefix("To ")] = url.strip().rpartition("=")[2]
		self.assertEqual((len(set(roles.values())), set(roles)), (3, {"operate", "take part", "watch"}))
		for role, its in roles.items():
			self.check_role(self.viewer(path="/universe?token=" + its), role)
		for path in "/universe", "/universe?token=", "/universe?token=" + "0" * 32, "/universe?token=" + token[:-1]:
			with self.assertRaisesRegex(Refused, "403"):
				Viewer(self.port, path)
		for path, status in ("/metrics", "403"), ("/metrics?token=" + token[1:], "403"), ("/metrics?token=" + token, "200"):
			self.assertIn(status, self.http(f"GET {path} HTTP/1.1\nHost: HOST\nConnection: close")[0].split("\r\n")[0])
		self.viewer(path="/universe?token=" + token)
		with self.assertRaisesRegex(Refused, "403"):
			Viewer(self.port, "/universe?token=" + token, headers=["Origin: http://stranger.example"])
		self.end()

	def check_role(self, v, role):
		"""What each role may do, and no more."""
		self.assertEqual(v.told["welcome"]["role"], role)
		moving = next(i for i, o in v.objects.items() if not o["static"])
		to = {"id": moving, "generation": v.objects[moving]["generation"]}
		for least, command in ("take part", {"do": "push", "force": [0, 0, .1], **to}), ("take part", {"do": "release"}), \
				("operate", {"do": "edit", "friction": .3, **to}), ("operate", {"do": "pause"}), ("operate", {"do": "resume"}):
			v.told.pop("error", None)
			v.told.pop("details", None)
			v.send(**command)
			v.send(do="inspect", id=moving) # answered after it
			v.until(lambda: "details" in v.told)
			allowed = role == "operate" or role == least
			self.assertEqual("error" not in v.told, allowed, (role, command, v.told.get("error")))
		if role != "watch":
			v.send(do="create", shape="box", size=[.2, .2, .2], at=[4, 0, 1], mass=5, name=role)
			v.until(lambda: any(o["name"] == role for o in v.objects.values()))
			own = next(i for i, o in v.objects.items() if o["name"] == role)
			v.send(do="remove", id=own, generation=v.objects[own]["generation"])
			v.until(lambda: own not in v.objects)

	def test_change(self):
		"""Dragged, edited, killed, kept, put back: all viewers see it."""
		self.serve("--isolation", "process", "--workers", "objects", "-D", "n=8", scene="falling_boxes")
		v, other = self.viewer(), self.viewer()
		self.assertEqual(v.told["welcome"]["role"], "operate") # a program of the same user
		i = max(i for i, o in v.objects.items() if not o["static"])
		to = {"id": i, "generation": v.objects[i]["generation"]}
		v.send(do="drag", target=[5, 5, 3], **to)
		other.until(lambda: max(abs(a - b) for a, b in zip(other.objects[i]["p"], (5, 5, 3))) < .1)
		v.send(do="inspect", id=i)
		v.until(lambda: "details" in v.told)
		simulator = v.told["details"]["pid"]
		v.send(do="kill", **to)
		v.until(lambda: v.told["details"].get("pid") not in (simulator, None))
		v.send(do="keep")
		v.send(do="edit", at=[-7, 0, 9], velocity=[0, 0, 3], colour=[1, 0, 0], friction=.1, **to)
		other.until(lambda: other.objects[i]["p"][0] < 0)
		v.send(do="return")
		other.until(lambda: abs(other.objects[i]["p"][0] - 5) < .1)
		v.close() # and lets go
		other.until(lambda: other.objects[i]["p"][2] < 2)
		other.send(do="create", shape="box", size=[.2, .2, .2], at=[4, 0, 1], mass=5, name="guest")
		other.until(lambda: any(o["name"] == "guest" for o in other.objects.values()))
		before = other.told["statistics"]["step"]
		other.send(do="restart")
		other.until(lambda: other.told["statistics"]["step"] < before)
		other.until(lambda: not any(o["name"] == "guest" for o in other.objects.values()))
		other.until(lambda: other.objects[i]["p"][0] < 4)
		self.end(saying="was killed by SIGKILL")

	AVATAR = """ground {}
local n = param("n", 2, { whole = true, min = 1, max = 9, label = "how many", unit = "boxes" })
for i = 1, n do box { size = { 1, 1, 1 }, at = { 3 * i, 0, .5 }, density = 50 } end
sphere { avatar = true, name = "guest", radius = .4, at = { 0, 0, .4 }, script = [[
function on_message(_, what, x, y)
	if what == "roll" then self.state.x, self.state.y = x, y end
end
function on_step()
	self:force(400 * (self.state.x or 0), 400 * (self.state.y or 0), 0)
end]] }
controls { key = "D", gamepad = 15, label = "Right", sends = "roll", values = { 1, 0 } }
controls { label = "Power", sends = "power", min = 0, max = 2, value = 1 }
"""

	def write(self, text):
		with open(self.path("scene.lua"), "w") as f:
			f.write(text)
		return self.path("scene.lua")

	def avatar(self, v):
		v.until(lambda: v.told.get("avatar", {}).get("id") in v.objects)
		return v.told["avatar"]

	def refused(self, v, **command):
		v.told.pop("error", None)
		v.send(**command)
		v.until(lambda: "error" in v.told)
		return v.told["error"]

	def test_avatars(self):
		"""Each who takes part has an avatar, which goes with it, and steers no other."""
		token = self.serve_file(self.write(self.AVATAR), "--listen", "0.0.0.0:0")
		role = {}
		for _ in range(2):
			name, url = self.run_.stdout.readline().split(": ")
			role[name.removeprefix("To ")] = url.strip().rpartition("=")[2]
		come = lambda t: self.viewer(path="/universe?token=" + t)
		one, other, watcher, operator = come(role["take part"]), come(role["take part"]), come(role["watch"]), come(token)
		self.assertEqual([(c["key"], c.get("gamepad"), c["sends"], c["values"]) for c in one.told["welcome"]["controls"]],
			[("d", 15, "roll", [1, 0]), ("", None, "power", [1])])
		own, foreign = self.avatar(one), self.avatar(other)
		self.assertNotEqual(own["id"], foreign["id"])
		self.assertEqual(one.objects[own["id"]]["name"][:6], "guest ")
		for command in {"do": "message", "text": "roll 0 1"}, {"do": "drag", "target": [0, 0, 9]}, {"do": "push", "force": [0, 0, 9]}, \
				{"do": "turn", "torque": [0, 0, 9]}, {"do": "remove"}, {"do": "edit", "friction": 0}, {"do": "kill"}:
			self.assertIn("this is for those who operate", self.refused(one, **command, **foreign))
			self.assertIn("may change nothing", self.refused(watcher, **command, **foreign))
		self.assertNotIn("avatar", watcher.told)
		one.send(do="message", text="roll 1 0", **own)
		other.until(lambda: other.objects.get(own["id"], {}).get("p", [0])[0] > 2.4) # against the box, which it pushes
		box = next(i for i, o in other.objects.items() if o["name"].startswith("box"))
		other.until(lambda: other.objects[box]["p"][0] > 3.2)
		self.assertLess(abs(other.objects[foreign["id"]]["p"][0]), 2)
		operator.send(do="message", text="roll 0 1", **own) # an operator may
		for v in one, other:
			v.until(lambda: v.objects[own["id"]]["p"][1] > 1)
		operator.send(do="restart") # and all are there again
		one.until(lambda: one.told["avatar"]["generation"] != own["generation"] or one.objects.get(own["id"], {}).get("p", [9, 9])[1] < 1)
		gone = self.avatar(one)
		one.close()
		other.until(lambda: gone["id"] not in other.objects)
		self.end()

	def test_other_parameters(self):
		"""The scene starts anew with another value of a parameter; viewers stay connected."""
		self.serve_file(self.write(self.AVATAR), "--listen", "127.0.0.1:0")
		v, other = self.viewer(), self.viewer()
		self.avatar(v)
		self.assertEqual(v.told["welcome"]["params"], [{"name": "n", "label": "how many", "unit": "boxes", "value": 2, "min": 1, "max": 9, "whole": True}])
		for n in 7, 3:
			v.send(do="set", name="n", value=n)
			other.until(lambda: other.told["welcome"]["params"][0]["value"] == n)
			other.until(lambda: sum(o["name"].startswith("box") for o in other.objects.values()) == n)
			v.until(lambda: sum(o["name"].startswith("guest") for o in v.objects.values()) == 2)
		self.assertIn("from 1 to 9, got 10", self.refused(v, do="set", name="n", value=10))
		self.assertIn("a whole number from 1 to 9, got 2.5", self.refused(v, do="set", name="n", value=2.5))
		self.assertIn("no parameter of this name", self.refused(v, do="set", name="m", value=1))
		self.write("ground {}\n") # a scene that is wrong by now
		v.send(do="set", name="n", value=4)
		v.until(lambda: "unknown parameter" in v.told.get("notice", ""))
		v.send(do="pause")
		v.until(lambda: v.paused)
		self.assertEqual(sum(o["name"].startswith("box") for o in v.objects.values()), 3)
		self.end()
		self.serve("--log-requests", self.path("log"))
		self.assertIn("--log-requests", self.refused(self.viewer(), do="set", name="n", value=4))
		self.end()

	def test_other_seed_and_checkpoint(self):
		"""The scene starts anew with another seed, by the page's command and by obsim send, and keeps its parameters; a
		checkpoint of it goes on, where the server keeps one or where obsim send wants it."""
		scene = self.write("local n = param('n', 2, { min = 1, max = 9 })\nground {}\nfor i = 1, n do box { size = { .1, .1, .1 }, at = { random(-9, 9), i, 1 } } end\n")
		kept, other = self.path("kept.ck"), self.path("other.ck")
		self.serve_file(scene, "--listen", "127.0.0.1:0", "--seed", "3", "--checkpoint", kept)
		v = self.viewer()
		send = lambda *words: program.call("send", v.told["welcome"]["universe"], *words)
		self.assertTrue(v.told["welcome"]["saves"])
		for seed, ask in (7, lambda: v.send(do="seed", value=7)), (2**64 - 1, lambda: send("seed", str(2**64 - 1))):
			self.assertFalse(v.told["welcome"]["seed"] == seed)
			ask()
			v.until(lambda: v.told["welcome"]["seed"] == seed)
		self.assertEqual(send("set", "n", "5").returncode, 0)
		v.until(lambda: v.told["welcome"]["params"][0]["value"] == 5)
		self.assertEqual(v.told["welcome"]["seed"], 2**64 - 1)
		self.assertIn("from 1 to 9, got 10", send("set", "n", "10").stderr)
		self.assertEqual(send("wait", "30").returncode, 0)
		self.assertIn("expected a whole number", send("wait", "x").stderr)
		v.send(do="save")
		v.until(lambda: "is saved as" in v.told.get("notice", ""))
		done = send("save", other)
		self.assertEqual(done.returncode, 0, done.stderr)
		for path in kept, other:
			report = program.report("--resume", path, "--duration", "2")
			self.assertEqual((report["objects"], report["seed"]), (6, 2**64 - 1))
		self.end()
		self.serve_file(scene, "--listen", "127.0.0.1:0")
		self.assertIn("--checkpoint FILE", self.refused(self.viewer(), do="save"))
		self.end()

	def test_logged_avatars(self):
		"""A log repeats avatars, too: how they came, walked and went."""
		scene, log = self.write(self.AVATAR), self.path("log")
		self.serve_file(scene, "--listen", "127.0.0.1:0", "--log-requests", log)
		v, other = self.viewer(), self.viewer()
		own = self.avatar(v)
		v.send(do="message", text="roll 1 0", **own)
		other.until(lambda: other.objects.get(own["id"], {}).get("p", [0])[0] > 1)
		v.close()
		other.until(lambda: own["id"] not in other.objects)
		other.until(lambda: other.told["statistics"]["step"] > 30)
		self.end()
		done = program.call("run", scene, "--replay-requests", log, "--workers", "1")
		self.assertIn("states equal those of the log", done.stdout, done.stderr)

	def test_record(self):
		"""A served run is recorded, with all that viewers did, and plays back."""
		path = self.path("session.h5")
		self.serve("--record", path)
		v = self.viewer()
		v.send(do="create", shape="box", size=[.2, .2, .2], at=[4, 0, 1], mass=5, name="gift")
		v.until(lambda: any(o["name"] == "gift" for o in v.objects.values()))
		self.assertIn("--record", self.refused(v, do="restart"))
		step = v.told["statistics"]["step"]
		v.until(lambda: v.told["statistics"]["step"] > step + 20)
		self.end()
		self.run_ = program.start("serve", "--replay", path, "--listen", "127.0.0.1:0")
		self.addCleanup(lambda: (self.run_.stdout.close(), self.run_.stderr.close()))
		self.port = int(self.run_.stdout.readline().strip().rstrip("/").rsplit(":", 1)[1])
		_, page = self.http("GET /index.html HTTP/1.1\nHost: HOST\nConnection: close")
		self.assertIn(b"recording", page)
		film = gzip.decompress(self.http("GET /recording HTTP/1.1\nHost: HOST\nConnection: close")[1])
		self.assertIn(b"gift", film)
		self.end()

	def test_fast(self):
		"""Far faster than it can go, a universe still answers its viewers."""
		self.serve("--pace", "1e6")
		v = self.viewer()
		for _ in range(3):
			v.send(do="pause")
			v.until(lambda: v.paused)
			v.send(do="resume")
			v.until(lambda: not v.paused)
		self.assertIsNone(v.told["statistics"]["energy"]) # nobody looks at it
		v.send(do="energy", on=True)
		v.until(lambda: v.told["statistics"]["energy"] is not None)
		self.end()

	def test_figures(self):
		"""Energy and penetration of a universe that stands are those of its step, and CPU only grows."""
		with open(self.path("scene.lua"), "w") as f:
			f.write("scene { gravity = { 0, 0, 0 } }\nfor i, x in ipairs { 0, 1.9 } do sphere { name = 'ball ' .. i, radius = 1, mass = 2, at = { x, 0, 0 }, velocity = { 0, 3, 0 } } end\n"
				"box { size = { 1, 1, 1 }, at = { 9, 0, 0 }, static = true }\n")
		self.serve_file(self.path("scene.lua"), "--paused")
		v = self.viewer()
		v.send(do="energy", on=True)
		v.until(lambda: v.told["statistics"]["penetration"] is not None)
		first = v.told["statistics"]
		self.assertAlmostEqual(first["penetration"], .1, delta=1e-9)
		self.assertAlmostEqual(first["energy"], 2 * .5 * 2 * 3**2, delta=1e-9)
		v.send(do="step", steps=60)
		v.until(lambda: v.told["statistics"]["step"] == 60 and v.told["statistics"]["penetration"] is not None)
		self.assertLess(v.told["statistics"]["penetration"], .01)
		self.assertGreaterEqual(v.told["statistics"]["cpu"], first["cpu"])
		self.end(saying="begin 100 mm inside each other")

	def test_look_only(self):
		self.serve("--readonly")
		v = self.viewer()
		self.assertTrue(v.told["welcome"]["look_only"])
		v.send(do="pause")
		v.until(lambda: "error" in v.told)
		self.assertIn("change nothing", v.told["error"])
		self.assertFalse(v.paused)
		self.end()

	def test_duration(self):
		"""At the end of its duration a universe says so, to viewers and to readers, and can still be viewed."""
		self.serve("--duration", ".3")
		v = self.viewer()
		v.until(lambda: v.told.get("statistics", {}).get("ended"))
		self.assertEqual(v.told["statistics"]["step"], program.steps(self.name))
		self.assertIn(f"{self.name}: finished,", program.call("top", self.name, "--once", "--interval", ".01").stdout)
		late = self.viewer()
		late.until(lambda: late.told.get("statistics", {}).get("ended"))
		v.send(do="create", shape="box", size=[.2, .2, .2], at=[4, 0, 1], mass=5, name="visitor")
		late.until(lambda: any(o["name"] == "visitor" for o in late.objects.values()))
		self.assertIn(f"{self.name}: finished,", program.call("top", self.name, "--once", "--interval", ".01").stdout)
		self.end()

	def test_full(self):
		self.serve("--viewers", "2")
		self.viewer()
		self.viewer()
		with self.assertRaisesRegex(Refused, "503"):
			Viewer(self.port)
		self.end()

	def test_room(self):
		self.serve("--room", "64")
		v = self.viewer()
		before = len(v.objects)
		for i in range(65): # each when the one before is there: the server counts those
			v.until(lambda: len(v.objects) >= before + i)
			v.send(do="create", shape="sphere", size=[.1, 0, 0], at=[10 + i, 0, 1], mass=1)
			time.sleep(.03)
		v.until(lambda: "full" in v.told.get("error", ""))
		self.assertEqual(len(v.objects), before + 64)
		self.end()

	def test_awaited(self):
		"""While a step does not end, each visitor can ask for eight objects; they come when it does."""
		self.serve("--isolation", "process", "--workers", "1")
		v, other = self.viewer(), self.viewer()
		before = len(v.objects)
		pid = next(iter(program.simulators(self.run_.pid)))
		os.kill(pid, signal.SIGSTOP)
		v.send(do="create", shape="sphere", size=[.1, 0, 0], at=[9, 0, 50], mass=1) # it may still find a pause
		time.sleep(1)
		for i in range(20):
			v.send(do="create", shape="sphere", size=[.1, 0, 0], at=[10 + i, 0, 50], mass=1)
		v.until(lambda: "have not come yet" in v.told.get("error", ""))
		other.send(do="create", shape="sphere", size=[.1, 0, 0], at=[10, 9, 50], mass=1)
		time.sleep(.5)
		os.kill(pid, signal.SIGCONT)
		other.until(lambda: len(other.objects) >= before + 9)
		time.sleep(.5)
		v.until(lambda: len(v.objects) >= before + 9)
		self.assertIn(len(v.objects), (before + 9, before + 10))
		self.end()

	def closed(self, v):
		"""The code with which the server closes."""
		try:
			while True:
				v.receive()
		except EOFError as e:
			return e.args[0] if e.args else None
		except ConnectionError:
			return None

	def exchange(self, data):
		"""All that the server answers to these bytes until it closes."""
		with socket.create_connection(("127.0.0.1", self.port), timeout=program.PATIENCE) as s:
			got = b""
			try:
				s.sendall(data)
				while more := s.recv(1 << 16):
					got += more
			except ConnectionError:
				pass
		return got

	def test_upgrades(self):
		"""A connection becomes a WebSocket or stays HTTP/1.1, whatever it requests."""
		self.serve()
		witness = self.viewer()
		preface = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes(3) + b"\4\0\0\0\0\0" # and an empty SETTINGS frame
		head = f"GET /universe HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\nConnection: Upgrade, HTTP2-Settings\r\n" \
			"HTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
		for names in ("h2c",), ("H2C",), ("raw",), ("nonsense",), ("TLS/1.0, HTTP/1.1",), ("h2c, websocket",), ("websocket, h2c",), ("h2c", "websocket"), \
				("websocket", "h2c"), ("x" * 300,), ("",):
			upgrades = "".join(f"Upgrade: {name}\r\n" for name in names)
			got = self.exchange((head + upgrades + "Connection: close\r\n\r\n").encode() + preface)
			self.assertNotIn(b" 101 ", got, names)
			self.assertRegex(got, rb"\A(HTTP/1\.[01] [34]\d\d |\Z)", names)
		for start in b"", f"CONNECT 127.0.0.1:{self.port} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n\r\n".encode():
			self.assertRegex(self.exchange(start + preface), rb"\A(HTTP/1\.[01] 4\d\d |\Z)")
		for name in "websocket", "WebSocket", "WEBSOCKET":
			s = socket.create_connection(("127.0.0.1", self.port), timeout=program.PATIENCE)
			self.addCleanup(s.close)
			s.sendall((head + f"Upgrade: {name}\r\nSec-WebSocket-Protocol: obsim\r\n\r\n").encode())
			self.assertIn(b" 101 ", s.recv(100), name)
		since = witness.time
		witness.until(lambda: witness.time > since)
		self.end()

	def hold(self, count, first, address="127.0.0.1"):
		"""Opens connections that begin a request and then send nothing."""
		held = []
		for _ in range(count):
			s = socket.create_connection((address, self.port), timeout=program.PATIENCE)
			self.addCleanup(s.close)
			s.sendall(first)
			held.append(s)
		return held

	def test_slow(self):
		"""With any number of slow connections, in any state, a new viewer can connect."""
		self.serve()
		request = f"GET /main.js HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n"
		for first in b"", b"G", (request + "X: ").encode(), (request + "\r\n").encode(), (request + "Content-Length: 1000000\r\n\r\n").encode(), \
				(request + "\r\nGET /main.js HT").encode(), b"CONNECT a:1 HTTP/1.1\r\n\r\n":
			self.hold(200, first)
			self.viewer().close()
		self.end()

	def test_deadline(self):
		"""A request that comes a byte at a time ends, however steadily it comes."""
		self.serve()
		s, = self.hold(1, b"GET / HTTP/1.1\r\n")
		def has_ended():
			time.sleep(.2)
			try:
				s.sendall(b"X")
				return False
			except ConnectionError:
				return True
		self.assertTrue(program.wait_until(has_ended))
		self.end()

	def test_bodies(self):
		"""No request has a body, and bytes after one are not parsed as another request."""
		self.serve()
		for method, body in ("GET", "Content-Length: 43"), ("HEAD", "Content-Length: 43"), ("GET", "Transfer-Encoding: chunked"), ("POST", "Content-Length: 43"), \
				("GET", "Content-Length: 99999999999999999999999999999"), ("GET", "Content-Length: -1"), ("POST", "X: y"):
			got = self.exchange(f"{method} / HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n{body}\r\n\r\nGET /main.js HTTP/1.1\r\nHost: a\r\n\r\n".encode())
			self.assertRegex(got, rb"\AHTTP/1\.1 4(05|13) ", (method, body))
			self.assertEqual(got.count(b"HTTP/1.1 "), 1, (method, body))
		self.end()

	def test_compression(self):
		"""No extension is agreed on, so no frame can be larger than it is."""
		self.serve()
		v = Viewer(self.port, headers=["Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits"])
		self.addCleanup(v.close)
		v.send_frame(OPEN | 0x40, b"\0" * 100)
		self.assertIn(self.closed(v), (1002, None))
		self.end()

	def test_pipeline(self):
		"""Requests that arrive together are answered in order, each whole."""
		self.serve()
		paths = ["/main.js", "/style.css", "/nothing", "/", "/main.js"]
		got = self.exchange("".join(f"GET {p} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n" + ("Connection: close\r\n" if i == 4 else "") + "\r\n"
			for i, p in enumerate(paths)).encode())
		statuses = []
		while got:
			head, _, got = got.partition(b"\r\n\r\n")
			statuses.append(int(head.split()[1]))
			size = int(next(l for l in head.lower().split(b"\r\n") if l.startswith(b"content-length:")).split()[1])
			self.assertGreaterEqual(len(got), size)
			got = got[size:]
		self.assertEqual(statuses, [200, 200, 404, 200, 200])
		self.end()

	def sleeps(self):
		"""Returns how often the server's thread has gone to sleep."""
		for task in glob.glob(f"/proc/{self.run_.pid}/task/*"):
			with open(f"{task}/status") as f:
				lines = dict(line.split(":", 1) for line in f)
			if lines["Name"].strip() == "server":
				return int(lines["voluntary_ctxt_switches"])
		raise AssertionError("there is no thread of this name")

	def test_waiting(self):
		"""The server's thread sleeps while an answer waits for a client that has sent more, or sends no more."""
		self.serve()
		v = self.viewer()
		requests = f"GET /drawing.js HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n\r\n".encode() * 500
		for half in False, True:
			with socket.socket() as s:
				s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
				s.connect(("127.0.0.1", self.port))
				s.sendall(requests)
				if half:
					s.shutdown(socket.SHUT_WR)
				for _ in range(60): # until the socket's buffer is full
					v.receive()
				before = self.sleeps()
				for _ in range(60):
					v.receive()
				self.assertGreater(self.sleeps() - before, 15)
		self.end()

	def test_nonsense(self):
		self.serve()
		v = self.viewer()
		for text in "", "{}", "pause", '{"do":"pause"', '{"do":"create"}', '{"do":"create","shape":"box","size":[0,0,0],"at":[0,0,0],"mass":1}':
			v.told.pop("error", None)
			v.send_frame(OPEN, text.encode())
			if text:
				v.until(lambda: "error" in v.told)
		v = self.viewer()
		v.send_frame(OPEN, b" " * 100000)
		self.assertIn(self.closed(v), (1009, None))
		v = self.viewer()
		v.send_frame(0x82, b"\0\1\2")
		self.assertIn(self.closed(v), (1003, None))
		v = self.viewer()
		try:
			for _ in range(2000):
				v.send(do="inspect")
		except ConnectionError:
			pass
		self.assertIn(self.closed(v), (1008, None))
		self.viewer()
		self.end()

	def test_random_bytes(self):
		"""Random bytes, before and after the handshake, affect neither the run nor another viewer."""
		self.serve()
		witness, draw = self.viewer(), random.Random(1)
		for i in range(60):
			with socket.create_connection(("127.0.0.1", self.port), timeout=program.PATIENCE) as s:
				try:
					s.sendall((b"GET / HTTP/1.1\r\n" if i % 2 else b"") + draw.randbytes(draw.randrange(3000)))
				except ConnectionError:
					pass
		for i in range(60):
			v = Viewer(self.port)
			try:
				for _ in range(20):
					if i % 2:
						v.send_frame(OPEN, draw.randbytes(draw.randrange(300)))
					else:
						v.socket.sendall(draw.randbytes(draw.randrange(300)))
			except ConnectionError:
				pass
			v.close()
		since = witness.time
		witness.until(lambda: witness.time > since + .5)
		self.end()

	def test_stuck(self):
		"""A viewer that never reads does not delay others."""
		self.serve("-D", "n=200", scene="falling_boxes")
		stuck = [Viewer(self.port) for _ in range(5)]
		v = self.viewer()
		v.until(lambda: v.time > 2)
		for s in stuck:
			s.close()
		self.end()

	def test_log(self):
		"""Viewers' requests, carried out again in other configurations, lead to the same states."""
		log, words = self.path("requests"), ("-D", "n=20")
		self.serve(*words, "--isolation", "process", "--workers", "2", "--check", "--log-requests", log, scene="falling_boxes")
		v = self.viewer()
		for i in range(12):
			created = len(v.created)
			v.send(do="create", shape="sphere", size=[.2, 0, 0], at=[i % 3, 0, 2], mass=1, velocity=[0, 0, 1])
			v.until(lambda: len(v.created) > created)
			if i % 3 == 0:
				v.send(do="remove", id=v.created[-1], generation=v.objects[v.created[-1]]["generation"])
			if i == 6:
				os.kill(program.simulators(self.run_.pid)[0], signal.SIGKILL)
		end = v.time + 1
		v.until(lambda: v.time > end)
		self.end(saying="was killed by SIGKILL")
		scene = program.scene("falling_boxes")
		for way in ("--workers", "1"), ("--isolation", "process", "--workers", "2", "--harden"):
			done = program.call("run", scene, *words, *way, "--check", "--replay-requests", log)
			self.assertEqual((done.returncode, done.stderr), (0, ""))
			self.assertRegex(done.stdout, r"16 requests carried out again, 0 objects frozen; \d+ states equal those of the log")
		self.refuse("run", scene, "-D", "n=21", "--replay-requests", log, saying="another scene, seed, -D or settings")
		self.refuse("run", scene, *words, "--replay-requests", log, "--json", "-", saying="--json")
		with open(log, "rb") as f:
			whole = f.read()
		with open(log, "wb") as f:
			f.write(whole[:-20000] + b"\xff" * 20000)
		self.refuse("run", scene, *words, "--replay-requests", log, saying="makes no sense")
		with open(log, "wb") as f:
			f.write(whole[:20])
		self.refuse("run", scene, *words, "--replay-requests", log, saying="no log of requests")
		self.refuse("run", scene, "--replay-requests", self.path("none"), saying="No such file")

	def test_wrong_words(self):
		stack = program.scene("stack")
		for listen in "8080", "127.0.0.1", "127.0.0.1:x", "127.0.0.1:70000", "nowhere:80", ":80", "[::1:80", "1.2.3.4:5:6":
			self.refuse("serve", stack, "--listen", listen, saying="--listen")
		self.refuse("serve", saying="no scene given: obsim serve")
		self.refuse("serve", stack, "--pace", "fast", saying="--pace")
		self.refuse("serve", stack, "--viewers", "0", saying="--viewers")
		self.serve()
		self.refuse("serve", stack, "--listen", f"127.0.0.1:{self.port}", saying="in use", code=1)
		self.end()


class Pace(program.Case):
	def test_run(self):
		began = time.monotonic()
		r = program.report(program.scene("stack"), "--duration", ".5", "--pace", "realtime")
		self.assertGreater(time.monotonic() - began, .45)
		self.assertEqual(r["state_hash"], program.report(program.scene("stack"), "--duration", ".5")["state_hash"])


if __name__ == "__main__":
	unittest.main()
