#!/usr/bin/env python3
"""Fuzzing of a server's connections: HTTP, HTTP/2 and WebSocket as no browser would speak them.

    connections.py OBSIM [--count N] [--seed S] [--first I] [--only KIND] [--under COMMAND]

Starts obsim serve, and makes N hostile connections to it, some at a time. Each is drawn from the seed and its number: a
kind, the bytes, where they are cut, and the pauses between them. Some close, some reset, some stay and are silent. After
each batch the server must be there, the universe must step, and a good viewer must be let in and see time pass. No
connection may be upgraded to anything but websocket. In the end the server must exit with 0 and without a word, which
a sanitizer or --under 'valgrind -q --error-exitcode=9' would say. Prints how many connections of each kind were made;
exit code 1 and the batch to repeat on a failure.
"""

import argparse
import collections
import concurrent.futures
import os
import random
import shlex
import socket
import struct
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "run"))
os.environ.setdefault("OBSIM", "")  # for program.py, whose tests meson starts
os.environ.setdefault("SCENES", os.path.join(HERE, "..", "..", "scenes"))

import program
from server import Refused, Viewer

BATCH, AT_ONCE, SILENT_MAX = 50, 16, 100
CLIENT_PATIENCE = 2.  # s, until a client gives up sending or reading
PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
SETTINGS, GOAWAY = 4, 7  # types of HTTP/2 frames
METHODS = ["GET"] * 6 + ["HEAD", "POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "PATCH", "PRI", "get", "", "X" * 300]
PATHS = ["/", "/main.js", "/style.css", "/universe", "/recording", "/meshes/0", "/nothing", "*", "", "//", "/%", "/%00", "/..%2f..%2fetc", "/?" + "a&" * 500,
	"/?token=" + "f" * 5000, "/" + "a" * 3000, "http://127.0.0.1/", "/\x01", "/\u00ff"]
COMMANDS = ['{"do":"inspect","id":1}', '{"do":"inspect"}', '{"do":"contacts","on":true}', '{"do":"pause"}', '{"do":"resume"}', '{"do":"step","steps":3}',
	'{"do":"rate","rate":2}', "{}", "[", '{"do":"create"}', '{"do":"remove","id":4294967295,"generation":0}', '{"do":"' + "x" * 1900 + '"}', '"\\ud800"']


class Bytes:
	"""Byte streams of hostile clients; one method for each kind."""

	def __init__(self, r, port):
		self.r, self.host = r, f"127.0.0.1:{port}"

	# ---- pieces

	def head(self, method, path, *headers, version="1.1"):
		lines = [f"{method} {path} HTTP/{version}", f"Host: {self.host}", *headers, "", ""]
		return "\r\n".join(lines).encode("latin-1")

	def random(self, most):
		return self.r.randbytes(self.r.randrange(most))

	def handshake(self, *headers, key="dGhlIHNhbXBsZSBub25jZQ==", version="13"):
		return self.head("GET", "/universe", "Upgrade: websocket", "Connection: Upgrade", f"Sec-WebSocket-Key: {key}", f"Sec-WebSocket-Version: {version}",
			"Sec-WebSocket-Protocol: obsim", *headers)

	def frame(self, first, data=b"", mask=True, size=None, form=None):
		"""size: that the frame says it has; form: bytes of its extended length, 0, 2 or 8."""
		n = len(data) if size is None else size
		form = form if form is not None else 0 if n < 126 else 2 if n < 65536 else 8
		length = {0: bytes([n & 127]), 2: b"\x7e" + struct.pack(">H", n & 65535), 8: b"\x7f" + struct.pack(">Q", n)}[form]
		key = self.r.randbytes(4) if mask else b""
		body = bytes(b ^ key[i % 4] for i, b in enumerate(data)) if mask else data
		return bytes([first, length[0] | (0x80 if mask else 0)]) + length[1:] + key + body

	def h2(self, kind, flags=0, stream=0, data=b"", size=None):
		n = len(data) if size is None else size
		return struct.pack(">I", n)[1:] + bytes([kind, flags]) + struct.pack(">I", stream) + data

	def h2_request(self, stream):
		fields = bytes([0x82, 0x84, 0x86, 0x41, len(self.host)]) + self.host.encode()  # GET / http, from the static table
		return self.h2(1, 5, stream, fields)

	def h2_frames(self):
		r = self.r
		frames = [self.h2(SETTINGS)]
		for i in range(r.randrange(12)):
			frames.append(r.choice([
				lambda: self.h2_request(2 * i + 1),
				lambda: self.h2_request(2 * i + 1),
				lambda: self.h2(GOAWAY, 0, 0, bytes(8)),
				lambda: self.h2(SETTINGS, r.randrange(2), 0, b"".join(struct.pack(">HI", r.randrange(8), r.getrandbits(32)) for _ in range(r.randrange(5)))),
				lambda: self.h2(8, 0, r.randrange(4), struct.pack(">I", r.getrandbits(32))),
				lambda: self.h2(6, 0, 0, r.randbytes(8)),
				lambda: self.h2(3, 0, r.randrange(9), bytes(4)),
				lambda: self.h2(9, r.randrange(8), r.randrange(9), self.random(60)),
				lambda: self.h2(r.randrange(256), r.randrange(256), r.randrange(9), self.random(200), r.choice([None, None, 0, 16384, 0xffffff]))])())
		if r.random() < .5:
			frames.append(self.h2(GOAWAY, 0, 0, bytes(8)))
		return b"".join(frames)

	# ---- kinds

	def h2c(self):
		headers = ["Connection: Upgrade, HTTP2-Settings", "Upgrade: " + self.r.choice(["h2c", "h2c", "H2C", "h2c, websocket", "websocket, h2c", "h2"]),
			"HTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA"]
		if self.r.random() < .3:
			headers += ["Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ=="]
		return self.head("GET", "/", *headers) + PREFACE + self.h2_frames()

	def prior_knowledge(self):
		return PREFACE[:self.r.choice([len(PREFACE), len(PREFACE), 18, 10])] + self.h2_frames()

	def headers(self):
		r = self.r
		h = []
		for _ in range(r.choice([1, 3, 20, 1000])):
			h.append(r.choice([
				lambda: "X: " + "a" * r.choice([1, 100, 4000, 70000]),
				lambda: "Y" * r.choice([1, 100, 5000]) + ": b",
				lambda: f"Host: {r.choice(['', 'stranger.example', self.host, 'a' * 3000])}",
				lambda: f"Origin: {r.choice(['', 'null', 'http://stranger.example', 'http://' + self.host])}",
				lambda: r.choice(["no colon", ": no name", " folded", "\tfolded", "a b: c", "\x00: \x00", "X:\n", "Cookie: " + "a=b; " * 300]),
				lambda: f"Range: bytes={r.choice(['0-', '-1', '5-2', '0-0,1-1', '-', 'x', '99999999999999999999-', '0-' + '9' * 100])}",
				lambda: f"If-None-Match: {r.choice(['*', '', 'W/', ',' * 200])}",
				lambda: f"Connection: {r.choice(['close', 'keep-alive', 'upgrade', 'x' * 300, ''])}",
				lambda: f"Upgrade: {r.choice(['websocket', 'h2c', 'raw', '', 'x' * 300])}",
				lambda: "Sec-WebSocket-Key: " + "A" * r.choice([0, 24, 500]),
				lambda: "Expect: 100-continue", lambda: "TE: trailers", lambda: "Accept-Encoding: " + "gzip," * 50,
				lambda: "Authorization: Basic " + "A" * 2000])())
		return self.head(r.choice(METHODS), r.choice(PATHS), *h, version=r.choice(["1.1"] * 5 + ["1.0", "0.9", "2.0", "9" * 50, ""]))

	def pipeline(self):
		requests = [self.head(self.r.choice(["GET", "GET", "HEAD"]), self.r.choice(PATHS)) for _ in range(self.r.choice([2, 10, 100]))]
		all_ = b"".join(requests)
		return all_[:len(all_) - self.r.choice([0, 0, 1, 20])]

	def body(self):
		r = self.r
		says = r.choice(["Content-Length: 43", "Content-Length: 0", "Content-Length: -1", "Content-Length: " + "9" * 30, "Content-Length: 5\r\nContent-Length: 6",
			"Transfer-Encoding: chunked", "Transfer-Encoding: gzip, chunked", "Transfer-Encoding: chunked\r\nContent-Length: 4", "X: y"])
		chunks = r.choice([b"", b"5\r\nhello\r\n0\r\n\r\n", b"ffffffffffffffff\r\nx", b"-1\r\n", self.random(5000), self.head("GET", "/main.js")])
		return self.head(r.choice(METHODS), r.choice(PATHS), says) + chunks + self.random(100)

	def connect(self):
		return self.head("CONNECT", self.r.choice([self.host, "/", "a:1", "*", ""])) + self.r.choice([PREFACE, self.handshake(), self.random(3000)])

	def handshakes(self):
		r = self.r
		extra = [r.choice(["Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits", "Sec-WebSocket-Extensions: " + "permessage-deflate, " * 100,
			"Sec-WebSocket-Extensions: x-webkit-deflate-frame", "Sec-WebSocket-Extensions: ;;=,", "Sec-WebSocket-Protocol: " + "obsim, " * 100, "Sec-WebSocket-Protocol: chat",
			"Sec-WebSocket-Protocol: " + "a" * 300, "Sec-WebSocket-Protocol: ,", "Origin: http://stranger.example", "Host: b", "Content-Length: 10", "X: y"]) for _ in range(r.randrange(4))]
		data = self.handshake(*extra, key=r.choice(["dGhlIHNhbXBsZSBub25jZQ==", "", "A", "A" * 200, "====", "\u00ff" * 24]), version=r.choice(["13", "13", "0", "8", "", "x", "9" * 40]))
		return data + b"".join(self.frame(r.choice([0x81, 0xc1]), self.random(200)) for _ in range(r.randrange(3)))

	def frames(self):
		"""Frames that RFC 6455 forbids, between some that it does not."""
		r = self.r
		def one():
			return r.choice([
				lambda: self.frame(0x81, r.choice(COMMANDS).encode()),
				lambda: self.frame(0x81, r.choice(COMMANDS).encode()),
				lambda: self.frame(0x81, r.choice(COMMANDS).encode(), mask=False),
				lambda: self.frame(0x01, self.random(50)) * r.choice([1, 2, 50]),  # no end, or a beginning inside
				lambda: self.frame(0x01) + self.frame(0x00) * r.choice([1, 100, 1000]) + (self.frame(0x80) if r.random() < .5 else b""),
				lambda: self.frame(r.choice([0x00, 0x80]), self.random(50)),  # continues nothing
				lambda: self.frame(r.choice([0x88, 0x89, 0x8a]), r.randbytes(r.choice([0, 1, 2, 125, 126, 200, 3000]))),
				lambda: self.frame(r.choice([0x08, 0x09, 0x0a]), self.random(20)),  # control in fragments
				lambda: self.frame(0x89, r.randbytes(125)) * r.choice([10, 500]),
				lambda: self.frame(0x8a, self.random(125)) * r.choice([1, 100]),
				lambda: self.frame(0x88, struct.pack(">H", r.choice([0, 999, 1000, 1004, 1005, 1006, 1015, 2999, 3000, 5000, 65535])) + self.random(20)) + self.frame(0x81, b"{}"),
				lambda: self.frame(0x80 | r.randrange(16), self.random(100), mask=r.random() < .8),
				lambda: self.frame(r.randrange(256), self.random(100), mask=r.random() < .8),
				lambda: self.frame(0x81, self.random(100), size=r.choice([0, 1, 125, 126, 65535, 65536, 1 << 31, 1 << 32, (1 << 63) - 1, 1 << 63, (1 << 64) - 1]), form=r.choice([2, 8])),
				lambda: self.frame(0x81, b"\xff\xfe\xc0\x80" + self.random(10)),
				lambda: self.frame(0x81, b" " * r.choice([2047, 2048, 2049, 100000])),
				lambda: self.frame(0x82, self.random(3000)),
				lambda: self.frame(0xc1, self.random(100)),  # compressed, though nothing was agreed on
				lambda: self.frame(0x89, bytes(5), mask=False)])()
		return self.handshake() + b"".join(one() for _ in range(r.choice([1, 3, 10, 40])))

	def garbage(self):
		return self.handshake() + self.r.choice([self.random(5000), self.head("GET", "/"), PREFACE + self.h2_frames(), self.random(10)])

	def noise(self):
		return self.r.choice([self.random(5000), b"\r\n" * 1000, b"\0" * 1000, b"GET " * 1000, b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + self.random(600), b"GET / HTTP/1.1\r\n" + self.random(3000)])

	def mutant(self):
		"""Another kind's bytes, damaged in some places."""
		data = bytearray(getattr(self, self.r.choice([k for k in KINDS if k != "mutant"]))())
		for _ in range(self.r.choice([1, 3, 20])):
			at = self.r.randrange(len(data) + 1)
			match self.r.randrange(4):
				case 0: data[at:at + 1] = self.r.randbytes(1)
				case 1: del data[at:at + self.r.choice([1, 10, 1000])]
				case 2: data[at:at] = self.random(20)
				case 3: data[at:at] = data[:self.r.choice([10, 500])]
		return bytes(data)


KINDS = [name for name, value in vars(Bytes).items() if callable(value) and name not in ("__init__", "head", "random", "handshake", "frame", "h2", "h2_request", "h2_frames")]


class Connection:
	"""One of them, from its number to its end."""

	def __init__(self, seed, number, port, only):
		r = random.Random(f"{seed} {number}")
		self.kind, self.number, self.port = only or r.choice(KINDS), number, port
		data = getattr(Bytes(r, port), self.kind)()
		self.parts = self.cut(r, data)
		self.waits_between = r.random() < .3  # reads what there is before it goes on
		self.half_closes = r.random() < .15
		self.end = r.choice(["close", "close", "reset", "silence", "read", "read"])
		self.answer, self.socket = b"", None

	@staticmethod
	def cut(r, data):
		"""Pairs of bytes and of the pause after them, s."""
		match r.randrange(4):
			case 0:
				return [(data, 0)]
			case 1:  # byte by byte, at first or at last
				n = min(len(data), 40)
				slow = [(bytes([b]), r.choice([.001, .02])) for b in (data[:n] if r.random() < .5 else data[-n:])]
				return slow + [(data[n:], 0)] if slow and slow[0][0] == data[:1] else [(data[:-n], 0)] + slow
			case _:
				places = sorted(r.randrange(len(data) + 1) for _ in range(r.randrange(6)))
				return [(data[a:b], r.choice([0, .01, .1])) for a, b in zip([0] + places, places + [len(data)])]

	def read(self, seconds):
		end = time.monotonic() + seconds  # a viewer is sent something 60 times a second
		while (left := end - time.monotonic()) > 0:
			self.socket.settimeout(left)
			try:
				more = self.socket.recv(1 << 16)
			except TimeoutError:
				return
			if not more:
				return
			self.answer += more[:max(0, 4096 - len(self.answer))]

	def make(self):
		try:
			self.socket = socket.create_connection(("127.0.0.1", self.port), timeout=CLIENT_PATIENCE)
			for data, pause in self.parts:
				self.socket.settimeout(CLIENT_PATIENCE)
				self.socket.sendall(data)
				time.sleep(pause)
				if self.waits_between:
					self.read(.01)
			if self.half_closes:
				self.socket.shutdown(socket.SHUT_WR)
			self.read(.5 if self.end == "read" else .05)
			if self.end == "reset":
				self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
		except OSError:  # the server may refuse any of them
			pass
		if self.socket and self.end != "silence":
			self.socket.close()
		return self


class Server:
	def __init__(self, obsim, under):
		self.name = f"fuzz-connections-{os.getpid()}"
		self.run = subprocess.Popen([*shlex.split(under), obsim, "serve", program.scene("stack"), "--listen", "127.0.0.1:0", "--viewers", str(2 * SILENT_MAX), "--name", self.name],
			stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
		self.port = int(self.run.stdout.readline().rstrip().rstrip("/").rsplit(":", 1)[1])

	def check(self):
		"""Raises an error unless all is well."""
		if self.run.poll() is not None:
			raise AssertionError(f"the server has ended: {self.run.returncode}\n{self.run.stderr.read()}")
		try:
			viewer = Viewer(self.port)
			viewer.until(lambda: "welcome" in viewer.told and viewer.objects)
			viewer.send(do="rate", rate=1)
			viewer.send(do="resume")
			since, steps = viewer.time, program.steps(self.name)
			viewer.until(lambda: viewer.time > since and program.steps(self.name) > steps)
			viewer.close()
		except (OSError, EOFError, Refused) as error:
			raise AssertionError(f"a good viewer is not served: {error!r}") from error

	def end(self):
		self.run.terminate()
		_, said = self.run.communicate(timeout=program.PATIENCE)
		if self.run.returncode != 0 or said:
			raise AssertionError(f"the server exits with {self.run.returncode}:\n{said}")


def fuzz(server, arguments):
	made, silent = collections.Counter(), collections.deque()
	with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
		for first in range(arguments.first, arguments.first + arguments.count, BATCH):
			numbers = range(first, min(first + BATCH, arguments.first + arguments.count))
			try:
				for c in pool.map(lambda i: Connection(arguments.seed, i, server.port, arguments.only).make(), numbers):
					made[c.kind] += 1
					if b" 101 " in c.answer.split(b"\r\n")[0] and b"upgrade: websocket" not in c.answer.lower():
						raise AssertionError(f"connection {c.number} is upgraded: {c.answer[:300]}")
					if c.socket and c.end == "silence":
						silent.append(c.socket)
				server.check()
			except AssertionError as error:
				print(f"connections {numbers.start} to {numbers.stop - 1} of seed {arguments.seed}: {error}\nagain: {sys.argv[0]} {sys.argv[1]} --seed {arguments.seed} "
					f"--first {numbers.start} --count {len(numbers)}", file=sys.stderr)
				return None
			while len(silent) > SILENT_MAX:
				silent.popleft().close()
	return made


def main():
	a = argparse.ArgumentParser(description="hostile connections to obsim serve")
	a.add_argument("obsim")
	a.add_argument("--count", type=int, default=200)
	a.add_argument("--seed", type=int, default=1)
	a.add_argument("--first", type=int, default=0)
	a.add_argument("--only", choices=KINDS)
	a.add_argument("--under", default="", help="a command that obsim is started by")
	arguments = a.parse_args()
	server = Server(arguments.obsim, arguments.under)
	try:
		made = fuzz(server, arguments)
		server.end()
	except AssertionError as error:
		print(error, file=sys.stderr)
		made = None
	finally:
		if server.run.poll() is None:
			server.run.kill()
	if made is None:
		sys.exit(1)
	print(f"{made.total()} connections, the universe stepped on and each viewer was let in: " + ", ".join(f"{k} {n}" for k, n in sorted(made.items())))


if __name__ == "__main__":
	main()
