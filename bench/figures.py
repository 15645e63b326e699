#!/usr/bin/env python3
"""Measures obsim's published figures once, and writes them into the documents: figures.py measure OBSIM | write | check

measure   runs all experiments on an otherwise idle machine (a quarter of an hour) and stores the results, with commit and machine, in
          docs/notebook/data/figures.json
write     renders tables, sentences and diagrams from that file into the documents, between <!-- figures: NAME --> and
          <!-- end -->, and into docs/images (by the script of report pages, in chromium)
check     lists differences between documents or diagrams and the file, blocks that a document lacks, and figures of README.md
          outside of its block; exit 1 if there are any
"""
import json
import math
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENES, BENCH = ROOT / 'scenes', ROOT / 'bench'
DATA = ROOT / 'docs/notebook/data/figures.json'
DOCUMENTS = [ROOT / 'README.md', ROOT / 'docs/experiments.md', ROOT / 'docs/notebook/figures.md']
RUNS = 3
SEEDS = 12  # for the error tables: a single heap is an anecdote
OBSIM = None  # the measured program


def scene(name):
    return str(SCENES / (name + '.lua'))


def run(*words, runs=RUNS):
    """Report of a run; its times are medians, and 'cpu_spread' is the minimum and maximum of CPU."""
    reports = []
    for _ in range(runs):
        done = subprocess.run([OBSIM, 'run', *words, '--json', '-'], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f'obsim run {" ".join(words)}: {done.stderr}')
        reports.append(json.loads(done.stdout))
    cpu = [r['cpu_s'] for r in reports]
    for key in ('cpu_s', 'wall_s', 'total_s', 'body_step_cpu_us', 'startup_s', 'memory_bytes'):
        reports[0][key] = statistics.median(r[key] for r in reports)
    reports[0]['cpu_spread'] = [min(cpu), max(cpu)]
    return reports[0]


def spread(values, digits):
    """Median, minimum and maximum over all seeds."""
    return f'{statistics.median(values):.{digits}g} ({min(values):.{digits}g}–{max(values):.{digits}g})'


# -- Experiments: each returns plain data, a table as {'head': [..], 'rows': [[..], ..]} or numbers for a diagram.

def machine():
    with open('/proc/cpuinfo', encoding='utf-8') as f:
        model = re.search(r'model name\s*: (.*)', f.read()).group(1)
    r = run(scene('cradle'), '--duration', '.1')
    return {'cores': len(os.sched_getaffinity(0)), 'model': model, 'commit': r['commit'], 'runs': RUNS, 'seeds': SEEDS}


CONFIGURATIONS = {
    'one ODE world': ['--arch', 'monolith'],
    'threads': ['--isolation', 'thread'],
    'processes': ['--isolation', 'process'],
    'a process per object': ['--isolation', 'process', '--workers', 'objects'],
}
LANDING = ['--duration', '3']  # boxes fly, land and pile up; later they rest, and resting costs object simulators nothing


def growth():
    """CPU, wall and the deepest penetration over the number of objects."""
    counts = (10, 30, 100, 300, 1000, 3000, 10000)
    curves = {}
    for name, words in CONFIGURATIONS.items():
        curves[name] = []
        for n in counts:
            if n > 1000 and name == 'a process per object':
                continue
            words_of_n = [scene('falling_boxes'), '-D', f'n={n}', *LANDING, *words]
            r = run(*words_of_n, '--set', 'measure=end')
            scale = 1e6 / (n * r['simulated_s'])
            depth = 1e3 * run(*words_of_n, runs=1)['worst_penetration_m']  # to measure it takes time
            curves[name].append({'n': n, 'cpu_us': r['cpu_s'] * scale, 'low': r['cpu_spread'][0] * scale,
                                 'high': r['cpu_spread'][1] * scale, 'wall': r['wall_s'] / r['simulated_s'],
                                 'memory_mb': r['memory_bytes'] / 1e6, 'hash': r['state_hash'][:8], 'depth_mm': depth})
    return curves


def price():
    """CPU over the deepest penetration: tolerances of the object simulators, steps of the one world."""
    settings = [('threads', f'{t} mm', ['--isolation', 'thread', '--tolerance', f'{t}mm']) for t in (50, 10, 1, .1)]
    settings += [('processes', f'{t} mm', ['--isolation', 'process', '--tolerance', f'{t}mm']) for t in (50, 10, 1, .1)]
    settings += [('one ODE world', f'1/{n} s', ['--arch', 'monolith', '--step', f'1/{n}'])
                 for n in (60, 120, 240, 480, 960, 1920)]
    curves = {}
    for name, label, words in settings:
        cpu, depth, rest = [], [], []
        for seed in range(1, SEEDS + 1):
            words_of_seed = [scene('falling_boxes'), *LANDING, *words, '--seed', str(seed)]
            measured = run(*words_of_seed, runs=1)
            undisturbed = run(*words_of_seed, '--set', 'measure=end', runs=1)
            cpu.append(1e6 * undisturbed['cpu_s'] / (100 * undisturbed['simulated_s']))
            depth.append(1e3 * measured['worst_penetration_m'])
            rest.append(1e3 * measured['penetration_mean_m'])
        curves.setdefault(name, []).append({'setting': label, 'cpu_us': cpu, 'depth_mm': depth, 'mean_mm': rest})
    return curves


def compared(*words):
    """The verdict of obsim compare on the falling boxes, then its table, in at most 100 columns."""
    done = subprocess.run([OBSIM, 'compare', 'scenes/falling_boxes.lua', *words], capture_output=True, text=True, check=True,
                          cwd=ROOT)
    return {'text': done.stdout}


def compare():
    return compared()


def varied():
    """A hundred and a thousand, while they fly, land and pile up."""
    return compared('--vary', 'n=100,1000', *LANDING)


def error_of(name, title):
    rows = []
    configurations = [(f'object simulators, {n} substep{"s" if n > 1 else ""}', ['--set', f'substeps={n}']) for n in (1, 2, 4, 8, 16, 32)]
    configurations += [('object simulators, default (1 mm)', [])]
    configurations += [(f'object simulators, tolerance {t}', ['--tolerance', t]) for t in ('10mm', '.1mm')]
    configurations += [(f'one ODE world, steps of 1/{n} s', ['--arch', 'monolith', '--step', f'1/{n}'])
                       for n in (60, 240, 960)]
    for what, words in configurations:
        seeds = [['--seed', str(seed)] for seed in range(1, SEEDS + 1)]
        reports = [run(scene(name), *words, *seed, runs=1) for seed in seeds]
        undisturbed = [run(scene(name), *words, *seed, '--set', 'measure=end', runs=1) for seed in seeds]
        cpu = statistics.median(1e3 * r['cpu_s'] / r['simulated_s'] for r in undisturbed)
        rows.append([what, f'{cpu:.1f}', spread([1e3 * r['worst_penetration_m'] for r in reports], 3),
                     spread([1e3 * r['penetration_mean_m'] for r in reports], 2)])
    return {'head': [title, 'CPU, ms per simulated s', 'deepest penetration, mm', 'mean at the end, mm'], 'rows': rows}


def error_falling():
    """Speed against error: more substeps for object simulators, shorter steps for one world."""
    return error_of('falling_boxes', f'100 falling boxes, 10 s, {SEEDS} seeds')


def error_stack():
    """Same for a standing stack, all awake; a seed is another set of offsets."""
    return error_of('stack', f'stack of 10, 20 s, {SEEDS} seeds')


def bits():
    """State after a run, for each isolation and number of workers."""
    configurations = [[isolation, workers] for isolation in ('thread', 'process') for workers in ('1', '2', '3', '8', 'objects')]
    rows = []
    for name in ('falling_boxes', 'stack', 'pile', 'cradle', 'sparse'):
        reports = [run(scene(name), '--isolation', isolation, '--workers', workers, '--set', 'measure=end', runs=1)
                   for isolation, workers in configurations]
        hashes = sorted({r['state_hash'] for r in reports})
        rows.append([name, f"{reports[0]['simulated_s']:g}", str(len(configurations)), ' '.join(hashes), 'no' if hashes[1:] else 'yes'])
    return {'head': ['scene', 'duration, s', 'configurations', 'state after it', 'equal'], 'rows': rows}


def counts():
    """Number of simulators that a machine supports."""
    rows = []
    for what, words in (('1000 simulators, a pool of 2', ['-D', 'n=1000']),
                        ('1000, one per process', ['-D', 'n=1000', '--isolation', 'process', '--workers', 'objects']),
                        ('1000, one per thread', ['-D', 'n=1000', '--workers', 'objects']),
                        ('4000, one per thread', ['-D', 'n=4000', '--workers', 'objects']),
                        ('10000, a pool of 2', ['-D', 'n=10000'])):
        r = run(scene('falling_boxes'), '--duration', '1', '--set', 'measure=end', *words)
        rows.append([what, f"{r['startup_s']:.2f}", f"{1e3 * r['wall_s'] / r['steps']:.1f}",
                     f"{r['body_step_cpu_us']:.2f}", f"{r['memory_bytes'] / 1e6:.0f}"])
    return {'head': ['1 s of falling boxes', 'start-up, s', 'wall per step, ms', 'CPU per body and step, µs', 'memory, MB'], 'rows': rows}


def shapes():
    """Cost of a pile by the shape of its bodies: each seed is another pile."""
    rows, boxes = [], 0
    for what, words in (('boxes', ()), *((f'hulls of {n} points', ('-D', f'points={n}')) for n in (8, 12, 20)),
                        ('boxes of .5 m, upright: columns, not a heap', ('-D', 'upright=true'))):
        reports = [run(str(BENCH / 'shapes.lua'), *words, '--workers', '1', '--seed', str(seed), runs=1)
                   for seed in range(1, SEEDS + 1)]
        cost = [r['body_step_cpu_us'] for r in reports]
        boxes = boxes or statistics.median(cost)
        rows.append([what, spread(cost, 3), f'{statistics.median(cost) / boxes:.2f}',
                     spread([1e3 * r['worst_penetration_m'] for r in reports], 3)])
    return {'head': [f'200 bodies, 3 s, {SEEDS} seeds', 'CPU per body and step, µs', 'over boxes', 'deepest penetration, mm'], 'rows': rows}


def capture():
    """Frames to PNG, four samples a pixel, drawn by the device that EGL finds."""
    rows = []
    for size in ('640x480', '1280x720', '1920x1080'):
        with tempfile.TemporaryDirectory() as folder:
            r = run(scene('falling_boxes'), '--duration', '1', '--out', folder, '--size', size, '--set', 'measure=end')
        rows.append([size, f"{r['frames'] / r['total_s']:.1f}"])
    return {'head': ['60 frames of 100 falling boxes to PNG', 'frames per second'], 'rows': rows}


EXPERIMENTS = (machine, growth, price, compare, varied, error_falling, error_stack, bits, counts, shapes, capture)


# -- Rendering: everything below computes from the file alone.

def table(data):
    rows = [data['head'], ['---'] + ['--:'] * (len(data['head']) - 1), *data['rows']]
    return ''.join('| ' + ' | '.join(row) + ' |\n' for row in rows)


def origin(data):
    m = data['machine']
    return f"Measured on {m['cores']} cores ({m['model']}), commit {m['commit']}.\n"


def at(curve, n, key):
    return next(p[key] for p in curve if p['n'] == n)


def reach(curve):
    """The number of objects at which a simulated second takes a second, two digits rounded down; '10,000 or more' at the end."""
    logs = [(math.log(p['n']), math.log(p['wall'])) for p in curve]
    for (n0, w0), (n1, w1) in zip(logs, logs[1:]):
        if w0 < 0 <= w1:
            n = math.exp(n0 + (n1 - n0) * -w0 / (w1 - w0))
            digit = 10 ** (math.floor(math.log10(n)) - 1)
            return f'{math.floor(n / digit) * digit:,}'
    return f"{curve[-1]['n']:,} or more" if logs[-1][1] < 0 else f"fewer than {curve[0]['n']:,}"


def middle(point, key):
    return statistics.median(point[key])


def number(x):
    return f'{x:.2g}' if x < 100 else f'{x:.0f}'


def crossing(one, many):
    """The deepest penetration (mm) below which many are cheaper than one: both curves are straight in logarithms."""
    def cost(curve, depth):
        points = sorted((math.log(middle(p, 'depth_mm')), math.log(middle(p, 'cpu_us'))) for p in curve)
        for (d0, c0), (d1, c1) in zip(points, points[1:]):
            if d0 <= depth <= d1:
                return c0 + (c1 - c0) * (depth - d0) / (d1 - d0)
        return points[0][1] if depth < points[0][0] else points[-1][1]  # constant beyond the ends
    deep = math.log(max(middle(p, 'depth_mm') for p in one))
    steps = [deep - .01 * i for i in range(2000)]
    return next((math.exp(d) for d in steps if cost(many, d) < cost(one, d)), 0)


SHOWN = (100, 1000, 10000)  # numbers of boxes in the table


def verdict(data):
    """What a simulator per object costs, for which error: a table, and what follows from it. All of it names n, duration and error."""
    grown, priced, m = data['growth'], data['price'], data['machine']
    pool, each, world = grown['threads'], grown['a process per object'], grown['one ODE world']
    same = all(len({at(curve, p['n'], 'hash') for name, curve in grown.items() if name != 'one ODE world' and any(q['n'] == p['n'] for q in curve)}) == 1
               for p in pool)
    cells = lambda curve, text: [text(at(curve, n, 'cpu_us'), n) if any(p['n'] == n for p in curve) else '–' for n in SHOWN]
    absolute = lambda cpu, n: f'{cpu:,.0f}'
    rows = [[f'CPU, µs: {what}', *cells(curve, absolute)] for what, curve in
            (('one ODE world, steps of 1/60 s', world), ('simulators in a pool of threads', pool), ('in a pool of processes', grown['processes']),
             ('in a process each', each))]
    rows.append(['pool of threads over one ODE world', *cells(pool, lambda cpu, n: f"{cpu / at(world, n, 'cpu_us'):.1f}")])
    rows += [[f'deepest overlap, mm: {what}', *(number(at(curve, n, 'depth_mm')) for n in SHOWN)] for what, curve in
             (('one ODE world', world), ('simulators', pool))]
    ratio = sorted(at(grown['processes'], p['n'], 'cpu_us') / p['cpu_us'] for p in pool if p['n'] in SHOWN)
    level = crossing(priced['one ODE world'], priced['threads'])
    where = f"{m['cores']} cores, commit {m['commit'][:7]}, medians of {m['runs']}"
    return table({'head': ['boxes that fall and land, 3 s simulated', *(f'n = {n:,}' for n in SHOWN)], 'rows': rows}) + '\n'.join([
        '', f'CPU is that of a box and a simulated second ({where}). ' + ('Threads, pools of processes and a process each end in the same bits.' if same else
                                                                        'Threads and processes end in different bits.'), '',
        f"- **Threads or processes?** A pool of processes takes {ratio[0]:.2f} to {ratio[-1]:.2f} times the CPU of a pool of threads; overlaps are"
        " equal.",
        f"- **One world or many?** Shorter steps make one world more exact, and dearer: for overlaps below {number(level)} mm simulators take"
        f" less CPU (n = 100, 3 s, {m['seeds']} seeds).",
        f"- **Boxes in real time?** While they land, with overlaps as above: {reach(pool)} boxes in a pool of threads, {reach(each)} in a process"
        f" each, {reach(world)} in one world.",
    ]) + '\n'


def summary(data):
    """The same in words, for docs/notebook/figures.md."""
    grown = data['growth']
    cost = [at(grown['threads'], n, 'cpu_us') / at(grown['one ODE world'], n, 'cpu_us') for n in SHOWN]
    error = [at(grown['one ODE world'], n, 'depth_mm') / at(grown['threads'], n, 'depth_mm') for n in SHOWN]
    return (f"While boxes land (n = 100 to 10,000, 3 s) object simulators take {min(cost):.1f} to {max(cost):.1f} times the CPU of one ODE world at"
            f" its usual step, and their deepest overlap is {min(error):.0f} to {max(error):.0f} times smaller. The table below of 100 boxes is of"
            " 10 s: most rest then, and cost object simulators nothing.\n")


TITLES = {'growth': 'CPU per body and simulated second, by the number of bodies', 'price': 'CPU per body and simulated second, by the error'}


def diagrams(data):
    """{file: description, as in a report's page}"""
    where = f"falling boxes, 3 s while they land; {data['machine']['cores']} cores, commit {data['machine']['commit'][:7]}"
    styles = {'one ODE world': 0, 'threads': 2, 'processes': 5, 'a process per object': 7}
    least, most = ([f"{number(pick(p['depth_mm'] for p in data['growth'][name]))}" for name in ('threads', 'one ODE world')] for pick in (min, max))
    depth = f'overlaps of {least[0]} to {most[0]} mm, in one world {least[1]} to {most[1]} mm'
    six = lambda v: float(f'{v:.6g}')

    def diagram(name, subtitle, x, series):
        return {'name': name, 'title': TITLES[name], 'subtitle': subtitle, 'x': {'label': x, 'scale': 'log'}, 'marks': [],
                'y': {'label': 'CPU per body and simulated second (µs)', 'scale': 'log'},
                'series': [{'title': title, 'style': styles[name], 'line': True, 'hollow': False, 'points': points} for name, title, points in series]}

    growth = diagram('growth', f"{where}; medians of {data['machine']['runs']}; {depth}", 'bodies', [
        (name, name, [{'x': p['n'], 'y': six(p['cpu_us']), 'low': six(p['low']), 'high': six(p['high'])} for p in curve])
        for name, curve in data['growth'].items()])
    price = diagram('price', '100 ' + where + f"; medians of {data['machine']['seeds']} seeds", 'deepest penetration (mm)', [
        (name, what, [{'x': six(middle(p, 'depth_mm')), 'y': six(middle(p, 'cpu_us')), 'label': p['setting']} for p in data['price'][name]])
        for name, what in (('one ODE world', 'one ODE world, by its steps'), ('threads', 'threads, by their tolerance'))]) # processes: the same points
    return {'docs/images/cost-objects.svg': growth, 'docs/images/cost-error.svg': price}


def blocks(data):
    found = {name: table(data[name]) for name in ('error_falling', 'error_stack', 'bits', 'counts', 'shapes', 'capture')}
    found |= {name: '```\n' + data[name]['text'] + '```\n' for name in ('compare', 'varied')}
    return found | {'machine': origin(data), 'verdict': verdict(data), 'summary': summary(data)}


def rendered(text, made):
    return re.sub(r'(<!-- figures: (\w+) -->\n).*?(<!-- end -->)',
                  lambda m: m.group(1) + '\n' + made[m.group(2)] + '\n' + m.group(3), text, flags=re.S)


def draw(description):
    """SVG of a diagram, with its description."""
    text, script = json.dumps(description, ensure_ascii=False).replace('<', '\\u003c'), (ROOT / 'src/experiments/experiment/chart.js').read_text(encoding='utf-8')
    with tempfile.TemporaryDirectory() as folder:
        page = pathlib.Path(folder) / 'page.html'
        page.write_text(f'<!DOCTYPE html><meta charset="utf-8"><figure><script class="chart" type="application/json">{text}</script></figure>'
                        f'<script>{script}</script>', encoding='utf-8')
        done = subprocess.run([shutil.which('chromium'), '--headless', '--no-sandbox', '--disable-gpu', '--dump-dom', page.as_uri()],
                              capture_output=True, text=True, check=True)
    svg = re.search(r'<svg.*?</svg>', done.stdout, re.S)[0]
    return svg.replace('</svg>', '<metadata>' + text.replace('&', '&amp;') + '</metadata>\n</svg>\n')


def described(path):
    """Description in a diagram's file."""
    found = path.exists() and re.search(r'<metadata>(.*?)</metadata>', path.read_text(encoding='utf-8'), re.S)
    return json.loads(found[1].replace('&amp;', '&')) if found else None


def stale():
    """(path, function that renders it) of documents and diagrams that differ from the data. Fonts differ among machines, so a diagram
    is compared by its description."""
    data = json.loads(DATA.read_text(encoding='utf-8'))
    made = blocks(data)
    for path in DOCUMENTS:
        old = path.read_text(encoding='utf-8')
        if (text := rendered(old, made)) != old:
            yield path, lambda text=text: text
    for name, description in diagrams(data).items():
        if described(ROOT / name) != description:
            yield ROOT / name, lambda description=description: draw(description)


NEEDED = {'README.md': ['verdict'], 'docs/notebook/figures.md': ['summary', 'verdict', 'compare', 'error_falling']}
FIGURE = re.compile(r'\d[\d.,]*\s?(µs|mm\b|times the CPU|% of)')


def faults():
    """Blocks that are missing, so that two documents may differ; figures that no measurement wrote."""
    for name, blocks_of in NEEDED.items():
        text = (ROOT / name).read_text(encoding='utf-8')
        yield from (f'{name} has no block of {block}' for block in blocks_of if f'<!-- figures: {block} -->' not in text)
    plain = re.sub(r'<!-- figures: .*?<!-- end -->', '', (ROOT / 'README.md').read_text(encoding='utf-8'), flags=re.S)
    yield from (f'README.md has "{m.group()}" outside of its block' for m in FIGURE.finditer(plain))


def main():
    global OBSIM
    words = sys.argv[1:]
    if len(words) == 2 and words[0] == 'measure':
        OBSIM = os.path.abspath(words[1])
        data = {e.__name__: e() for e in EXPERIMENTS}
        DATA.write_text(json.dumps(data, indent=1, ensure_ascii=False) + '\n', encoding='utf-8')
        return 0
    if words not in (['write'], ['check']):
        sys.exit(__doc__)
    wrong = 0
    for fault in faults() if words == ['check'] else ():
        print(fault)
        wrong = 1
    for path, text in stale():
        if words == ['write']:
            path.write_text(text(), encoding='utf-8')
        else:
            print(f'{path.relative_to(ROOT)} differs from {DATA.relative_to(ROOT)}: python3 bench/figures.py write')
            wrong = 1
    return wrong


if __name__ == '__main__':
    sys.exit(main())
