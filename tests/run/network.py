"""Two machines made of this one: network namespaces, and between them a cable, or a link on which packets take their time."""

import collections
import contextlib
import fcntl
import os
import select
import shutil
import struct
import subprocess
import threading
import time

PATH = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"
NET = "10.99.7"
DELAYED = 1 << 20 # limit of bytes of packets under way in each direction; more are lost


def ip(*words):
	return subprocess.run([shutil.which("ip", path=PATH), *words], check=True, capture_output=True, text=True).stdout


def open_tun(name):
	"""A network device whose packets are read and written through a descriptor."""
	set_interface, tun, no_information = 0x400454ca, 1, 0x1000 # linux/if_tun.h
	fd = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
	fcntl.ioctl(fd, set_interface, struct.pack("16sH22x", name.encode(), tun | no_information))
	return fd


class Relay(threading.Thread):
	"""Forwards packets between both devices, after a delay (s): the kernel may have no netem."""

	def __init__(self, devices, delay):
		super().__init__()
		self.fds = [open_tun(device) for device in devices]
		self.delay = delay
		self.ended, self.end = os.pipe()
		self.waiting = [collections.deque(), collections.deque()] # for each descriptor: when it is due, a packet

	def take(self, i):
		with contextlib.suppress(BlockingIOError):
			while True:
				packet = os.read(self.fds[i], 1 << 16)
				if sum(len(p) for _, p in self.waiting[1 - i]) < DELAYED:
					self.waiting[1 - i].append((time.monotonic() + self.delay, packet))

	def deliver(self, i):
		while self.waiting[i] and self.waiting[i][0][0] <= time.monotonic():
			with contextlib.suppress(OSError): # a device that is down, or full, loses it
				os.write(self.fds[i], self.waiting[i].popleft()[1])

	def run(self):
		ready = []
		while self.ended not in ready:
			due = min((packets[0][0] for packets in self.waiting if packets), default=None)
			ready, _, _ = select.select([*self.fds, self.ended], [], [], None if due is None else max(0, due - time.monotonic()))
			for i in 0, 1:
				if self.fds[i] in ready:
					self.take(i)
				self.deliver(i)

	def stop(self):
		os.close(self.end)
		self.join()
		for fd in (*self.fds, self.ended):
			os.close(fd)


class Link:
	"""Namespaces, their devices and addresses, by number. Raises OSError or CalledProcessError if they cannot be
	created."""

	def __init__(self, name, delay):
		"""delay: s, one way; None: a cable"""
		self.space = [f"{name}{i}" for i in (0, 1)]
		self.device = [f"{name[-10:]}l{i}" for i in (0, 1)] # 15 bytes at most
		self.address = [f"{NET}.{i + 1}" for i in (0, 1)]
		self.relay = None
		self.stack = contextlib.ExitStack()
		with self.stack:
			for space in self.space:
				ip("netns", "add", space)
				self.stack.callback(ip, "netns", "del", space)
			self.join(delay)
			for i in 0, 1:
				ip("link", "set", self.device[i], "netns", self.space[i])
				ip("-n", self.space[i], "addr", "add", self.address[i] + "/24", "dev", self.device[i])
				ip("-n", self.space[i], "link", "set", self.device[i], "up")
				ip("-n", self.space[i], "link", "set", "lo", "up")
			self.close = self.stack.pop_all().close  # may be called twice

	def join(self, delay):
		if delay is None:
			ip("link", "add", self.device[0], "type", "veth", "peer", "name", self.device[1])
			return
		self.relay = Relay(self.device, delay)
		self.relay.start()
		self.stack.callback(self.relay.stop)

	def inside(self, i):
		"""Words before a command that is to run there."""
		return [shutil.which("ip", path=PATH), "netns", "exec", self.space[i]]

	def processes(self):
		"""Ids of all processes in either."""
		return [int(pid) for space in self.space for pid in ip("netns", "pids", space).split()]

	def cut(self):
		ip("-n", self.space[1], "link", "set", self.device[1], "down")

	def packets(self):
		"""Number of packets that the first has received."""
		return int(subprocess.run([*self.inside(0), "cat", f"/sys/class/net/{self.device[0]}/statistics/rx_packets"], check=True,
			stdout=subprocess.PIPE).stdout)
