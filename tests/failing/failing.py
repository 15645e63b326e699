#!/usr/bin/env python3
"""Makes the Nth allocation, fork, mapping, open or write of a short run fail, for every N. The run must end with one
clear error for each failure and exit code 1 (2 while the scene is read), or go on and end in the right bits. Nothing
may be left behind, and no process may crash.

    failing.py OBSIM LIBRARY SCENES [KIND ...] [--every K [--first N]]

LIBRARY is failing.c, built. A run makes hundreds of allocations: with --every K, each Kth is tried, from the Nth on. N
is random and printed unless given, so different runs of the tests try different ones.
"""

import argparse
import json
import os
import random
import re
import resource
import subprocess
import sys
import tempfile

KINDS = ["alloc", "fork", "mmap", "open", "write"]
WALL_SECONDS = 600


class Run:
	def __init__(self, a, folder):
		self.a, self.folder = a, folder
		self.name = f"failing-{os.getpid()}"

	def once(self, kind, n, isolation):
		"""(the ended run, number of its processes whose Nth call failed, number of calls)."""
		mark = os.path.join(self.folder, "mark")
		words = [self.a.obsim, "run", os.path.join(self.a.scenes, "stack.lua"), "--duration", ".05", "--workers", "2", "--isolation", isolation,
			"--name", self.name, "--json", os.path.join(self.folder, "out.json"), "--series", os.path.join(self.folder, "s.csv"),
			"--trace", os.path.join(self.folder, "t.json"), "--checkpoint", os.path.join(self.folder, "c")]
		for file in os.listdir(self.folder):
			os.remove(os.path.join(self.folder, file))
		env = dict(os.environ, FAIL_CALL=f"{kind}:{n}", FAIL_MARK=mark, LD_PRELOAD=self.a.library)
		done = subprocess.run(words, env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=WALL_SECONDS)
		lines = open(mark).read().split("\n") if os.path.exists(mark) else []
		calls = max([int(l.split()[1]) for l in lines if l.startswith("calls")], default=0)
		return done, sum(l.startswith("failed") for l in lines), calls

	def state(self):
		try:
			with open(os.path.join(self.folder, "out.json")) as f:
				return json.load(f)["state_hash"]
		except (OSError, ValueError, KeyError):
			return None

	def faults(self, done, failed, right):
		"""A process that forks hands its count on, so several processes may each meet an Nth call, and each says so."""
		said = [l for l in done.stderr.split("\n") if l]
		if done.returncode not in (0, 1, 2):  # 2: a failure while the scene is read
			yield f"exit code {done.returncode}"
		errors = sum(l.startswith("obsim: ") and not l.startswith("obsim: warning") for l in said)
		if done.returncode and not 1 <= errors <= max(failed, 1):
			yield f"{errors} errors of {failed} failures"
		if done.returncode == 0 and self.state() != right:
			yield "another state"
		if [l for l in said if not l.startswith("obsim: ")]:
			yield "words that are not obsim's"
		if re.search(r"SIG(SEGV|ABRT|BUS|ILL|FPE)", done.stderr):
			yield "a crash"
		if os.path.exists("/dev/shm/obsim." + self.name):
			yield "a universe was left behind"
			os.remove("/dev/shm/obsim." + self.name)


def main():
	p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
	p.add_argument("obsim", type=os.path.abspath)
	p.add_argument("library", type=os.path.abspath)
	p.add_argument("scenes", type=os.path.abspath)
	p.add_argument("kinds", nargs="*", default=KINDS)
	p.add_argument("--every", type=int, default=1)
	p.add_argument("--first", type=int)
	p.add_argument("--isolation", choices=["thread", "process"])
	a = p.parse_args()
	first = a.first or random.randint(1, a.every)
	print(f"allocations from number {first} on: --every {a.every} --first {first}", flush=True)
	resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
	tried = bad = 0
	with tempfile.TemporaryDirectory(prefix="obsim-failing-") as folder:
		run = Run(a, folder)
		for kind in a.kinds:
			for isolation in [a.isolation] if a.isolation else ["thread", "process"]:
				done, _, calls = run.once(kind, 0, isolation)
				right = run.state()
				if done.returncode or not right or not calls:
					print(f"{kind}, {isolation}: does not run: {done.stderr}")
					return 1
				n, missed = first if kind == "alloc" else 1, 0
				while missed < 3:  # a worker's own calls are not among those of the host
					done, failed, _ = run.once(kind, n, isolation)
					missed = 0 if failed else missed + 1
					tried += failed > 0
					found = list(run.faults(done, failed, right))
					if found:
						bad += 1
						print(f"{kind} {n}, {isolation}: {', '.join(found)}: {done.stderr.strip()}", flush=True)
					n += a.every if kind == "alloc" else 1
	print(f"{tried} calls failed, {bad} badly")
	return 1 if bad else 0


if __name__ == "__main__":
	sys.exit(main())
