#!/usr/bin/env -S python3 -IS
"""private_shm.py PROGRAM ARGUMENT ..: runs a test with a /dev/shm of its own, in a mount namespace, so that tests on
one machine do not interfere. If that is not allowed, /dev/shm is shared, and unique names keep the tests apart.

PRIVATE_SHM in the environment: options for the memory file system (tmpfs), such as size=32m.
"""

import ctypes
import os
import sys

CLONE_NEWNS, CLONE_NEWUSER = 0x20000, 0x10000000
MS_NOSUID, MS_NODEV, MS_REC, MS_PRIVATE = 2, 4, 0x4000, 0x40000

libc = ctypes.CDLL(None)


def write(path, text):
	with open(path, "w") as f:
		f.write(text)


def enter_namespace():
	"""Enters a user namespace with the same user and group, if the outer one does not allow mounts."""
	if libc.unshare(CLONE_NEWNS) == 0:
		return True
	user, group = os.geteuid(), os.getegid()
	if libc.unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0:
		return False
	write("/proc/self/uid_map", f"{user} {user} 1")
	write("/proc/self/setgroups", "deny")
	write("/proc/self/gid_map", f"{group} {group} 1")
	return True


def keep_mounts():
	"""Keeps mounts from other namespaces. In a chroot "/" may be no mount point: the mount that holds /dev/shm is enough."""
	return any(libc.mount(None, path, None, MS_REC | MS_PRIVATE, None) == 0 for path in (b"/", b"/dev/shm", b"/dev"))


def main():
	options = os.environ.get("PRIVATE_SHM", "").encode() or None
	if enter_namespace() and keep_mounts():
		libc.mount(b"tmpfs", b"/dev/shm", b"tmpfs", MS_NOSUID | MS_NODEV, options)
	os.execvp(sys.argv[1], sys.argv[1:])


main()
