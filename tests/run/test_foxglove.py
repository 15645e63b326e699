"""Foxglove's live protocol: a client of it, that decodes all messages by the schemas that it is sent."""

import base64
import json
import math
import os
import struct
import unittest

import program
import protobuf
import server

SCENE = """scene { title = "Seen from afar", step = 1/60 }
local n = param("n", 3, { whole = true, min = 1, max = 9, label = "boxes" })
ground {}
for i = 1, n do box { size = { .4, .4, .4 }, at = { 2, i - 2, .2 } } end
sphere { name = "ball", radius = .2, at = { 0, 0, 40 } }
box { name = "car", size = { .2, .2, .2 }, at = { 0, 0, .1 } }
imu { on = "ball", name = "imu", rate = 60 }
lidar { on = "car", name = "ring", beams = 40, rate = 20, reach = 5 }
camera "main" { eye = { -3, -6, 4 }, target = { 3, 0, .5 } }
"""
CAMERA = 'camera { on = "car", name = "eye", at = { .2, 0, .3 }, width = 40, height = 30, rate = 10 }\n'


class Client(server.Viewer):
	"""What Foxglove does: channels by topic, and their messages."""

	def __init__(self, port, protocol="foxglove.websocket.v1", **more):
		super().__init__(port, "/", protocol=protocol, **more)
		self.info, self.channels, self.found, self.clock, self.said = None, {}, {}, -1, []
		self.until(lambda: self.channels)

	def receive(self):
		m = self.message()
		if m[0] == 1:
			subscription, ns = struct.unpack_from("<IQ", m, 1)
			topic = self.subscribed[subscription]
			channel = self.channels[topic]
			schema = protobuf.Schemas(base64.b64decode(channel["schema"], validate=True))
			self.found.setdefault(topic, []).append((ns * 1e-9, schema.decode(channel["schemaName"], m[13:])))
		elif m[0] == 2:
			(ns,) = struct.unpack("<Q", m[1:])
			assert ns > self.clock
			self.clock = ns
		else:
			j = json.loads(m)
			if j["op"] == "serverInfo":
				self.info = j
			elif j["op"] == "advertise":
				self.channels = {c["topic"]: c for c in j["channels"]}
			else:
				self.said.append(j)

	def subscribe(self, *topics):
		self.subscribed = {100 + i: topic for i, topic in enumerate(topics)}
		self.send(op="subscribe", subscriptions=[{"id": i, "channelId": self.channels[topic]["id"]} for i, topic in self.subscribed.items()])

	def has(self, topic, n=1):
		return lambda: len(self.found.get(topic, ())) >= n


class Foxglove(server.Case):
	def begin(self, *words, text=SCENE):
		path = self.path("scene.lua")
		with open(path, "w", encoding="utf-8") as f:
			f.write(text)
		self.serve_file(path, "--listen", "127.0.0.1:0", *words)

	def client(self, **more):
		c = Client(self.port, **more)
		self.addCleanup(c.close)
		return c

	def test_all(self):
		able = program.call("run", program.scene("stack"), "--duration", ".01", "--out", self.path("f")).returncode == 0
		self.begin("--foxglove", text=SCENE + CAMERA * able)
		c = self.client(headers=("Origin: https://app.foxglove.dev",))
		self.assertEqual(set(c.info["capabilities"]), {"time", "parameters"})
		pictures = {"/eye/" + n for n in ("colour", "depth", "objects", "calibration")} if able else set()
		self.assertEqual(set(c.channels), {"/scene", "/poses", "/imu", "/ring"} | pictures)
		c.subscribe(*c.channels)
		for topic in c.channels:
			c.until(c.has(topic, 1 if topic == "/scene" else 5))
		entities = {e["metadata"][0]["value"]: e for _, m in c.found["/scene"] for e in m["entities"]}
		self.assertEqual(len(entities), 6)
		self.assertAlmostEqual(entities["ball"]["spheres"][0]["size"]["x"], .4)
		for t, m in c.found["/poses"]: # the ball falls for a while
			for p in m["transforms"]:
				if p["child_frame_id"] == entities["ball"]["frame_id"] and t < 2:
					self.assertAlmostEqual(p["translation"]["z"], 40 - .5 * 9.81 * t ** 2, delta=.3) # while it goes on
		times = [t for t, _ in c.found["/imu"]]
		self.assertEqual(times, sorted(set(times)))
		for t, m in c.found["/imu"]:
			self.assertAlmostEqual(t * 60, round(t * 60), 5)
			self.assertEqual(len(m["value"]), 6)
		for _, m in c.found["/ring"]:
			self.assertEqual(len(m["ranges"]), 40)
			self.assertLess(min(m["ranges"]), 2.1)
		if able:
			_, depth = c.found["/eye/depth"][0]
			self.assertEqual((depth["width"], depth["height"], len(depth["data"])), (40, 30, 4 * 40 * 30))
			self.assertLess(min(struct.unpack("<1200f", depth["data"])), 2)
		# one channel less
		c.send(op="unsubscribe", subscriptionIds=[i for i, topic in c.subscribed.items() if topic == "/imu"])
		c.until(c.has("/ring", len(c.found["/ring"]) + 30)) # what was on its way
		n = len(c.found["/imu"])
		c.until(c.has("/ring", len(c.found["/ring"]) + 10))
		self.assertEqual(len(c.found["/imu"]), n)
		# a page beside it, which both see the same universe
		v = self.viewer()
		v.until(lambda: v.objects)
		self.end()

	def test_parameters(self):
		self.begin("--foxglove")
		watcher = self.client(headers=("Origin: https://app.foxglove.dev",))
		for c in watcher, self.client(protocol="foxglove.sdk.v1"):
			c.send(op="getParameters", parameterNames=[], id="now")
			c.until(lambda c=c: c.said)
			self.assertEqual(c.said.pop(), {"op": "parameterValues", "parameters": [{"name": "n", "value": 3}], "id": "now"})
			c.send(op="setParameters", parameters=[{"name": "m", "value": 5}])
			c.until(lambda c=c: c.said)
			self.assertEqual(c.said.pop()["op"], "status")
		watcher.send(op="setParameters", parameters=[{"name": "n", "value": 5}]) # a page of another origin watches
		watcher.until(lambda: watcher.said)
		self.assertEqual(watcher.said.pop()["op"], "status")
		c.send(op="setParameters", parameters=[{"name": "n", "value": 5}])
		with self.assertRaises((EOFError, ConnectionError)): # the next run may have other channels
			c.until(lambda: c.said)
		c = self.client()
		c.subscribe("/scene")
		c.until(c.has("/scene"))
		self.assertEqual(len(c.found["/scene"][0][1]["entities"]), 8)
		self.end()

	def test_hostile(self):
		"""Whatever a client sends, the server goes on."""
		self.begin("--foxglove")
		good = self.client()
		good.subscribe("/poses")
		random = __import__("random").Random(4)
		for n in range(60):
			c = self.client()
			try:
				for _ in range(5):
					c.send_frame(server.OPEN, random.choice((
						b"{", b"[[[[[[[[[[[[[[[[[[[[[[[[", b"null", b'{"op":"subscribe"}', b'{"op":"subscribe","subscriptions":[{"id":-1,"channelId":99}]}',
						b'{"op":"subscribe","subscriptions":[' + b'{"id":7,"channelId":1},' * 3000 + b'{"id":8,"channelId":0}]}',
						b'{"op":"' + b"x" * 5000 + b'"}', b'{"op":"setParameters","parameters":[{"name":"n","value":"5"},{"name":"n","value":1e999}]}',
						b'{"op":"unsubscribe","subscriptionIds":[' + b"4294967295," * 2000 + b"1]}",
						bytes(random.randrange(32, 127) for _ in range(random.randrange(1, 300))))))
				if n % 3 == 0:
					c.send_frame(0x82, os.urandom(9))
				c.receive()
			except (EOFError, OSError, KeyError, AttributeError):
				pass
			c.close()
		n = len(good.found.get("/poses", ()))
		good.until(good.has("/poses", n + 20))
		self.end()

	def test_refused(self):
		"""Only where it was allowed; and pages of other origins no more than that."""
		self.begin()
		with self.assertRaisesRegex(server.Refused, "--foxglove"):
			self.client()
		self.end()

	def test_pages_refused(self):
		self.begin("--foxglove")
		with self.assertRaisesRegex(server.Refused, "only pages of this server"):
			server.Viewer(self.port, headers=("Origin: https://app.foxglove.dev",))
		with self.assertRaisesRegex(server.Refused, "only pages of this server"):
			self.client(headers=("Host: evil.example",))
		self.end()


unittest.main()
