#!/usr/bin/env python3
"""figures.py OBSIM [FILE ...]: measures the tables that stand in FILEs between <!-- figures: NAME --> and <!-- end -->, and
writes them there anew; without a FILE prints all tables. On an otherwise idle machine; times are medians of three runs.
"""
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile

BENCH = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(BENCH, '..', 'scenes')
RUNS = 3
SEEDS = 12  # of the error tables: one heap is an anecdote


def scene(name):
    return os.path.join(SCENES, name + '.lua')


def run(*words, runs=RUNS):
    """The report of a run; its times are medians."""
    reports = []
    for _ in range(runs):
        done = subprocess.run([OBSIM, 'run', *words, '--json', '-'], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f'obsim run {" ".join(words)}: {done.stderr}')
        reports.append(json.loads(done.stdout))
    for key in ('cpu_s', 'wall_s', 'total_s', 'body_step_cpu_us', 'startup_s', 'memory_bytes'):
        reports[0][key] = statistics.median(r[key] for r in reports)
    return reports[0]


def row(*cells):
    return '| ' + ' | '.join(str(c) for c in cells) + ' |\n'


def head(*cells):
    return row(*cells) + row(*['---'] + ['--:'] * (len(cells) - 1))


def machine():
    """Where this was measured."""
    with open('/proc/cpuinfo', encoding='utf-8') as f:
        model = re.search(r'model name\s*: (.*)', f.read()).group(1)
    r = run(scene('cradle'), '--duration', '.1')
    return f"Measured on {len(os.sched_getaffinity(0))} cores ({model}), commit {r['commit']}.\n"


def compared(*words):
    """What obsim compare says of the falling boxes: the verdict, then the table, in at most 100 columns."""
    done = subprocess.run([OBSIM, 'compare', 'scenes/falling_boxes.lua', *words], capture_output=True, text=True, check=True,
                          cwd=os.path.join(SCENES, '..'))
    return '```\n' + done.stdout + '```\n'


def compare():
    """The whole of it."""
    return compared()


def varied():
    """While they fly, land and pile up; a hundred, and a thousand."""
    return compared('--vary', 'n=100,1000', '--duration', '3')


def summary():
    """The verdict of the README: one world, threads and processes in the same scene, five rows."""
    configurations = [('one ODE world', ['--arch', 'monolith']), ('threads', ['--isolation', 'thread']),
                      ('processes', ['--isolation', 'process']),
                      ('a process for each object', ['--isolation', 'process', '--workers', 'objects'])]
    reports = [run(scene('falling_boxes'), *words, '--measure', 'end') for _, words in configurations]
    errors = [run(scene('falling_boxes'), *words, runs=1) for _, words in configurations]
    text = head('100 falling boxes, 10 s', *(title for title, _ in configurations))
    text += row('CPU per body and step, µs', *(f"{r['body_step_cpu_us']:.2f}" for r in reports))
    text += row('wall per simulated second, ms', *(f"{1e3 * r['wall_s'] / r['simulated_s']:.1f}" for r in reports))
    text += row('deepest penetration, mm', *(f"{1e3 * r['worst_penetration_m']:.3g}" for r in errors))
    text += row('memory, MB', *(f"{r['memory_bytes'] / 1e6:.0f}" for r in reports))
    text += row('state after it', *(f"`{r['state_hash'][:8]}`" for r in reports))
    return text


def spread(values, digits):
    """Median, and the least and the most of all seeds."""
    return f'{statistics.median(values):.{digits}g} ({min(values):.{digits}g}–{max(values):.{digits}g})'


def error_of(name, title):
    text = head(title, 'CPU, ms per simulated s', 'deepest penetration, mm', 'mean at the end, mm')
    configurations = [('object simulators, 1 substep', ['--substeps', '1'])]
    configurations += [(f'object simulators, {n} substeps', ['--substeps', str(n)]) for n in (2, 4, 8, 16, 32)]
    configurations += [('object simulators, as they come (1 mm)', [])]
    configurations += [(f'object simulators, tolerance {t}', ['--tolerance', t]) for t in ('10mm', '.1mm')]
    configurations += [(f'one ODE world, steps of 1/{n} s', ['--arch', 'monolith', '--step', f'1/{n}'])
                       for n in (60, 240, 960)]
    for what, words in configurations:
        seeds = [['--seed', str(seed)] for seed in range(1, SEEDS + 1)]
        reports = [run(scene(name), *words, *seed, runs=1) for seed in seeds]
        undisturbed = [run(scene(name), *words, *seed, '--measure', 'end', runs=1) for seed in seeds]
        cpu = statistics.median(1e3 * r['cpu_s'] / r['simulated_s'] for r in undisturbed)
        text += row(what, f'{cpu:.1f}', spread([1e3 * r['worst_penetration_m'] for r in reports], 3),
                    spread([1e3 * r['penetration_mean_m'] for r in reports], 2))
    return text


def error_falling():
    """Speed against error: more substeps here, shorter steps there."""
    return error_of('falling_boxes', f'100 falling boxes, 10 s, {SEEDS} seeds')


def error_stack():
    """The same of a stack that stands, all awake; a seed is another set of offsets."""
    return error_of('stack', f'stack of 10, 20 s, {SEEDS} seeds')


def bits():
    """The same bits, whoever computes them."""
    configurations = [[isolation, workers] for isolation in ('thread', 'process') for workers in ('1', '2', '3', '8', 'objects')]
    text = head('scene', 'duration, s', 'configurations', 'state after it', 'equal')
    for name in ('falling_boxes', 'stack', 'pile', 'cradle', 'sparse'):
        reports = [run(scene(name), '--isolation', isolation, '--workers', workers, '--measure', 'end', runs=1)
                   for isolation, workers in configurations]
        hashes = sorted({r['state_hash'] for r in reports})
        text += row(name, f"{reports[0]['simulated_s']:g}", len(configurations), ' '.join(hashes), 'no' if hashes[1:] else 'yes')
    return text


def counts():
    """How many simulators a machine bears."""
    text = head('1 s of falling boxes', 'start-up, s', 'wall per step, ms', 'CPU per body and step, µs', 'memory, MB')
    for what, words in (('1000 simulators, a pool of 2', ['-D', 'n=1000']),
                        ('1000, one per process', ['-D', 'n=1000', '--isolation', 'process', '--workers', 'objects']),
                        ('1000, one per thread', ['-D', 'n=1000', '--workers', 'objects']),
                        ('4000, one per thread', ['-D', 'n=4000', '--workers', 'objects']),
                        ('10000, a pool of 2', ['-D', 'n=10000'])):
        r = run(scene('falling_boxes'), '--duration', '1', '--measure', 'end', *words)
        text += row(what, f"{r['startup_s']:.2f}", f"{1e3 * r['wall_s'] / r['steps']:.1f}",
                    f"{r['body_step_cpu_us']:.2f}", f"{r['memory_bytes'] / 1e6:.0f}")
    return text


def shapes():
    """What a pile costs, by the shape of its bodies: each seed is another pile."""
    text = head(f'200 bodies, 3 s, {SEEDS} seeds', 'CPU per body and step, µs', 'over boxes', 'deepest penetration, mm')
    boxes = 0
    for what, words in (('boxes', ()), *((f'hulls of {n} points', ('-D', f'points={n}')) for n in (8, 12, 20)),
                        ('boxes of .5 m, upright: columns, not a heap', ('-D', 'upright=true'))):
        reports = [run(os.path.join(BENCH, 'shapes.lua'), *words, '--workers', '1', '--seed', str(seed), runs=1)
                   for seed in range(1, SEEDS + 1)]
        cost = [r['body_step_cpu_us'] for r in reports]
        boxes = boxes or statistics.median(cost)
        text += row(what, spread(cost, 3), f'{statistics.median(cost) / boxes:.2f}',
                    spread([1e3 * r['worst_penetration_m'] for r in reports], 3))
    return text


def capture():
    """Frames to PNG, four samples a pixel, drawn by whatever EGL finds."""
    text = head('60 frames of 100 falling boxes to PNG', 'frames per second')
    for size in ('640x480', '1280x720', '1920x1080'):
        with tempfile.TemporaryDirectory() as folder:
            r = run(scene('falling_boxes'), '--duration', '1', '--frames', folder, '--size', size, '--measure', 'end')
        text += row(size, f"{r['frames'] / r['total_s']:.1f}")
    return text


TABLES = {f.__name__: f for f in (machine, summary, compare, varied, error_falling, error_stack, bits, counts, shapes, capture)}


def refresh(path):
    with open(path, encoding='utf-8') as f:
        text = f.read()
    text = re.sub(r'(<!-- figures: (\w+) -->\n).*?(<!-- end -->)',
                  lambda m: m.group(1) + '\n' + TABLES[m.group(2)]() + '\n' + m.group(3), text, flags=re.S)
    with open(path, 'w', encoding='utf-8') as f:
        f.write(text)


if len(sys.argv) < 2:
    sys.exit(__doc__)
OBSIM = os.path.abspath(sys.argv[1])
for file in sys.argv[2:]:
    refresh(file)
if len(sys.argv) == 2:
    for table in TABLES.values():
        print(table())
