"""Reads MCAP, by its specification (https://mcap.dev/spec): records, and messages as their schemas say."""

import struct

import protobuf

MAGIC = b"\x89MCAP0\r\n"


def records(data):
	"""(type, content) of each record."""
	assert data.startswith(MAGIC) and data.endswith(MAGIC)
	at = len(MAGIC)
	while at < len(data) - len(MAGIC):
		kind, size = struct.unpack_from("<BQ", data, at)
		yield kind, data[at + 9:at + 9 + size]
		at += 9 + size
	assert at == len(data) - len(MAGIC)


def texts(data, n):
	"""n texts, each with its length before it, and what is behind them."""
	found = []
	for _ in range(n):
		size = struct.unpack_from("<I", data)[0]
		found.append(data[4:4 + size])
		data = data[4 + size:]
	return (*found, data)


def messages(data):
	"""By topic, lists of (time it could be read, time, message)."""
	schemas, channels, found = {}, {}, {}
	for kind, content in records(data):
		if kind == 3:
			name, encoding, schema, rest = texts(content[2:], 3)
			assert (encoding, rest) == (b"protobuf", b"")
			schemas[content[:2]] = name.decode(), protobuf.Schemas(schema)
		elif kind == 4:
			topic, encoding, _ = texts(content[4:], 2)
			assert encoding == b"protobuf"
			channels[content[:2]] = topic.decode(), schemas[content[2:4]]
			found[topic.decode()] = []
		elif kind == 5:
			topic, (name, schema) = channels[content[:2]]
			log, publish = struct.unpack_from("<QQ", content, 6)
			found[topic].append((log * 1e-9, publish * 1e-9, schema.decode(name, content[22:])))
	return found
