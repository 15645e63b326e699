#!/usr/bin/env python3
"""Checks the mathematical functions that built modules and their libraries import from the C library. Code that
computes state may use only functions that IEEE 754 rounds exactly, so that the bits do not depend on the processor.

symbols.py NM OBSIM MODULE.a...    the program, and the modules that compute state
"""
import re
import subprocess
import sys

# Exact, or rounded by IEEE 754, in every library.
EXACT = {"ceil", "copysign", "fabs", "fdim", "floor", "fma", "fmax", "fmin", "fmod", "frexp", "ilogb", "ldexp", "llrint",
	"llround", "logb", "lrint", "lround", "modf", "nearbyint", "nextafter", "remainder", "rint", "round", "roundeven",
	"scalbln", "scalbn", "sqrt", "trunc"}
# Libraries that compute state; each must be present, or this searches for the wrong names.
LIBRARIES = ["libode", "liblua", "libqhull"]


def symbols(nm, file, *options):
	"""Names that nm prints for this file, without versions."""
	lines = subprocess.run([nm, *options, file], check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
	return {line.split()[-1].partition("@")[0] for line in lines if re.match(r"[0-9a-f ]* \w \S", line)}


def linked(program):
	"""{name: path} of the libraries that a program is started with."""
	lines = subprocess.run(["ldd", program], check=True, stdout=subprocess.PIPE, text=True).stdout
	return dict(re.findall(r"^\s*(\S+?)\.so\S* => (\S+)", lines, flags=re.MULTILINE))


def inexact(names, mathematics):
	return sorted(n for n in names & mathematics if n not in EXACT and n.rstrip("fl") not in EXACT)


def main():
	nm, program, *modules = sys.argv[1:]
	paths = linked(program)
	mathematics = symbols(nm, paths["libm"], "-D", "--defined-only")
	own = symbols(nm, program, "-D", "--defined-only")
	wrong = [] if inexact({"sin", "powf", "sqrtf", "floorl"}, mathematics) == ["powf", "sin"] else ["symbols.py is blind"]
	for module in modules:
		wrong += [f"{module} calls {name}: take ob_{name} of src/universe/elementary/" for name in
			inexact(symbols(nm, module, "--undefined-only"), mathematics)]
	for library in LIBRARIES:
		path = next((p for name, p in paths.items() if name.startswith(library)), None)
		if not path:
			wrong.append(f"{program} is not linked with {library}")
			continue
		wrong += [f"{path} calls {name}: define it in src/universe/elementary/standard.c" for name in
			inexact(symbols(nm, path, "-D", "--undefined-only"), mathematics - own)]
	print(*wrong, f"{len(modules)} modules, {len(LIBRARIES)} libraries: {len(wrong)} wrong", sep="\n")
	sys.exit(1 if wrong or not modules else 0)


main()
