"""Binary glTF files, as any other program would write them."""

import json
import struct
import zlib

CORNERS = [[1 if i >> k & 1 else -1 for k in range(3)] for i in range(8)]
TRIANGLES = [1, 3, 7, 1, 7, 5, 0, 4, 6, 0, 6, 2, 2, 6, 7, 2, 7, 3, 0, 1, 5, 0, 5, 4, 4, 5, 7, 4, 7, 6, 0, 2, 3, 0, 3, 1]
RED, GREEN, BLUE, GREY = (230, 20, 20), (20, 180, 30), (20, 40, 220), (200, 200, 200)
QUARTERS = [[RED] * 32 + [GREEN] * 32] * 32 + [[BLUE] * 32 + [GREY] * 32] * 32 # a picture, the upper row first


def png(rows):
	"""rows of (red, green, blue), of 255."""
	def chunk(kind, data):
		return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
	pixels = b"".join(b"\0" + bytes(sum(row, ())) for row in rows)
	return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0))
		+ chunk(b"IDAT", zlib.compress(pixels)) + chunk(b"IEND", b""))


def whole(text, data):
	"""The bytes of a file: its description, and the data that this describes."""
	words = json.dumps(text).encode()
	words += b" " * (-len(words) % 4)
	chunks = struct.pack("<II", len(words), 0x4e4f534a) + words + struct.pack("<II", len(data), 0x004e4942) + data
	return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def mesh(points, triangles):
	"""Triangles of points (x, y, z); z points up, as in obsim."""
	turned = [(x, z, -y) for x, y, z in points]
	places = b"".join(struct.pack("<3f", *p) for p in turned)
	corners = b"".join(struct.pack("<3I", *t) for t in triangles)
	return whole({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
		"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
		"accessors": [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
			"min": [min(x) for x in zip(*turned)], "max": [max(x) for x in zip(*turned)]},
			{"bufferView": 1, "componentType": 5125, "count": 3 * len(triangles), "type": "SCALAR"}],
		"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(places)},
			{"buffer": 0, "byteOffset": len(places), "byteLength": len(corners)}],
		"buffers": [{"byteLength": len(places) + len(corners)}]}, places + corners)


def cube(half, colour=None, mode=4, picture=None, shine=False):
	"""Its bytes; half: m; colour: linear RGB of its material, else it has none; picture: on it, upright as seen
	along y, once on each of those faces; shine: the picture also sets roughness and metal."""
	data = b"".join(struct.pack("<3f", *(half * x for x in c)) for c in CORNERS) + struct.pack("<36H", *TRIANGLES)
	primitive = {"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}
	text = {"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [primitive]}], "buffers": [{"byteLength": len(data)}],
		"bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
		"accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"}, {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]}
	if colour:
		primitive["material"] = 0
		text["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0, "roughnessFactor": .45}}]
	if picture:
		image = png(picture)
		places = b"".join(struct.pack("<2f", (c[0] + 1) / 2, (1 - c[1]) / 2) for c in CORNERS) # y points up in glTF
		text["bufferViews"] += [{"buffer": 0, "byteOffset": 168, "byteLength": 64}, {"buffer": 0, "byteOffset": 232, "byteLength": len(image)}]
		text["accessors"].append({"bufferView": 2, "componentType": 5126, "count": 8, "type": "VEC2"})
		text.update(textures=[{"source": 0}], images=[{"bufferView": 3, "mimeType": "image/png"}])
		primitive["attributes"]["TEXCOORD_0"] = 2
		looks = text["materials"][0]["pbrMetallicRoughness"]
		looks["baseColorTexture"] = {"index": 0}
		if shine:
			looks.update(metallicRoughnessTexture={"index": 0}, metallicFactor=1, roughnessFactor=1)
		data += places + image + bytes(-len(image) % 4)
		text["buffers"][0]["byteLength"] = len(data)
	return whole(text, data)
