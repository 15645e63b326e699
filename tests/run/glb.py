"""A binary glTF file of a cube, as a program that knows nothing of obsim would write it."""

import json
import struct

CORNERS = [[1 if i >> k & 1 else -1 for k in range(3)] for i in range(8)]
TRIANGLES = [1, 3, 7, 1, 7, 5, 0, 4, 6, 0, 6, 2, 2, 6, 7, 2, 7, 3, 0, 1, 5, 0, 5, 4, 4, 5, 7, 4, 7, 6, 0, 2, 3, 0, 3, 1]


def cube(half, colour=None, mode=4):
	"""Its bytes; half: m; colour: linear RGB of its material, else it has none."""
	data = b"".join(struct.pack("<3f", *(half * x for x in c)) for c in CORNERS) + struct.pack("<36H", *TRIANGLES)
	primitive = {"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}
	text = {"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [primitive]}], "buffers": [{"byteLength": len(data)}],
		"bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
		"accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"}, {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]}
	if colour:
		primitive["material"] = 0
		text["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0, "roughnessFactor": .45}}]
	words = json.dumps(text).encode()
	words += b" " * (-len(words) % 4)
	chunks = struct.pack("<II", len(words), 0x4e4f534a) + words + struct.pack("<II", len(data), 0x004e4942) + data
	return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
