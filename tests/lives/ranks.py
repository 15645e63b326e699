#!/usr/bin/env python3
"""Random lives on three ranks, as far as ranks take them: the timetable and scripts create and remove objects.

ranks.py LIVES_TESTS OBSIM FIRST LAST    compares hashes with those of threads; both check invariants. Exit 1: one failed.
"""
import json
import os
import subprocess
import sys
import tempfile

lives, obsim, first, last = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
	"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}


def run(scene, *before):
	"""Hash of the state after 300 steps; else why there is none. A life that is too much work ends so in the same step everywhere."""
	try:
		done = subprocess.run([*before, obsim, "run", scene, "--workers", "2", "--check", "--duration", "5", "--set", "measure=end",
			"--json", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300, env=environment)
	except subprocess.TimeoutExpired:
		return "hangs"
	ends = [line for line in done.stderr.splitlines() if line.startswith("obsim: step ") and "takes more work" in line]
	if done.returncode == 1 and ends:
		return ends[0].split(":")[1].strip().replace(" ", "_") # each rank names objects of its own
	if done.returncode:
		return f"exit {done.returncode}: " + " ".join(l for l in done.stderr.splitlines() if l.startswith("obsim: "))[:300]
	return json.loads(done.stdout)["state_hash"]


failed = 0
with tempfile.TemporaryDirectory() as folder:
	for seed in range(first, last + 1):
		scene = os.path.join(folder, "life.lua")
		with open(scene, "w") as f:
			f.write(subprocess.run([lives, "lives", "--folder", folder, "--print", str(seed)], stdout=subprocess.PIPE, text=True, check=True).stdout)
		one, three = run(scene), run(scene, "mpirun", "-n", "3")
		if one != three or " " in one:
			failed += 1
			print(f"{seed}: threads: {one}; three ranks: {three}", flush=True)
print(f"{last - first + 1} lives on three ranks, {failed} failed")
sys.exit(failed > 0)
