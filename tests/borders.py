#!/usr/bin/env python3
"""Keeps the borders of rooms and modules: permitted includes, duties reserved to some files, no circles of includes, and
maximum lengths of functions, files and folders. Prints the place of each violation, and how large src is; exit 1 if there
is any.

borders.py ROOT    checks ROOT/src
First it plants one violation of each kind in a tree of its own, and fails if it does not see it.
"""
import pathlib
import re
import sys
import tempfile

# A longer file or function holds more than one concept or sequence.
FILE_LINES = 1000
FUNCTION_LINES = 80
# A folder with more lines of code, without blank lines and comments, is more than one module.
FOLDER_LINES = 9000

# Arrows: a module's own headers and those of the modules named here, or the headers named, may be included. "motion" and
# "universe" as <ob/...> are public types, open to all. Rooms and modules stand in the order of the arrows: each may use
# those above it alone.
ROOMS = {
    'universe': {
        'base': '',
        'elementary': '',
        'shape': '',
        'motion': 'shape elementary',
        'terrain': 'base',
        'hull': 'shape elementary',
        'settings': 'base',
        'table': 'terrain shape motion elementary settings base',
    },
    'physics': {
        'sensor': 'table shape motion elementary base',
        'contact': 'terrain shape motion elementary base',
        'ode': 'elementary base',
        'solver': 'contact ode shape motion elementary settings base table/counters.h table/pair_state.h',
        'schedule': 'table',
        'cluster': 'schedule table elementary',
        'exchange': 'cluster schedule solver table',
        'baseline': 'exchange ode table base',
        'step': 'sensor baseline exchange cluster schedule solver contact shape motion table base',
        'free': 'step schedule solver shape motion table base exchange/results.h',
    },
    'run': {
        'ranks': 'base',
        'control': 'base',
        'mesh': 'base',
        'fmu': 'base',
        'measure': 'terrain shape motion base',
        'scene': 'measure terrain fmu hull mesh settings shape motion elementary base',
        'render': 'measure mesh scene shape base',
        'script': 'fmu scene table shape motion base',
        'host': 'control free step script render scene hull shape table settings ode base ranks exchange/results.h',
        'checkpoint': 'host settings base',
        'record': 'measure scene table shape base',
    },
    'experiments': {
        'experiment': 'ranks base',
        'compare': 'experiment settings base',
        'engine': 'host step ode table settings terrain hull shape motion base',
        'lab': 'scene engine experiment settings measure shape base',
        'paper': 'host render experiment ranks base',
    },
    'front': {
        'serve': 'record measure mesh host scene table shape motion base',
        'import': 'hull shape motion base',
        'cli': 'import control shape free/free.h free/schedule.h serve checkpoint host render record lab paper compare measure scene experiment table settings base ranks',
    },
}
ARROWS = {module: uses.split() for room in ROOMS.values() for module, uses in room.items()}
BUILT = {'scene': ['scene_texts.h'], 'render': ['shaders.h'], 'compare': ['compare_texts.h', 'sync_texts.h'], 'lab': ['report_texts.h', 'lab_scenes.h'], 'experiment': ['page_texts.h'],
         'paper': ['paper_texts.h'],
         'serve': ['content_table.h']}  # written by the build, so without a folder

# Duties reserved to some files, named as in an include: (duty, pattern, files, True: search code without comments and strings).
DUTIES = [
    ('include <ode/...>', r'#\s*include\s*<ode/', r'ode/', True),
    ('include EGL or OpenGL', r'#\s*include\s*<(EGL|GL|GLES\w*)/', r'render/', True),
    ('include Lua', r'#\s*include\s*<(lua[\d.]*/)?(lua|lauxlib|lualib|luaconf)\.h', r'(scene|script)/', True),
    ('include qhull', r'#\s*include\s*<(libqhull|qhull)', r'hull/', True),
    ('include libwebsockets', r'#\s*include\s*<libwebsockets', r'serve/', True),
    ('include HDF5', r'#\s*include\s*<(hdf5\w*/)?(hdf5|H5)\w*\.h', r'record/', True),
    ('include cairo', r'#\s*include\s*<cairo', r'render/', True),
    ('include tinygltf', r'#\s*include\s*[<"]tiny_gltf', r'mesh/', True),
    ('include libjpeg', r'#\s*include\s*<jpeglib', r'mesh/', True),
    ('include libzip or expat', r'#\s*include\s*<(zip|expat)\.h', r'fmu/', True),
    ('include Bullet', r'#\s*include\s*[<"](bullet/|bt)', r'engine/', True),
    ('include MuJoCo', r'#\s*include\s*<mujoco', r'(engine|import)/', True),
    ('include MPI', r'#\s*include\s*<mpi', r'ranks/mpi\.c$', True),
    ('include liburcu', r'#\s*include\s*<urcu', r'host/', True),
    ('map shared memory', r'\b(shm_open|mmap)\s*\(', r'table/', True),
    ('name a memory order', r'\b(memory_order_\w+|__atomic_\w+|__sync_\w+)', r'table/', True),
    # Simulators are started by host/spawn_*.c (processes through its fork_server); the rest are helpers of one module
    # each; control/batch.c's steps several universes for a program.
    ('start a thread', r'\b(pthread_create|thrd_create)\s*\(',
     r'(host/(spawn_\w+|supervisor|timeline)|checkpoint/writer|render/sink\w*|cli/run|control/batch|paper/paper|ranks/mpi|serve/server)\.c$', True),
    ('start a process', r'\b(v?fork|posix_spawnp?)\s*\(',
     r'(host/(spawn_\w+|fork_server|foreign)|render/sink_video|experiment/process|ranks/courier|lab/attempt|paper/attempt|record/recording|import/import|base/part)\.c$', True),
    ('hold a shader in a string', r'#\s*version\b', r'$^', False),
]


def blank(match):
    return re.sub(r'[^\n]', ' ', match.group())


def without_comments(text):
    return re.sub(r'("(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\')|//[^\n]*|/\*.*?\*/',
                  lambda m: m.group() if m.group(1) else blank(m), text, flags=re.S)


def without_strings(text):
    """Blanks strings; names in includes stay."""
    return '\n'.join(line if re.match(r'\s*#\s*include', line) else
                     re.sub(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'', blank, line) for line in text.split('\n'))


def in_include(name):
    """A file of src as an include names it, without its room."""
    return name.split('/', 2)[-1]


def included(code):
    """(line, name) of each include with a name in quotes."""
    for number, line in enumerate(code, 1):
        match = re.match(r'\s*#\s*include\s*"([^"]*)"', line)
        if match:
            yield number, match.group(1)


def check_order(rooms):
    """Arrows of the table that lead to a module below the one that has them."""
    above = set()
    for room in rooms.values():
        for module, uses in room.items():
            yield from (f'{module} uses {use}, which is not above it' for use in uses.split() if use.split('/')[0] not in above)
            above.add(module)


def check_used(codes, arrows):
    """Arrows of the table that no include needs."""
    used = {module: set() for module in arrows}
    for name, code in codes.items():
        for _, to in included(code):
            used.setdefault(in_include(name).split('/')[0], set()).update((to, to.split('/')[0]))
    return [f'{module} does not use {use}' for module, uses in arrows.items() for use in uses if use not in used[module]]


def check_arrows(name, code):
    _, room, module = [*name.split('/'), ''][:3]
    if module not in ROOMS.get(room, {}):
        yield 1, f'src/{room} has no module {module}: see the table in tests/borders.py'
        return
    for number, file in included(code):
        if file in BUILT.get(module, []):
            continue
        target, slash, _ = file.partition('/')
        if not slash or target not in ARROWS:
            yield number, f'"{file}" is not named by its module ("module/file.h")'
        elif target != module and target not in ARROWS[module] and file not in ARROWS[module]:
            yield number, f'{module} may not use {target} (may use: {" ".join(ARROWS[module]) or "nothing"})'


def check_duties(name, plain, code):
    for what, pattern, where, in_code in DUTIES:
        if re.match(where, in_include(name)):
            continue
        for number, line in enumerate(code if in_code else plain, 1):
            if re.search(pattern, line):
                yield number, f'may not {what}'


def circles(files, edges):
    """Groups of files that lead to each other: lists in the order of names. edges: {file: {target: line}}."""
    reach = {}
    for start in files:
        found, todo = set(), [start]
        while todo:
            more = [to for to in edges.get(todo.pop(), ()) if to not in found]
            found.update(more)
            todo += more
        reach[start] = found
    groups = {tuple(sorted([f] + [to for to in reach[f] if to != f and f in reach[to]]))
              for f in files if f in reach[f]}
    return sorted(groups)


def check_circles(codes):
    """Headers that include each other in a circle, and sources that use each other's headers in one. codes: {name: lines
    of code}. A private header may include the public one of its module, and the sources of both use either."""
    headers, sources, files = {}, {}, {in_include(name): name for name in codes}
    implemented = {file.rsplit('.', 1)[0]: name for file, name in files.items() if file.endswith(('.c', '.cpp'))}
    for name, code in codes.items():
        of_source = name in implemented.values()
        for number, to in included(code):
            if not of_source and to in files:
                headers.setdefault(name, {}).setdefault(files[to], number)
            source = implemented.get(to.rsplit('.', 1)[0])
            if of_source and source and source != name:
                sources.setdefault(name, {}).setdefault(source, number)
    for edges in headers, sources:
        for group in circles(sorted(codes), edges):
            line = min(number for to, number in edges[group[0]].items() if to in group)
            yield f'{group[0]}:{line}: in a circle of includes: {", ".join(group)}'


def check_lengths(name, code):
    if len(code) > FILE_LINES:
        yield len(code), f'{len(code)} lines in a file, {FILE_LINES} at most'
    start = None
    for number, line in enumerate(code, 1):
        if line.startswith('{'):
            start = number
        elif line.startswith('}') and start:
            if number - start + 1 > FUNCTION_LINES:
                yield start, f'{number - start + 1} lines in a function, {FUNCTION_LINES} at most'
            start = None


def check_folders(codes):
    lines = {}
    for name, code in codes.items():
        folder = name.rsplit('/', 1)[0]
        lines[folder] = lines.get(folder, 0) + sum(1 for line in code if line.strip())
    for folder, number in sorted(lines.items()):
        if number > FOLDER_LINES:
            yield f'{folder}:1: {number} lines of code in a folder, {FOLDER_LINES} at most'


def check(root):
    """All violations under root/src, as 'path:line: what', and its files: {name: lines of code}."""
    found, codes = [], {}
    for path in sorted(root.glob('src/**/*')):
        if path.suffix not in ('.c', '.cpp', '.h', '.in'):
            continue
        name = path.relative_to(root).as_posix()
        text = path.read_text(encoding='utf-8').removesuffix('\n')
        plain = without_comments(text)
        code = without_strings(plain).split('\n')
        codes[name] = code
        places = [*check_arrows(name, code), *check_duties(name, plain.split('\n'), code), *check_lengths(name, code)]
        found += [f'{name}:{number}: {what}' for number, what in sorted(places)]
    return found + list(check_circles(codes)) + list(check_folders(codes)), codes


# One violation of each kind, and its line (None: at the first file of its circle); then code that must not be reported. Files
# of modules are named as in an include.
PLANTED = [
    ('motion/a.c', '\n#include "step/sim.h"\n', 2),
    ('measure/a.h', '#include "table/slot.h"\n', 1),
    ('step/a.c', '#include "sim.h"\n', 1),
    ('src/run/misc/a.c', '\n', 1),
    ('src/run/motion/a.c', '\n', 1),
    ('src/a.c', '\n', 1),
    ('step/b.c', '#include <ode/ode.h>\n', 1),
    ('cli/b.c', '#include <EGL/egl.h>\n', 1),
    ('cli/g.c', '#include <GLES3/gl3.h>\n', 1),
    ('cli/c.c', '#  include <lua.h>\n', 1),
    ('cli/d.c', '#include <hdf5.h>\n', 1),
    ('step/e.c', '#include <urcu/urcu-memb.h>\n', 1),
    ('scene/h.c', '#include <libqhull_r/libqhull_r.h>\n', 1),
    ('host/a.c', 'int f(void)\n{\n\treturn shm_open("x", 0, 0);\n}\n', 3),
    ('host/b.c', '/*\n*/ void *p = mmap (0, 1, 2, 3, 4, 5);\n', 2),
    ('step/f.c', 'int i = memory_order_acquire;\n', 1),
    ('step/g.c', 'int i = __atomic_load_n(p, 0);\n', 1),
    ('host/c.c', 'int i = pthread_create(0, 0, 0, 0);\n', 1),
    ('render/spawn_a.c', 'int i = pthread_create(0, 0, 0, 0);\n', 1),
    ('render/sink_a.c', 'int i = fork();\n', 1),
    ('lab/lab.c', 'int i = fork();\n', 1),
    ('render/a.c', 'const char *s = "#version 330\\n";\n', 1),
    ('base/a.c', 'void f(void)\n{\n' + '\tg();\n' * (FUNCTION_LINES - 1) + '}\n', 2),
    ('motion/c.c', '#include "motion/c.h"\n#include "motion/d.h"\n', 2),
    ('motion/d.c', '#include "shape/shape.h"\n#include "motion/e.h"\n', None),
    ('motion/e.c', '#include "motion/c.h"\n', None),
    ('motion/f.h', '#include "motion/f.h"\n', 1),
    ('motion/g.h', '\n\n#include "motion/h.h"\n', 3),
    ('motion/h.h', '#include "motion/g.h"\n', None),
    ('base/b.c', '\n' * (FILE_LINES + 1), FILE_LINES + 1),
    *((f'terrain/{i}.c', 'int i; // a line\n' * FILE_LINES, None) for i in range(FOLDER_LINES // FILE_LINES)),
    ('terrain/more.c', 'int i;\n', None),
]
ALLOWED = [
    ('motion/p.h', '#include <stdint.h>\n'),
    ('motion/p.c', '#include "motion/p.h"\n#include "motion/p_state.h"\n#include "motion/q.h"\n'),
    ('motion/p_state.h', '#include "motion/p.h"\n#include "motion/q.h"\n'),
    ('motion/q.h', '\n'),
    ('motion/q.c', '#include "motion/p_state.h"\n#include "motion/q.h"\n'),
    ('step/y.c', '#include "table/table.h"\n#include "step/sim.h"\n#include <ob/universe.h>\n'),
    ('ode/y.c', '#include <ode/ode.h>\n#include "ode/ode_body.h"\n'),
    ('table/y.c', 'int i = memory_order_acquire; void *p = mmap(0, 0, 0, 0, 0, 0);\n'),
    ('host/spawn_thread.c', 'int i = pthread_create(0, 0, 0, 0);\n'),
    ('render/sink.c', '#include "shaders.h"\nint i = pthread_create(0, 0, 0, 0);\n'),
    ('lab/attempt.c', 'int i = fork();\n'),
    ('cli/y.c', '// fork() and mmap() and "\nconst char *s = "fork()"; int ob_fork_server_fork(int);\n/* #version\n*/\n'),
    ('base/y.c', 'void f(void)\n{\n' + '\tg();\n' * (FUNCTION_LINES - 2) + '}\n'),
    ('base/z.c', '\n' * FILE_LINES),
    *((f'lab/{i}.c', 'int i;\n' * (FILE_LINES // 2) + '// a comment\n' * (FILE_LINES // 2)) for i in range(12)),
]


def in_src(name):
    """The path of a planted file."""
    room = next((room for room, modules in ROOMS.items() if name.split('/')[0] in modules), None)
    return f'src/{room}/{name}' if room else name


def prove():
    """Violations that this script misses, and permitted things that it reports."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text, *_ in PLANTED + ALLOWED:
            path = root / in_src(name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding='utf-8')
        seen = [':'.join(line.split(':')[:2]) for line in check(root)[0]]
    expected = [f'{in_src(name)}:{number}' for name, _, number in PLANTED if number] + [in_src('terrain') + ':1']
    wrong = sorted(set(seen) ^ set(expected)) + sorted({place for place in seen if seen.count(place) > 1})
    order = list(check_order({'low': {'a': '', 'b': 'a c/one.h'}, 'high': {'c': 'a b'}}))
    used = check_used({'src/low/a/x.c': ['#include "b/y.h"', '#include "c/z.h"']}, {'a': ['b', 'c/w.h', 'd'], 'b': []})
    return wrong + [what for what, right in (
        ('order', order == ['b uses c/one.h, which is not above it']),
        ('use', used == ['a does not use c/w.h', 'a does not use d'])) if not right]


def print_sizes(codes):
    """Files and lines of src, a line for each room."""
    for room in '', *ROOMS:
        lines = [len(code) for name, code in codes.items() if name.startswith(f'src/{room}')]
        print(f'src/{room:<12} {len(lines):4} files {sum(lines):7,} lines')


def main():
    if len(sys.argv) != 2 or not (pathlib.Path(sys.argv[1]) / 'src').is_dir():
        sys.exit('usage: borders.py ROOT, the folder that holds src/')
    wrong = prove()
    for what in wrong:
        print(f'borders.py itself judges {what} wrongly')
    found, codes = check(pathlib.Path(sys.argv[1]))
    found += [f'tests/borders.py:1: {what}' for what in [*check_order(ROOMS), *check_used(codes, ARROWS)]]
    print_sizes(codes)
    print(*found, f'{len(found)} violations', sep='\n')
    sys.exit(1 if wrong or found else 0)


if __name__ == '__main__':
    main()
