#!/usr/bin/env python3
"""Keeps the borders of the modules: permitted includes, duties reserved to some files, no circles of includes, and
maximum lengths of functions, files and folders. Prints the place of each violation; exit 1 if there is any.

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

# Arrows: a module's own headers and those of the modules named here, or the headers named, may be included. "motion" and "universe" as
# <ob/...> are public types, open to all.
ARROWS = {
    'base': '',
    'elementary': '',
    'ranks': 'base',
    'shape': '',
    'motion': 'shape elementary base',
    'terrain': 'shape elementary base',
    'hull': 'shape motion elementary base',
    'mesh': 'shape motion base',
    'settings': 'base',
    'table': 'terrain shape motion elementary settings base',
    'sensor': 'table terrain shape motion elementary settings base',
    'control': 'base',
    'contact': 'terrain shape motion elementary base',
    'ode': 'shape elementary base',
    'solver': 'contact ode shape motion elementary settings base table/counters.h table/pair_state.h',
    'schedule': 'table settings base',
    'cluster': 'schedule table elementary settings base',
    'exchange': 'cluster schedule solver table settings base',
    'baseline': 'terrain exchange ode table settings base',
    'step': 'sensor terrain baseline exchange cluster schedule solver contact shape motion elementary table settings base',
    'free': 'step solver contact shape motion table settings base exchange/results.h',
    'fmu': 'base',
    'scene': 'measure terrain fmu hull mesh settings shape motion elementary base',
    'script': 'terrain fmu scene table settings shape motion base',
    'host': 'terrain control free step script scene hull shape table settings ode base ranks exchange/results.h',
    'checkpoint': 'host scene table settings base',
    'measure': 'terrain shape motion base',
    'experiment': 'ranks base',
    'compare': 'experiment settings base',
    'world': 'terrain hull shape motion elementary base',
    'engine': 'host scene world step ode table settings measure shape motion base',
    'lab': 'scene engine world experiment settings measure shape motion base',
    'render': 'measure mesh scene shape motion base',
    'record': 'measure mesh scene table settings shape motion base',
    'paper': 'host measure render experiment scene table settings ranks base',
    'serve': 'record measure mesh host scene table settings shape motion base',
    'import': 'hull shape motion base',
    'cli': 'import control shape free/free.h free/schedule.h serve checkpoint host render record lab paper compare measure scene experiment table settings base ranks',
}
BUILT = {'scene': ['scene_texts.h'], 'render': ['shaders.h'], 'compare': ['compare_texts.h', 'sync_texts.h'], 'lab': ['report_texts.h', 'lab_scenes.h'], 'experiment': ['page_texts.h'],
         'paper': ['paper_texts.h'],
         'serve': ['content_table.h']}  # written by the build, so without a folder

# Duties reserved to some files: (duty, pattern, permitted files, True: search code without comments and strings).
DUTIES = [
    ('include <ode/...>', r'#\s*include\s*<ode/', r'src/ode/', True),
    ('include EGL or OpenGL', r'#\s*include\s*<(EGL|GL|GLES\w*)/', r'src/render/', True),
    ('include Lua', r'#\s*include\s*<(lua[\d.]*/)?(lua|lauxlib|lualib|luaconf)\.h', r'src/(scene|script)/', True),
    ('include qhull', r'#\s*include\s*<(libqhull|qhull)', r'src/hull/', True),
    ('include libwebsockets', r'#\s*include\s*<libwebsockets', r'src/serve/', True),
    ('include HDF5', r'#\s*include\s*<(hdf5\w*/)?(hdf5|H5)\w*\.h', r'src/record/', True),
    ('include cairo', r'#\s*include\s*<cairo', r'src/render/', True),
    ('include tinygltf', r'#\s*include\s*[<"]tiny_gltf', r'src/mesh/', True),
    ('include libjpeg', r'#\s*include\s*<jpeglib', r'src/mesh/', True),
    ('include libzip or expat', r'#\s*include\s*<(zip|expat)\.h', r'src/fmu/', True),
    ('include Bullet', r'#\s*include\s*[<"](bullet/|bt)', r'src/engine/', True),
    ('include MuJoCo', r'#\s*include\s*<mujoco', r'src/(engine|import)/', True),
    ('include MPI', r'#\s*include\s*<mpi', r'src/ranks/mpi\.c$', True),
    ('include liburcu', r'#\s*include\s*<urcu', r'src/host/', True),
    ('map shared memory', r'\b(shm_open|mmap)\s*\(', r'src/table/', True),
    ('name a memory order', r'\b(memory_order_\w+|__atomic_\w+|__sync_\w+)', r'src/table/', True),
    # Simulators are started by host/spawn_*.c (processes through its fork_server); the rest are helpers of one module
    # each; control/batch.c's steps several universes for a program.
    ('start a thread', r'\b(pthread_create|thrd_create)\s*\(',
     r'src/(host/(spawn_\w+|supervisor|timeline)|checkpoint/writer|render/sink\w*|cli/progress|control/batch|paper/viewer|ranks/mpi|serve/server)\.c$', True),
    ('start a process', r'\b(v?fork|posix_spawnp?)\s*\(',
     r'src/(host/(spawn_\w+|fork_server|foreign)|render/sink_video|experiment/process|ranks/courier|lab/attempt|paper/attempt|record/recording|import/import|base/part)\.c$', True),
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


def included(code):
    """(line, name) of each include with a name in quotes."""
    for number, line in enumerate(code, 1):
        match = re.match(r'\s*#\s*include\s*"([^"]*)"', line)
        if match:
            yield number, match.group(1)


def check_arrows(name, code):
    module = name.split('/')[1]
    if module not in ARROWS:
        yield 1, f'a module without arrows: add {module} to the table in tests/borders.py'
        return
    for number, file in included(code):
        if file in BUILT.get(module, []):
            continue
        target, slash, _ = file.partition('/')
        if not slash or target not in ARROWS:
            yield number, f'"{file}" is not named by its module ("module/file.h")'
        elif target != module and target not in ARROWS[module].split() and file not in ARROWS[module].split():
            yield number, f'{module} may not use {target} (may use: {ARROWS[module] or "nothing"})'


def check_duties(name, plain, code):
    for what, pattern, where, in_code in DUTIES:
        if re.match(where, name):
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
    headers, sources = {}, {}
    implemented = {name.rsplit('.', 1)[0]: name for name in codes if name.endswith(('.c', '.cpp'))}
    for name, code in codes.items():
        of_source = name in implemented.values()
        for number, to in included(code):
            target = 'src/' + to
            if not of_source and target in codes:
                headers.setdefault(name, {}).setdefault(target, number)
            source = implemented.get(target.rsplit('.', 1)[0])
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
    """All violations under root/src, as 'path:line: what'."""
    found, codes = [], {}
    for path in sorted(root.glob('src/**/*')):
        if path.suffix not in ('.c', '.cpp', '.h', '.in') or len(path.relative_to(root).parts) < 3:
            continue
        name = path.relative_to(root).as_posix()
        text = path.read_text(encoding='utf-8').removesuffix('\n')
        plain = without_comments(text)
        code = without_strings(plain).split('\n')
        codes[name] = code
        places = [*check_arrows(name, code), *check_duties(name, plain.split('\n'), code), *check_lengths(name, code)]
        found += [f'{name}:{number}: {what}' for number, what in sorted(places)]
    return found + list(check_circles(codes)) + list(check_folders(codes))


# One violation of each kind, and its line (None: at the first file of its circle); then code that must not be reported.
PLANTED = [
    ('src/motion/a.c', '\n#include "step/sim.h"\n', 2),
    ('src/measure/a.h', '#include "table/slot.h"\n', 1),
    ('src/step/a.c', '#include "sim.h"\n', 1),
    ('src/misc/a.c', '\n', 1),
    ('src/step/b.c', '#include <ode/ode.h>\n', 1),
    ('src/cli/b.c', '#include <EGL/egl.h>\n', 1),
    ('src/cli/g.c', '#include <GLES3/gl3.h>\n', 1),
    ('src/cli/c.c', '#  include <lua.h>\n', 1),
    ('src/cli/d.c', '#include <hdf5.h>\n', 1),
    ('src/step/e.c', '#include <urcu/urcu-memb.h>\n', 1),
    ('src/scene/h.c', '#include <libqhull_r/libqhull_r.h>\n', 1),
    ('src/host/a.c', 'int f(void)\n{\n\treturn shm_open("x", 0, 0);\n}\n', 3),
    ('src/host/b.c', '/*\n*/ void *p = mmap (0, 1, 2, 3, 4, 5);\n', 2),
    ('src/step/f.c', 'int i = memory_order_acquire;\n', 1),
    ('src/step/g.c', 'int i = __atomic_load_n(p, 0);\n', 1),
    ('src/host/c.c', 'int i = pthread_create(0, 0, 0, 0);\n', 1),
    ('src/render/spawn_a.c', 'int i = pthread_create(0, 0, 0, 0);\n', 1),
    ('src/render/sink_a.c', 'int i = fork();\n', 1),
    ('src/lab/lab.c', 'int i = fork();\n', 1),
    ('src/render/a.c', 'const char *s = "#version 330\\n";\n', 1),
    ('src/base/a.c', 'void f(void)\n{\n' + '\tg();\n' * (FUNCTION_LINES - 1) + '}\n', 2),
    ('src/motion/c.c', '#include "motion/c.h"\n#include "motion/d.h"\n', 2),
    ('src/motion/d.c', '#include "base/log.h"\n#include "motion/e.h"\n', None),
    ('src/motion/e.c', '#include "motion/c.h"\n', None),
    ('src/motion/f.h', '#include "motion/f.h"\n', 1),
    ('src/motion/g.h', '\n\n#include "motion/h.h"\n', 3),
    ('src/motion/h.h', '#include "motion/g.h"\n', None),
    ('src/base/b.c', '\n' * (FILE_LINES + 1), FILE_LINES + 1),
    *((f'src/terrain/{i}.c', 'int i; // a line\n' * FILE_LINES, None) for i in range(FOLDER_LINES // FILE_LINES)),
    ('src/terrain/more.c', 'int i;\n', None),
]
ALLOWED = [
    ('src/motion/p.h', '#include <stdint.h>\n'),
    ('src/motion/p.c', '#include "motion/p.h"\n#include "motion/p_state.h"\n#include "motion/q.h"\n'),
    ('src/motion/p_state.h', '#include "motion/p.h"\n#include "motion/q.h"\n'),
    ('src/motion/q.h', '\n'),
    ('src/motion/q.c', '#include "motion/p_state.h"\n#include "motion/q.h"\n'),
    ('src/step/y.c', '#include "table/table.h"\n#include "step/sim.h"\n#include <ob/universe.h>\n'),
    ('src/ode/y.c', '#include <ode/ode.h>\n#include "ode/ode_body.h"\n'),
    ('src/table/y.c', 'int i = memory_order_acquire; void *p = mmap(0, 0, 0, 0, 0, 0);\n'),
    ('src/host/spawn_thread.c', 'int i = pthread_create(0, 0, 0, 0);\n'),
    ('src/render/sink.c', '#include "shaders.h"\nint i = pthread_create(0, 0, 0, 0);\n'),
    ('src/lab/attempt.c', 'int i = fork();\n'),
    ('src/cli/y.c', '// fork() and mmap() and "\nconst char *s = "fork()"; int ob_fork_server_fork(int);\n/* #version\n*/\n'),
    ('src/base/y.c', 'void f(void)\n{\n' + '\tg();\n' * (FUNCTION_LINES - 2) + '}\n'),
    ('src/base/z.c', '\n' * FILE_LINES),
    *((f'src/lab/{i}.c', 'int i;\n' * (FILE_LINES // 2) + '// a comment\n' * (FILE_LINES // 2)) for i in range(12)),
]


def prove():
    """Violations that this script misses, and permitted lines that it reports."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text, *_ in PLANTED + ALLOWED:
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding='utf-8')
        seen = [':'.join(line.split(':')[:2]) for line in check(root)]
    expected = [f'{name}:{number}' for name, _, number in PLANTED if number] + ['src/terrain:1']
    return sorted(set(seen) ^ set(expected)) + sorted({place for place in seen if seen.count(place) > 1})


def main():
    if len(sys.argv) != 2 or not (pathlib.Path(sys.argv[1]) / 'src').is_dir():
        sys.exit('usage: borders.py ROOT, the folder that holds src/')
    wrong = prove()
    for place in wrong:
        print(f'borders.py itself judges {place} wrongly')
    found = check(pathlib.Path(sys.argv[1]))
    print(*found, f'{len(found)} violations', sep='\n')
    sys.exit(1 if wrong or found else 0)


main()
