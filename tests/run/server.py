"""obsim serve as a program, and a WebSocket client of it."""

import base64
import hashlib
import json
import os
import socket
import struct
import time

import program

OPEN, PONG, CLOSE, PING = 0x81, 0x8a, 8, 9
MOTIONS, VOID, PAUSED = 1, 1, 2
HULL = 6 # shape
SWINGS = 3 # kind of motion


class Refused(Exception):
	pass


class Viewer:
	"""A WebSocket client that keeps the part of the universe that tests need."""

	def __init__(self, port, path="/universe", headers=(), address="127.0.0.1", protocol="obsim"):
		self.socket = socket.create_connection((address, port), timeout=program.PATIENCE)
		self.buffer = b""
		key = base64.b64encode(os.urandom(16)).decode()
		lines = [f"GET {path} HTTP/1.1", "Upgrade: websocket", "Connection: Upgrade", f"Sec-WebSocket-Key: {key}",
			"Sec-WebSocket-Version: 13", f"Sec-WebSocket-Protocol: {protocol}"]
		if not any(h.lower().startswith("host:") for h in headers):
			lines.append(f"Host: {address}:{port}")
		self.socket.sendall("\r\n".join([*lines, *headers, "", ""]).encode())
		while b"\r\n\r\n" not in self.buffer:
			self.more()
		head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
		if b" 101 " not in head.split(b"\r\n")[0]:
			self.close()
			raise Refused(head.decode() + self.buffer.decode(errors="replace"))
		accept = base64.b64encode(hashlib.sha1((key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest())
		assert accept.lower() in head.lower()
		self.objects, self.created, self.removed, self.told = {}, [], [], {}
		self.time, self.paused = 0, None

	def more(self):
		data = self.socket.recv(1 << 16)
		if not data:
			raise EOFError
		self.buffer += data

	def take(self, n):
		while len(self.buffer) < n:
			self.more()
		data, self.buffer = self.buffer[:n], self.buffer[n:]
		return data

	def send_frame(self, first, data):
		mask = os.urandom(4)
		n = len(data)
		size = bytes([0x80 | n]) if n < 126 else bytes([0xfe]) + struct.pack(">H", n) if n < 65536 else bytes([0xff]) + struct.pack(">Q", n)
		self.socket.sendall(bytes([first]) + size + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

	def send(self, **command):
		self.send_frame(OPEN, json.dumps(command).encode())

	def message(self):
		"""The next message. Raises EOFError with the reason when the server closes."""
		whole = b""
		while True:
			first, n = self.take(2)
			n = n if n < 126 else struct.unpack(">H", self.take(2))[0] if n == 126 else struct.unpack(">Q", self.take(8))[0]
			data, kind = self.take(n), first & 15
			if kind == CLOSE:
				raise EOFError(struct.unpack(">H", data[:2])[0] if data else 0, data[2:].decode())
			if kind == PING:
				self.send_frame(PONG, data)
			if kind > 2:
				continue
			whole += data
			if whole and first & 0x80:
				return whole

	def receive(self):
		"""Receives the next message, and applies it."""
		whole = self.message()
		if whole[:1] == b"{":
			for name, value in json.loads(whole).items():
				self.told[name] = value
		elif whole[0] == MOTIONS:
			self.follow(whole)
		return whole

	def follow(self, m):
		flags, rate, self.time, removed, created, motions = struct.unpack_from("<xB2xfdIII", m)
		self.paused = bool(flags & PAUSED)
		at = 28
		if flags & VOID:
			self.objects = {}
		for _ in range(removed):
			(i,), at = struct.unpack_from("<I", m, at), at + 4
			del self.objects[i]
			self.removed.append(i)
		for _ in range(created):
			i, generation, shape, what, name, _ = struct.unpack_from("<IIBHBB", m, at)
			at += 49
			for _ in range(1 + m[at + 2] if shape == HULL else 0):
				corners, faces = m[at], m[at + 1]
				at += 5 + 12 * corners
				for _ in range(faces):
					at += 1 + m[at]
			mesh = 0
			if what & 4:
				mesh, at = m[at], at + 1
			text, at = m[at:at + name].decode(), at + name
			self.objects[i] = {"mesh": mesh, "generation": generation, "shape": shape, "name": text, "static": bool(what & 1), "frozen": bool(what & 2)}
			self.created.append(i)
		i = -1
		for _ in range(motions):
			shift = more = 0
			while True:
				byte, at = m[at], at + 1
				more |= (byte & 127) << shift
				shift += 7
				if not byte & 128:
					break
			i = (i + more) % 2**32
			kind, at = m[at], at + 1
			self.objects[i]["p"] = struct.unpack_from("<3f", m, at)
			self.objects[i]["kind"] = kind & 3
			at += 20 + (4 if kind & 16 else 0) + (12 if kind & 8 else 0) + (8 if kind & 3 == SWINGS else 0) + (24 if kind & 4 else 12 if kind & 3 else 0)
		assert at == len(m), (at, len(m))

	def until(self, condition):
		end = time.monotonic() + program.PATIENCE
		while not condition():
			if time.monotonic() > end:
				raise AssertionError("it never came")
			self.receive()

	def close(self):
		self.socket.close()


class Case(program.Case):
	"""A test with a server of its own."""

	def serve(self, *words, scene="stack"):
		self.start("--listen", "127.0.0.1:0", *words, scene=scene)

	def start(self, *words, scene="stack"):
		"""Returns the token, if there is one."""
		return self.serve_file(program.scene(scene), *words)

	def serve_file(self, path, *words):
		"""The same for any scene."""
		self.run_ = self.start_universe(path, *(words or ("--listen", "127.0.0.1:0")), command="serve")
		where, _, token = self.run_.stdout.readline().rsplit(" ", 1)[1].strip().partition("#token=")
		self.port = int(where.rstrip("/").rsplit(":", 1)[1])
		return token

	def viewer(self, **more):
		v = Viewer(self.port, **more)
		self.addCleanup(v.close)
		v.until(lambda: "welcome" in v.told and v.objects)
		return v

	def http(self, request):
		with socket.create_connection(("127.0.0.1", self.port), timeout=program.PATIENCE) as s:
			s.sendall(request.replace("HOST", f"127.0.0.1:{self.port}").replace("\n", "\r\n").encode() + b"\r\n\r\n")
			data = b""
			while True:
				more = s.recv(1 << 16)
				data += more
				if not more:
					break
		head, _, body = data.partition(b"\r\n\r\n")
		return head.decode(), body

	def end(self, saying=""):
		self.run_.terminate()
		out, err = self.run_.communicate(timeout=program.PATIENCE)
		self.assertEqual(self.run_.returncode, 0)
		if saying:
			self.assertIn(saying, err)
		else:
			self.assertEqual(err, "")

