"""Bombs: small files that make much of their reader, a few of each kind. Each is refused in one line, or is read, within the budget
of files (src/universe/base/budget.h): 1 GB of memory with the program, 10 s of CPU."""

import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile
import zlib

import glb
import program

MEMORY, SECONDS = 1000, 10 # MB, s of CPU
CODES = 0, 1, 2 # read, failed or would not end, refused

# Runs its arguments; the last line of standard error has the exit code, the peak in kB, and CPU seconds.
METER = """import resource, subprocess, sys
limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (60, 60))
code = subprocess.run(sys.argv[1:], preexec_fn=limit).returncode
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(f"\\n{code} {used.ru_maxrss} {used.ru_utime + used.ru_stime}", file=sys.stderr)"""

SCENES = {
	"a loop": "while true do end",
	"a text that doubles": "local s = 'x' for i = 1, 60 do s = s .. s end",
	"a long text": "local s = ('x'):rep(2^40)",
	"texts in texts": "local t = {} for i = 1, 1e9 do t[i] = ('x'):rep(1e4) .. i end",
	"a large table": "local t = {} for i = 1, 1e10 do t[i] = t end",
	"a recursion": "local function f(x) return 1 + f({ x }) end f(1)",
	"calls in calls": "pcall(string.rep) local function f() return pcall(f) end while true do f() end",
	"brackets": "local x = " + "(" * 100000 + "1" + ")" * 100000,
	"tables in tables": "local x = " + "{" * 150000 + "}" * 150000,
	"a long concatenation": "local x = '' " + " .. ''" * 200000,
	"many names": "".join(f"local a{i} = {i}\n" for i in range(100000)),
	"a pattern": "(('a'):rep(1e5)):find(('.-'):rep(200) .. 'b')",
	"a format": "local t = {} for i = 1, 1e7 do t[i] = ('%99.99f'):format(1e308) end",
	"objects": "while true do sphere { radius = 1, at = { 0, 0, 1 } } end",
	"hulls": "for k = 1, 1e9 do local p = {} for i = 1, 64 do p[i] = { math.sin(k * i), math.cos(i), math.sin(i * i) } end hull { points = p } end",
	"paths": "local p = {} for i = 1, 1e7 do p[i] = { i, { 0, 0, i } } end while true do box { size = { 1, 1, 1 }, path = { points = p } } end",
	"names": "for i = 1, 1e9 do material(('m'):rep(40) .. i) {} end",
	"one file in itself": "dofile('scene.lua')",
	"itself by require": "require('scene')",
	"a heightfield": "heightfield { size = { 1, 1 }, cells = { 1e9, 1e9 }, height = function() return 0 end }",
	"a slow heightfield": "heightfield { size = { 9, 9 }, cells = { 300, 300 }, height = function() for i = 1, 1e9 do end return 0 end }",
	"heightfields": "for i = 1, 60 do heightfield { size = { 9, 9 }, cells = { 700, 700 }, at = { 0, 0, i }, height = function(x) return x end } end",
	"a recursion in a heightfield": "local function f() return 1 + f() end heightfield { size = { 9, 9 }, cells = { 9, 9 }, height = f }",
	"scripts": "for i = 1, 1e6 do script('s' .. i, ('-- \\n'):rep(1e5)) end",
	"a script that loads": "script('s', 'local t = {} for i = 1, 1e10 do t[i] = {} end') sphere { radius = 1, script = 's' }",
	"joints": "sphere { name = 'a', radius = 1, at = { 0, 0, 2 } } sphere { name = 'b', radius = 1, at = { 0, 3, 2 } } while true do ball { 'a', 'b', at = { 0, 0, 0 } } end",
}

def document(**more):
	"""A glTF description of one triangle."""
	return {"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
		"buffers": [{"byteLength": 36}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
		"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}], **more}


def pictured(image, kind):
	"""A cube with a picture of these bytes."""
	text = document(images=[{"bufferView": 1, "mimeType": "image/" + kind}], textures=[{"source": 0}],
		materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], buffers=[{"byteLength": 36 + len(image)}],
		bufferViews=[{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": len(image)}])
	text["meshes"][0]["primitives"][0].update(material=0, attributes={"POSITION": 0, "TEXCOORD_0": 1})
	text["accessors"].append({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"})
	return glb.whole(text, TRIANGLE + image + bytes(-len(image) % 4))


def png(width, height, depth=8, colours=2, data=b""):
	chunk = lambda kind, content: struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
	return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colours, 0, 0, 0)) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def jpeg(width, height, scans):
	"""A progressive JPEG that claims this size and repeats an empty scan."""
	part = lambda mark, data: b"\xff" + bytes([mark]) + struct.pack(">H", len(data) + 2) + data
	return (b"\xff\xd8" + part(0xdb, b"\0" + b"\1" * 64) + part(0xc2, struct.pack(">BHHB", 8, height, width, 1) + b"\1\x11\0")
		+ part(0xc4, b"\0\1" + b"\0" * 15 + b"\0") + (part(0xda, b"\1\1\0\0\0\0") + b"\0") * scans + b"\xff\xd9")


TRIANGLE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
ZEROS = zlib.compress(bytes(1 << 28), 9)
MESHES = {
	"equal triangles": lambda: glb.mesh([(0, 0, 0), (90, 0, 0), (0, 90, 1)], [(0, 1, 2)] * 93000),
	"slender triangles": lambda: glb.mesh([(i * 1e-4, -4e3, 0) for i in range(300)] + [(i * 1e-4, 4e3, 1) for i in range(300)], [(i, i + 1, 300 + i) for i in range(299)] * 300),
	"a count": lambda: glb.whole(document(accessors=[{"bufferView": 0, "componentType": 5126, "count": 4294967295, "type": "VEC3"}]), TRIANGLE),
	"no data, but a count": lambda: glb.whole(document(accessors=[{"componentType": 5126, "count": 500000000, "type": "VEC3"}]), TRIANGLE),
	"a sparse accessor": lambda: glb.whole(document(accessors=[{"componentType": 5126, "count": 500000000, "type": "VEC3", "sparse": {"count": 1,
		"indices": {"bufferView": 0, "componentType": 5125}, "values": {"bufferView": 0}}}]), TRIANGLE),
	"a claim of a buffer": lambda: glb.whole(document(buffers=[{"byteLength": 1 << 40}]), TRIANGLE),
	"instances": lambda: glb.whole(document(nodes=[{"mesh": 0} for _ in range(60000)], scenes=[{"nodes": list(range(60000))}]), TRIANGLE),
	"a tree of instances": lambda: glb.whole(document(nodes=[{"children": [i + 1] * 40, "mesh": 0} for i in range(60)] + [{"mesh": 0}]), TRIANGLE),
	"a ring of nodes": lambda: glb.whole(document(nodes=[{"children": [1], "mesh": 0}, {"children": [0], "mesh": 0}], scenes=[{"nodes": [0]}]), TRIANGLE),
	"primitives": lambda: glb.whole(document(meshes=[{"primitives": [{"attributes": {"POSITION": 0}}] * 9000}]), TRIANGLE),
	"nested extras": lambda: glb.whole(document(), TRIANGLE).replace(b'"nodes"', b'"extras"', 1)[:20] + b"[" * 100000,
	"a PNG's claim": lambda: pictured(png(65535, 65535), "png"),
	"a PNG of zeros": lambda: pictured(png(1 << 14, 1 << 14, 1, 0, ZEROS), "png"),
	"a PNG of more zeros than pixels": lambda: pictured(png(8, 8, 8, 2, ZEROS), "png"),
	"a JPEG's claim": lambda: pictured(jpeg(65535, 65535, 1), "jpeg"),
	"scans of a JPEG": lambda: pictured(jpeg(4000, 2000, 50000), "jpeg"),
}

LAUGHS = '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "ha">' + "".join(f'<!ENTITY {b} "{f"&{a};" * 20}">' for a, b in zip("abcdefghi", "bcdefghij")) + "]>"
BODY = '<body><geom size="1"/>'
MODELS = {
	"entities.xml": LAUGHS + "<mujoco model='&j;'><worldbody>&j;</worldbody></mujoco>",
	"entities.urdf": LAUGHS + "<robot name='&j;'><link name='&j;'/></robot>",
	"nested.xml": "<mujoco><worldbody>" + BODY * 50000 + "</body>" * 50000 + "</worldbody></mujoco>",
	"replicated.xml": "<mujoco><worldbody>" + '<replicate count="1000" offset="3 0 0">' * 3 + BODY + "<freejoint/></body>" + "</replicate>" * 3 + "</worldbody></mujoco>",
	"included.xml": '<mujoco><include file="included.xml"/><include file="included.xml"/><worldbody/></mujoco>',
	"flex.xml": '<mujoco><worldbody><flexcomp name="f" type="grid" count="900 900 900" spacing=".1 .1 .1" mass="1"/></worldbody></mujoco>',
	"composite.xml": '<mujoco><worldbody><body><composite type="grid" count="3000 3000 1" spacing="1"><geom size=".1" type="capsule"/></composite></body></worldbody></mujoco>',
	"field.xml": '<mujoco><asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset><worldbody><geom type="hfield" hfield="h"/></worldbody></mujoco>',
	"texture.xml": '<mujoco><asset><texture name="t" type="2d" builtin="flat" width="60000" height="60000"/></asset><worldbody/></mujoco>',
	"keys.xml": '<mujoco><size nkey="2000000000" nuser_body="1000000000"/><worldbody/></mujoco>',
	"chain.urdf": "<robot name='r'><link name='l0'/>" + "".join(f"<link name='l{i + 1}'/><joint name='j{i}' type='fixed'><parent link='l{i}'/><child link='l{i + 1}'/></joint>"
		for i in range(20000)) + "</robot>",
}

VARIABLE = '<ScalarVariable name="v{0}" valueReference="{0}" causality="input"><Real/></ScalarVariable>'
FMU = '<?xml version="1.0"?><fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m" canGetAndSetFMUstate="true" canSerializeFMUstate="true"/><ModelVariables>{}</ModelVariables></fmiModelDescription>'
DESCRIPTIONS = {
	"zeros": lambda: b"<x>" + bytes(1 << 26),
	"blanks": lambda: FMU.format(" " * (1 << 26)).encode(),
	"entities": lambda: (LAUGHS + FMU.format("&j;").partition("?>")[2]).encode(),
	"nested": lambda: FMU.format("<x>" * 1000000).encode(),
	"variables": lambda: FMU.format("".join(VARIABLE.format(i) for i in range(40000))).encode(),
	"a long name": lambda: FMU.format(VARIABLE.format("9" * (1 << 20))).encode(),
}


@unittest.skipIf(program.SANITIZED, "a sanitizer needs memory of its own")
class Bombs(unittest.TestCase):
	def setUp(self):
		self.folder = tempfile.mkdtemp(prefix="obsim-bombs-")
		self.addCleanup(shutil.rmtree, self.folder)

	def write(self, name, content):
		path = os.path.join(self.folder, name)
		with open(path, "wb") as f:
			f.write(content if isinstance(content, bytes) else content.encode())
		return path

	def read(self, what, *words, codes=CODES):
		"""Runs obsim WORDS, and judges it."""
		with self.subTest(what=what, words=words[0]):
			done = subprocess.run([sys.executable, "-c", METER, program.OBSIM, *words], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
				text=True, errors="replace", timeout=program.PATIENCE)
			*said, used = done.stderr.strip().split("\n")
			code, kilobytes, cpu = used.split()
			said = [line for line in said if line.strip()]
			self.assertIn(int(code), codes, said[:3])
			if code != "0":
				self.assertEqual(len(said), 1, said[:5])
				self.assertLess(len(said[0]), 2000)
			self.assertLess(int(kilobytes) >> 10, MEMORY, said)
			self.assertLess(float(cpu), SECONDS + 1, said) # the program starts and ends, too
			if os.environ.get("OBSIM_BOMBS"):
				print(f"{what}: exit {code}, {int(kilobytes) >> 10} MB, {cpu} s: {' '.join(said)[:150]}")

	def run_scene(self, what, text, **more):
		self.read(what, "run", self.write("scene.lua", text), "--duration", ".02", "--workers", "1", **more)

	def test_scenes(self):
		for what, text in SCENES.items():
			self.run_scene(what, text)

	@unittest.skipUnless(program.MESHES, "built without tinygltf")
	def test_meshes(self):
		for what, make in MESHES.items():
			self.write("mesh.glb", make())
			for scene in "mesh { file = 'mesh.glb' }", "box { size = { 1, 1, 1 }, at = { 0, 0, 1 }, mesh = 'mesh.glb' }":
				self.run_scene(what, scene)

	def test_fmus(self):
		for what, make in DESCRIPTIONS.items():
			with zipfile.ZipFile(os.path.join(self.folder, "m.fmu"), "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
				archive.writestr("modelDescription.xml", make())
				archive.writestr("binaries/linux64/m.so", bytes(10))
			self.run_scene(what, "sphere { radius = 1, mass = 1, fmu = 'm.fmu' }")
		with zipfile.ZipFile(os.path.join(self.folder, "m.fmu"), "w", zipfile.ZIP_DEFLATED) as archive:
			archive.writestr("modelDescription.xml", FMU.format(""))
			with archive.open("binaries/linux64/m.so", "w", force_zip64=True) as library: # 640 MB
				for _ in range(10):
					library.write(bytes(1 << 26))
		self.run_scene("a library of zeros", "sphere { radius = 1, mass = 1, fmu = 'm.fmu' }", codes=(2,))

	def test_models(self):
		for name, text in MODELS.items():
			self.read(name, "import", self.write(name, text), "--out", os.path.join(self.folder, "out"))

	def test_checkpoints(self):
		path = os.path.join(self.folder, "checkpoint")
		self.assertEqual(program.call("run", program.scene("stack"), "--duration", ".1", "--checkpoint", path).returncode, 0)
		with open(path, "rb") as f:
			good = f.read()
		areas, = struct.unpack_from("<I", good, 88)
		for area in range(areas): # claims of each part, in a file that is large enough, with the right checksum of the table
			head, (element, _, count, offset, _) = bytearray(good[:128 + 32 * areas]), struct.unpack_from("<II3Q", good, 128 + 32 * area)
			wanted = min((1 << 29) // element, 1 << 20)
			moved = (offset + element * wanted + 63) // 64 * 64 - (offset + element * count + 63) // 64 * 64
			struct.pack_into("<Q", head, 128 + 32 * area + 8, wanted)
			for later in range(area + 1, areas):
				struct.pack_into("<Q", head, 128 + 32 * later + 16, struct.unpack_from("<Q", head, 128 + 32 * later + 16)[0] + moved)
			struct.pack_into("<Q", head, 16, len(good) + moved)
			struct.pack_into("<Q", head, 120, 0)
			struct.pack_into("<Q", head, 120, crc64(head))
			self.write("bomb", bytes(head))
			os.truncate(os.path.join(self.folder, "bomb"), len(good) + moved)
			self.read(f"checkpoint, part {area}", "run", "--resume", "bomb", codes=(2,))

	def test_records(self):
		path = os.path.join(self.folder, "record")
		self.assertEqual(program.call("run", program.scene("stack"), "--duration", ".35", "--record", path).returncode, 0)
		with open(path, "rb") as f:
			good = f.read()
		states, objects = 22, 11
		places = [at for n in (states, objects) for at in range(0, len(good) - 8, 8) if good[at:at + 8] == struct.pack("<Q", n)]
		self.assertGreater(len(places), 4)
		for at in places: # the lengths of datasets, where they are
			for claim in 1 << 24, 1 << 44:
				self.write("bomb.h5", good[:at] + struct.pack("<Q", claim) + good[at + 8:])
				self.read(f"record, {claim} at {at}", "export", "bomb.h5", "page.html")

	def test_schedules(self):
		path = os.path.join(self.folder, "schedule")
		words = "run", program.scene("stack"), "--duration", ".05"
		self.assertEqual(program.call(*words, "--sync", "free", "--set", "coupling=own", "--set", f"record_schedule={path}").returncode, 0)
		with open(path, "rb") as f:
			good = f.read()
		first = good.index(b"step")
		for at in range(first, first + 48, 4):
			for claim in 0x7fffffff, 0xffffffff, 100000:
				bomb = bytearray(good)
				struct.pack_into("<I", bomb, at, claim)
				self.write("bomb", bytes(bomb))
				self.read(f"schedule, {claim} at {at - first}", *words, "--set", "replay_schedule=bomb", codes=(1, 2))

	def test_other_lists(self):
		"""Lists of requests, results of experiments."""
		for what, text in ("a long line", "x" * (1 << 27)), ("many lines", "1,2,3\n" * (1 << 24)), ("zeros", "\0" * (1 << 27)):
			self.write("list", text)
			self.read(what, "run", program.scene("stack"), "--replay-requests", "list", codes=(1, 2))
			os.makedirs(os.path.join(self.folder, "out"), exist_ok=True)
			shutil.copy(os.path.join(self.folder, "list"), os.path.join(self.folder, "out", "results.csv"))
			self.read(what, "compare", program.scene("stack"), "--duration", ".02", "--repeats", "1", "--out", "out")


TABLE = []
for crc in range(256): # ECMA-182, reflected
	for _ in range(8):
		crc = crc >> 1 ^ (0xc96c5795d7870f42 if crc & 1 else 0)
	TABLE.append(crc)


def crc64(data):
	crc = (1 << 64) - 1
	for byte in data:
		crc = crc >> 8 ^ TABLE[(crc ^ byte) & 255]
	return crc ^ (1 << 64) - 1


if __name__ == "__main__":
	unittest.main()
