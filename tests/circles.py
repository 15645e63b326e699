#!/usr/bin/env python3
"""Finds circles of calls: files, modules or rooms of src/ that reach each other by the functions and data that they use.
borders.py keeps the includes free of them. Prints each circle; exit 1 if there is any.

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
    """{file: files that it uses} by the objects of the static libraries. Functions of the C library that a file takes over
    for other libraries (scene/sandbox.c) lead nowhere."""
    objects = {str(path): '/'.join((*path.parts[-4:-2], path.name[:-2])) for path in sorted(build.glob('src/*/*/lib*.a.p/*.o'))}
    defined, wanted = {}, []
    for place, kind, name in symbols(shutil.which('gcc-nm') or 'nm', objects):
        if not name.startswith('ob_'):
            continue
        if kind == 'U':
            wanted.append((objects[place], name))
        else:
            defined[name] = objects[place]
    uses = {file: set() for file in objects.values()}
    for file, name in wanted:
        if defined.get(name, file) != file:
            uses[file].add(defined[name])
    return uses


def of_folders(uses, depth):
    """The same for folders: 1 rooms, 2 modules."""
    joined = {}
    for file, used in uses.items():
        folder = '/'.join(file.split('/')[:depth])
        joined.setdefault(folder, set()).update('/'.join(to.split('/')[:depth]) for to in used)
        joined[folder].discard(folder)
    return joined


def main():
    proof = {'a': {'b'}, 'b': {'c', 'd'}, 'c': {'a'}, 'd': set(), 'e': {'a', 'f'}, 'f': {'e'}}
    if circles(proof) != [['a', 'b', 'c'], ['e', 'f']] or circles({'a': {'b'}, 'b': set()}):
        sys.exit('circles.py itself misses a circle, or sees one where there is none')
    nested = {'r/m/a': {'r/n/b'}, 'r/n/b': {'s/o/c'}, 's/o/c': {'r/m/d'}, 'r/m/d': set()}
    if [circles(of_folders(nested, depth)) for depth in (1, 2, 3)] != [[['r', 's']], [['r/m', 'r/n', 's/o']], []]:
        sys.exit('circles.py itself misses a circle of folders, or sees one where there is none')
    uses = read_uses(pathlib.Path(sys.argv[1]))
    if sum(map(len, uses.values())) < 500:
        sys.exit(f'circles.py has found {len(uses)} files, which use nothing: are these object files?')
    found = 0
    for level in uses, of_folders(uses, 2), of_folders(uses, 1):
        for circle in circles(level):
            found += 1
            print('a circle of calls:')
            for one in circle:
                print(f'  {one} uses', *sorted(level[one] & set(circle)))
    print(f'{len(uses)} files, {found} circles')
    sys.exit(1 if found else 0)


main()
