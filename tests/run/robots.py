"""Models of others in obsim and in MuJoCo: robots.py FOLDER|FILE ... [--seconds 2] [--step 1/960]

Prints a line for each MJCF and URDF model: is it imported, are its masses and moments MuJoCo's, does it move as there? Models
hang: free roots are held as they begin, without contacts, limits, dry friction and actuators. The environment names the
programs: OBSIM, REFERENCE (tests/run/reference.c); SCENES may be empty.

    obj    objects that move                  mass   largest relative error of a mass
    jnt    joints                             moment largest error of a tensor of inertia, of the body's largest moment
    left   lines of what is left out          apart  m, largest distance from MuJoCo's centres of mass in the end
    swing  m, the way of the centre of mass   twin   m, the same of MuJoCo's own twin, which begins 1e-9 away
           that went farthest                 fine   m, the same of MuJoCo with steps twice as long
"""

import argparse
import math
import os
import re
import subprocess
import sys
import tempfile

import program

REFERENCE = os.environ["REFERENCE"]
OBSERVER = """
sphere {{ name = "observer", radius = .1, at = {{ 900, 0, 0 }}, static = true, hits = {{}}, script = [[
function on_start() self:wake({seconds}) end
function on_wake()
	for i, name in ipairs {{ {names} }} do
		local o = find(name)
		print("at", i, o:position()) print("turned", i, o:attitude())
	end
end
]] }}
"""


def matrix(w, x, y, z):
	return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
		[2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
		[2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def product(a, b):
	return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transposed(a):
	return [list(row) for row in zip(*a)]


def numbers(line, key):
	found = re.search(rf"\b{key} = \{{?([^}},]+(?:, [^}},]+)*)\}}?", line)
	return [float(x) for x in found.group(1).split(",")] if found else None


class Body:
	"""An object of an imported scene, from its line."""

	def __init__(self, line):
		line = re.sub(r"parts = \{.*\} \}, at = ", "at = ", line)
		self.name = re.search(r'name = "([^"]*)"', line).group(1)
		self.mass = float(re.search(r"\bmass = ([^,]+)", line).group(1))
		self.at = numbers(line, "at")
		turn = numbers(line, "q")
		self.frame = matrix(*turn) if turn else matrix(1, 0, 0, 0)
		moments = numbers(line, "inertia")
		diagonal = [[moments[i] if i == j else 0 for j in range(3)] for i in range(3)]
		i = product(product(self.frame, diagonal), transposed(self.frame))
		self.tensor = [i[0][0], i[1][1], i[2][2], i[0][1], i[0][2], i[1][2]]


class Twin:
	"""A body in MuJoCo."""

	def __init__(self, line):
		*numbers, self.name = line.split(maxsplit=25)
		x = [float(n) for n in numbers]
		self.mass, self.tensor, self.start, self.end, self.turn, self.other = x[0], x[1:7], x[7:10], x[10:13], x[13:22], x[22:25]


def reference(path, seconds, *hang):
	"""Bodies of the model in MuJoCo, in the order of the scene."""
	done = subprocess.run([REFERENCE, path, str(seconds), *map(str, hang)], capture_output=True, text=True,
		timeout=program.PATIENCE, check=True)
	return [Twin(line) for line in done.stdout.splitlines()]


def convert(path):
	"""The call of obsim import, and the objects that move."""
	done = program.call("import", path)
	return done, [Body(line) for line in done.stdout.splitlines() if " inertia = " in line]


def error_of_mass(bodies, expected):
	return max((abs(b.mass / e.mass - 1) for b, e in zip(bodies, expected)), default=0)


def error_of_inertia(bodies, expected):
	return max((abs(x - y) / max(e.tensor[:3]) for b, e in zip(bodies, expected) for x, y in zip(b.tensor, e.tensor)), default=0)


def states(scene, bodies, seconds, folder, step="1/240"):
	"""Places and attitudes of the bodies after some time."""
	path = os.path.join(folder, "scene.lua")
	names = ", ".join(f'"{b.name}"' for b in bodies)
	with open(path, "w", encoding="utf-8") as f:
		f.write(scene + OBSERVER.format(seconds=seconds, names=names))
	done = program.call("run", path, "--step", step, "--duration", seconds + 1 / 60, "--set", "measure=end")
	if done.returncode:
		raise ValueError(done.stderr.strip().splitlines()[-1])
	found = [{} for _ in bodies]
	for what, i, values in re.findall(r"^obsim: (at|turned) (\d+) (.*)$", done.stderr, re.MULTILINE):
		found[int(i) - 1][what] = [float(x) for x in values.split()]
	return found


def hang(scene, bodies):
	"""The scene as the reference moves a model that hangs."""
	lines, joined = [], set()
	for line in scene.splitlines():
		if re.match(r"(hinge|slider|ball|universal|fixed) ", line):
			line = re.sub(r", (low|high|friction) = [^,}]+", "", line)
			line = re.sub(r", motor = \{[^}]*\}", "", line)
			joined.add(re.search(r'"([^"]*)"', line).group(1))
		line = re.sub(r", (group = \d+|hits = \{[^}]*\})", "", line)
		lines.append(re.sub(r'^(\w+ \{ name = "[^"]*")', r"\1, hits = {}", line))
	lines += [f'fixed {{ "{b.name}" }}' for b in bodies if b.name not in joined]
	return "\n".join(lines) + "\n"


def farthest(one, other):
	return max(map(math.dist, one, other), default=0)


def finest(path, seconds):
	"""Bodies in MuJoCo with steps that are short enough, and with steps twice as long."""
	step = 1e-4
	found = reference(path, seconds, step)
	while step > 1e-6 and not all(math.isfinite(x) for b in found for x in b.end):
		step /= 4
		found = reference(path, seconds, step)
	return found, reference(path, seconds, 2 * step)


def try_model(path, seconds, step):
	"""A line of the table."""
	done, bodies = convert(path)
	if done.returncode:
		return done.stderr.strip()
	expected, coarse = finest(path, seconds)
	if len(expected) != len(bodies):
		return f"{len(bodies)} objects, {len(expected)} in MuJoCo"
	ends = [e.end for e in expected]
	with tempfile.TemporaryDirectory() as folder:
		try:
			found = states(hang(done.stdout, bodies), bodies, seconds, folder, step)
			apart = f"{farthest([f['at'] for f in found], ends):8.1e}"
		except (ValueError, KeyError, subprocess.TimeoutExpired) as e:
			apart = f" failed: {e} "
	joints = len(re.findall(r"^(?:hinge|slider|ball|universal|fixed|distance) ", done.stdout, re.MULTILINE))
	return f"{len(bodies):4} {joints:4} {len(done.stderr.splitlines()):4} {error_of_mass(bodies, expected):8.1e} " \
		f"{error_of_inertia(bodies, expected):8.1e} {apart} {farthest([e.other for e in expected], ends):8.1e} " \
		f"{farthest([c.end for c in coarse], ends):8.1e} {farthest([e.start for e in expected], ends):6.2f}"


def models(places):
	for place in places:
		for folder, _, names in sorted(os.walk(place)) if os.path.isdir(place) else [("", [], [place])]:
			for name in sorted(names):
				if name.endswith((".xml", ".urdf")):
					yield os.path.join(folder, name)


def main():
	parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
	parser.add_argument("places", nargs="+")
	parser.add_argument("--seconds", type=float, default=2)
	parser.add_argument("--step", default="1/960")
	options = parser.parse_args()
	print(f"{'model':40}  obj  jnt left     mass   moment    apart     twin     fine  swing")
	for path in models(options.places):
		try:
			line = try_model(path, options.seconds, options.step)
		except (subprocess.SubprocessError, ValueError) as e:
			line = str(e)
		print(f"{os.path.basename(path):40} {line}", flush=True)


if __name__ == "__main__":
	main()
