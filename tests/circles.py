#!/usr/bin/env python3
"""Finds circles of calls: files of src/ that reach each other by the functions and data that they use. borders.py keeps the
includes free of them. Prints each circle; exit 1 if there is any.

circles.py BUILD    reads the object files of a build with the compiler's nm
First it looks for circles in graphs of its own, and fails if it does not find them.
"""
import pathlib
import shutil
import subprocess
import sys


def circles(uses):
    """Groups of files that lead to each other, sorted. uses: {file: files that it uses}."""
    reach = {}
    for start in uses:
        found, todo = set(), [start]
        while todo:
            more = set(uses.get(todo.pop(), ())) - found
            found |= more
            todo += more
        reach[start] = found
    groups = {tuple(sorted([f] + [to for to in reach[f] if to != f and f in reach.get(to, ())]))
              for f in uses if f in reach[f]}
    return sorted(list(g) for g in groups)


def symbols(nm, objects):
    """(object, kind, name) of each global symbol."""
    done = subprocess.run([nm, '-A', '-g', '-P', *objects], stdout=subprocess.PIPE, text=True, check=True)
    for line in done.stdout.splitlines():
        place, name, kind = line.split()[:3]
        yield place.rstrip(':'), kind, name


def read_uses(build):
    """{file: files that it uses} by the objects of the static libraries."""
    objects = {str(path): f'{path.parts[-3]}/{path.name[:-2]}' for path in sorted(build.glob('src/*/lib*.a.p/*.o'))}
    defined, wanted = {}, []
    for place, kind, name in symbols(shutil.which('gcc-nm') or 'nm', objects):
        if kind == 'U':
            wanted.append((objects[place], name))
        else:
            defined[name] = objects[place]
    uses = {file: set() for file in objects.values()}
    for file, name in wanted:
        if defined.get(name, file) != file:
            uses[file].add(defined[name])
    return uses


def main():
    proof = {'a': {'b'}, 'b': {'c', 'd'}, 'c': {'a'}, 'd': set(), 'e': {'a', 'f'}, 'f': {'e'}}
    if circles(proof) != [['a', 'b', 'c'], ['e', 'f']] or circles({'a': {'b'}, 'b': set()}):
        sys.exit('circles.py itself misses a circle, or sees one where there is none')
    uses = read_uses(pathlib.Path(sys.argv[1]))
    if sum(map(len, uses.values())) < 500:
        sys.exit(f'circles.py has found {len(uses)} files, which use nothing: are these object files?')
    found = circles(uses)
    for circle in found:
        print('a circle of calls:')
        for file in circle:
            print(f'  {file} uses', *sorted(uses[file] & set(circle)))
    print(f'{len(uses)} files, {len(found)} circles')
    sys.exit(1 if found else 0)


main()
