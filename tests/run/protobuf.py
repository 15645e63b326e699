"""Protocol buffers, as their description says: a reader of its own, and Google's, if that is there, to compare with."""

import struct

try:
	from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
except ImportError:
	descriptor_pb2 = None

ZERO = {1: 0., 2: 0., 3: 0, 5: 0, 7: 0, 8: False, 9: "", 12: b"", 14: 0}  # by the types of FieldDescriptorProto


def varint(data, at):
	value = shift = 0
	while True:
		value |= (data[at] & 127) << shift
		shift, at = shift + 7, at + 1
		if data[at - 1] < 128:
			return value, at


def fields(data):
	"""(number, value) of each: integers, or bytes."""
	at = 0
	while at < len(data):
		key, at = varint(data, at)
		if key & 7 == 0:
			value, at = varint(data, at)
		else:
			size, at = {1: (8, at), 5: (4, at)}.get(key & 7) or varint(data, at)
			assert at + size <= len(data) and key & 7 in (1, 2, 5)
			value, at = data[at:at + size], at + size
		yield key >> 3, value


def all_of(data, number):
	return [value for n, value in fields(data) if n == number]


def one_of(data, number, otherwise=b""):
	return (all_of(data, number) or [otherwise])[-1]


class Schemas:
	"""Those of a FileDescriptorSet."""

	def __init__(self, data):
		self.messages = {}
		for file in all_of(data, 1):
			assert one_of(file, 12) == b"proto3"
			for message in all_of(file, 4):
				name = "." + one_of(file, 2).decode() + "." + one_of(message, 1).decode()
				self.messages[name] = {one_of(f, 3): (one_of(f, 1).decode(), one_of(f, 5), one_of(f, 4) == 3, one_of(f, 6).decode())
					for f in all_of(message, 2)}
		self.pool = descriptor_pool.DescriptorPool() if descriptor_pb2 else None
		for file in descriptor_pb2.FileDescriptorSet.FromString(data).file if self.pool else ():
			self.pool.Add(file)

	def scalar(self, type_, name, value):
		if type_ == 11:
			return self.message(name, value)
		if type_ in (1, 7):
			return struct.unpack("<d" if type_ == 1 else "<I", value)[0]
		return value.decode() if type_ == 9 else bool(value) if type_ == 8 else value

	def message(self, name, data):
		known = self.messages[name]
		out = {n: [] if many else None if type_ == 11 else ZERO[type_] for n, type_, many, _ in known.values()}
		for number, value in fields(data):
			n, type_, many, of = known[number]
			if not many:
				out[n] = self.scalar(type_, of, value)
			elif type_ in (1, 7): # packed
				out[n] += struct.unpack(f"<{len(value) // (8 if type_ == 1 else 4)}{'d' if type_ == 1 else 'I'}", value)
			else:
				out[n].append(self.scalar(type_, of, value))
		return out

	def decode(self, name, data):
		"""A message as a dictionary; it reads the same by Google's."""
		out = self.message("." + name, data)
		if self.pool:
			kind = message_factory.MessageFactory(self.pool).GetPrototype(self.pool.FindMessageTypeByName(name))
			theirs = kind.FromString(data)
			assert theirs.FindInitializationErrors() == [] and not theirs.UnknownFields()
			self.same(out, theirs)
		return out

	def same(self, out, theirs):
		for n, value in out.items():
			their = getattr(theirs, n)
			if isinstance(value, list):
				assert len(value) == len(their)
			for mine, other in zip(value, their) if isinstance(value, list) else ((value, their),):
				if isinstance(mine, dict):
					self.same(mine, other)
				else:
					assert mine is None or mine == other or mine != mine, (n, mine, other)
