#!/usr/bin/env python3
"""performance.py RESULTS.csv ... [FILE]: rewrites the tables between <!-- performance: NAME --> and <!-- end --> in
FILE from results of bench/run.py --mode full; without FILE prints them all. Among several results for the same, the
last counts: so a few scenes can be measured again.
"""
import collections
import csv
import math
import re
import statistics
import sys


class Measured:
    """All values of the file, by their keys."""

    def __init__(self, paths):
        self.rows = {}  # (scene, engine, setting, duration, quantity): [values]
        self.settings = {}  # (scene, engine, setting, duration): knobs
        self.places = []  # [machine, commit, day], without duplicates
        for path in paths:
            self.read(path)

    def read(self, path):
        rows = collections.defaultdict(list)
        with open(path, encoding='utf-8', newline='') as f:
            for line in csv.DictReader(f):
                key = line['scene'], line['engine'], line['setting'], float(line['duration'] or 0)
                rows[(*key, line['quantity'])].append(line['value'])
                self.settings[key] = line['knobs']
                place = [line['machine'], line['commit'], line['date'][:10]]
                self.places += [place] if place not in self.places else []
        again = {key[:4] for key in rows}
        self.rows = {key: values for key, values in self.rows.items() if key[:4] not in again} | rows

    def values(self, scene, engine, quantity, setting='usual', duration=0.):
        found = self.rows.get((scene, engine, setting, duration, quantity), [])
        return [float(v) for v in found]

    def get(self, *what, **how):
        """Median; NaN if not measured."""
        values = self.values(*what, **how)
        return statistics.median(values) if values else math.nan

    def failed(self, scene, engine, setting='usual', duration=0.):
        return next(iter(self.rows.get((scene, engine, setting, duration, 'failed'), [])), '')

    def texts(self, scene, engine, quantity):
        return set(self.rows.get((scene, engine, 'usual', 0., quantity), []))

    def equal(self, scene, engine):
        """Setting at which an engine was measured at equal error; "" if none."""
        return next((s for sc, e, s, _ in self.settings if (sc, e) == (scene, engine) and '<=' in s), '')

    def cost(self, scene, engine, **how):
        return self.get(scene, engine, 'cpu', **how)

    def ours(self, scene, **how):
        """Value of obsim through its host, as users run it; otherwise of the lab, which stops at each step."""
        cost = self.cost(scene, 'obsim 1 thread', **how)
        return self.cost(scene, 'obsim', **how) if math.isnan(cost) else cost

    def cost_at_equal(self, scene, engine):
        return self.cost(scene, engine, setting=self.equal(scene, engine))


def row(*cells):
    return '| ' + ' | '.join(str(c) for c in cells) + ' |\n'


def head(*cells, texts=(0,)):
    return row(*cells) + row(*['---' if i in texts else '--:' for i in range(len(cells))])


def number(x):
    return '–' if math.isnan(x) else f'{x:.3g}'


def spread(values):
    if not values:
        return '–'
    return f'{statistics.median(values):.3g} ({min(values):.3g}–{max(values):.3g})'


# ---- targets

class Promise:
    """A line of the list: a figure, and its bound."""

    def __init__(self, what, value, bound, at_least=False, note=''):
        self.what, self.value, self.bound, self.at_least, self.note = what, value, bound, at_least, note

    def kept(self):
        if math.isnan(self.value):
            return '–'
        return 'yes' if (self.value >= self.bound if self.at_least else self.value <= self.bound) else 'no'

    def line(self):
        target = f"{'≥' if self.at_least else '≤'} {self.bound:g}"
        return row(self.what, target, number(self.value), self.kept(), self.note)


def flight(m):
    for name, duration, bound in (('10 s', 0., 3), ('first 3 s', 3., 4)):
        ours = m.ours('sparse-10000', duration=duration)
        theirs = m.cost('sparse-10000', 'ode-quick', duration=duration)
        yield Promise(f'sparse 10,000, {name}: ODE with SAP space / obsim', theirs / ours, bound, True,
                      f'us/body-step: obsim {number(ours)}, ODE {number(theirs)}')
    for n in ('49', '1000'):
        ours = m.ours(f'balls-{n}')
        for engine in ('ode-quick', 'bullet'):
            yield Promise(f'{n} bouncing balls, e = 1: {engine} / obsim', m.cost(f'balls-{n}', engine) / ours, 15, True,
                          f"us/body-step: obsim {number(ours)}, {engine} {number(m.cost(f'balls-{n}', engine))}")
        yield Promise(f'{n} bouncing balls: error of energy', m.get(f'balls-{n}', 'obsim', 'error of energy'), 1e-12)


def standing(m):
    for scene, name in (('stack-10', 'stack of 10'), ('pyramid-15', 'pyramid of 120')):
        ours = m.cost_at_equal(scene, 'obsim')
        for engine, bound in (('bullet', 8), ('ode-quick', 20)):
            theirs = m.cost_at_equal(scene, engine)
            yield Promise(f'{name}: {engine} at ≤ 1 mm / obsim at ≤ .5 mm', theirs / ours, bound, True,
                          f'us/body-step: obsim {number(ours)}, {engine} {number(theirs)}')


def heaps(m):
    worst = 'worst penetration at any moment'
    for n in ('1000', '4000'):
        scene = f'falling-{n}'
        ours, theirs = m.ours(scene), m.cost(scene, 'bullet')
        yield Promise(f'falling {n}: obsim / Bullet', ours / theirs, .85,
                      note=f'us/body-step: {number(ours)}, {number(theirs)}')
        if m.equal(scene, 'obsim'):
            best = m.cost_at_equal(scene, 'obsim')
            yield Promise(f'falling {n}, cheapest setting with ≤ 20 mm and ≤ .1 mm: obsim / Bullet', best / theirs, .85,
                          note=f'us/body-step: {number(best)}, {number(theirs)}')
        yield Promise(f'falling {n}: worst impact, mm', m.get(scene, 'obsim', worst), 20,
                      note=f"Bullet {number(m.get(scene, 'bullet', worst))}")
        yield Promise(f'falling {n}: resting mean, mm', m.get(scene, 'obsim', 'resting mean penetration'), .1,
                      note=f"Bullet {number(m.get(scene, 'bullet', 'resting mean penetration'))}")
        one, two = m.get(scene, 'obsim 1 thread', 'wall'), m.get(scene, 'obsim 2 threads', 'wall')
        path = [m.get(scene, f'obsim {w}', 'critical path', setting='critical path', duration=10.)
                for w in ('1 thread', '2 threads')]
        yield Promise(f'falling {n}: wall of two workers / of one', two / one, .6,
                      note=f'critical path, with a core for each: {number(path[1] / path[0])}')
        if n == '4000':
            yield Promise(f'falling {n}: wall of two workers / of ODE', two / m.get(scene, 'ode-quick', 'wall'), .35)
    yield Promise('pile of 216, at ≤ 2 mm: us per body-step', m.cost_at_equal('pile', 'obsim'), 3,
                  note=f"usual setting {number(m.ours('pile'))}, worst {number(m.get('pile', 'obsim', worst))} mm")


def hard(m):
    ours, theirs = m.cost_at_equal('heavy-1000', 'obsim'), m.cost_at_equal('heavy-1000', 'ode-world')
    yield Promise('1000 : 1 at ≤ 2 mm: obsim / dWorldStep', ours / theirs, 1,
                  note=f"us/body-step: {number(ours)}, {number(theirs)}; "
                       f"usual setting {number(m.cost('heavy-1000', 'obsim'))}")
    ours, theirs = m.cost_at_equal('rolling-diagonal', 'obsim'), m.cost('rolling-diagonal', 'bullet')
    yield Promise('rolling at ≤ 1e-5: obsim / Bullet at 60 Hz', ours / theirs, 2,
                  note=f"us/body-step: {number(ours)}, {number(theirs)}; "
                       f"usual setting {number(m.cost('rolling-diagonal', 'obsim'))}")


def scale(m):
    for family, duration in (('sparse', 3.), ('falling', 2.)):
        few, many = (m.ours(f'{family}-{n}', duration=duration) for n in ('1000', '100000'))
        yield Promise(f'{family}: cost per body of 100,000 / of 1000', many / few, 1.5,
                      note=f'us/body-step: {number(few)}, {number(many)}')
    yield Promise('sparse 100,000: bytes per object', m.get('sparse-100000', 'obsim', 'memory', duration=3.), 1500)
    yield Promise('sparse 100,000: bytes per object with an ODE world each',
                  m.get('sparse-100000', 'obsim ODE worlds', 'memory', duration=.5), 4000)
    for engine in ('obsim 1 thread', 'obsim 2 threads'):
        for scene in ('falling-10', 'sparse-10', 'stack-10'):
            yield Promise(f'{scene}: median step of {engine}, us wall', m.get(scene, engine, 'median step'), 10,
                          note=f"mean {number(m.get(scene, engine, 'wall'))}")


def shared(m):
    def told(scene, quantity, what, end):
        return m.get(scene, 'obsim 2 threads', quantity, setting=f'shared, {what}', duration=end)

    alone = 'arranged by one worker alone'
    landing = told('falling-10000', alone, 'landing', 2.)
    work = told('falling-10000', 'cpu, timed', 'landing', 2.)
    gain = told('falling-10000', 'speed-up of 16 workers', 'landing', 2.)
    yield Promise('falling 10,000, landing: speed-up of 16 simulated workers', gain, 12, True)
    yield Promise('falling 10,000, landing: share of the work that one worker schedules alone', landing / work, .02)
    yield Promise('falling 10,000, landing: scheduled by one worker alone, us per body-step', landing, .1)
    yield Promise('sparse 10,000, in flight: scheduled by one worker alone, us per body-step',
                  told('sparse-10000', alone, 'in flight', 3.), .02)


def pools(m):
    scenes = sorted({s for s, e, _, d in m.settings if e == 'obsim 2 processes' and not d})
    same = sum(len(set.union(*(m.texts(s, e, 'state') for e in SIDES_OF_OBSIM))) == 1 for s in scenes)
    yield Promise('scenes whose state differs between workers and isolations', len(scenes) - same, 0,
                  note=f'of {len(scenes)}')
    for scene in scenes:
        ratio = m.cost(scene, 'obsim 2 processes') / m.cost(scene, 'obsim 2 threads')
        yield Promise(f'{scene}: CPU of a process pool / of a thread pool', ratio, 1.2)


SIDES_OF_OBSIM = ['obsim', 'obsim 1 thread', 'obsim 1 process', 'obsim 2 threads', 'obsim 2 processes']


def promises(m):
    text = head('figure', 'target', 'measured', 'kept', '', texts=(0, 4))
    for group in (flight, standing, heaps, hard, scale, shared, pools):
        for promise in group(m):
            text += promise.line()
    return text


# ---- all measurements

def errors_of(m, scene, engine, setting, duration):
    named = {q: v for (s, e, st, d, q), v in m.rows.items() if (s, e, st, d) == (scene, engine, setting, duration)}
    plain = {'cpu', 'wall', 'median step', 'start-up', 'memory', 'bodies', 'steps', 'state', 'failed'}
    states, ours = (set(m.rows.get((scene, e, setting, duration, 'state'), [])) for e in (engine, 'obsim'))
    if engine != 'obsim' and states and states == ours:
        return 'as obsim: it ends in the same bits'
    told = [f'{q} {number(float(v[0]))}' for q, v in named.items() if q not in plain]
    return '; '.join(([f"failed: {m.failed(scene, engine, setting, duration)}"] if 'failed' in named else []) + told)


def table_of(m, wanted):
    text = head('scene', 'engine', 'setting', 'errors', 'CPU, us per body and step', 'wall, us per step', texts=range(4))
    for (scene, engine, setting, duration), knobs in m.settings.items():
        if not wanted(setting) or not scene:
            continue
        how = {'setting': setting, 'duration': duration}
        text += row(scene + (f', {duration:g} s' if duration else ''), engine,
                    re.sub(r'duration=\S+ ?', '', knobs) or 'usual', errors_of(m, scene, engine, setting, duration), spread(m.values(scene, engine, 'cpu', **how)),
                    spread(m.values(scene, engine, 'wall', **how)))
    return text


ENGINES = [('obsim', ''), ('ode-quick', 'ODE QuickStep'), ('bullet', 'Bullet'), ('mujoco', 'MuJoCo')]


def first_error(m, scene, engine, duration):
    """Main figure of a scene, in its unit, or the reason for its absence."""
    failed = m.failed(scene, engine, duration=duration)
    if failed:
        return failed.split(' (')[0]
    plain = {'cpu', 'wall', 'median step', 'start-up', 'memory', 'bodies', 'steps', 'state', 'failed'}
    worst = [(s, e, st, d, q) for s, e, st, d, q in m.rows
             if (s, e, st, d) == (scene, engine, 'usual', duration) and q not in plain]
    deepest = [k for k in worst if 'at any moment' in k[4]] or worst
    return number(float(m.rows[deepest[0]][0])) if deepest else '–'


def usual(m):
    """A row for each scene: cost and error of each engine at its defaults."""
    text = head('scene', *[title or 'obsim' for _, title in ENGINES], 'error')
    for scene, duration in dict.fromkeys((s, d) for s, _, setting, d in m.settings if setting == 'usual' and s):
        cells, what = [], ''
        for engine, _ in ENGINES:
            how = {'duration': duration}
            cost = m.ours(scene, **how) if engine == 'obsim' else m.cost(scene, engine, **how)
            measured = engine == 'obsim' or not math.isnan(cost) or m.failed(scene, engine, **how)
            cells.append(f'{number(cost)} ({first_error(m, scene, engine, duration)})' if measured else '')
        errors = [q for s, e, st, d, q in m.rows if (s, e, st, d) == (scene, 'obsim', 'usual', duration)]
        what = next((q for q in errors if 'at any moment' in q), None) or next(
            (q for q in errors if q not in {'cpu', 'wall', 'median step', 'start-up', 'memory', 'bodies', 'steps', 'state',
                                            'failed'}), '–')
        text += row(scene + (f', {duration:g} s' if duration else ''), *cells, what)
    return text


def equal(m):
    return table_of(m, lambda setting: '<=' in setting)


def windows(m):
    """[(scene, setting, duration)] with measured parts."""
    return [(s, st, d) for s, _, st, d in m.settings if (s, 'obsim 1 thread', st, d, 'cpu, timed') in m.rows]


def parts_of(m, window):
    scene, setting, duration = window
    return {q[6:]: float(v[0]) for (s, _, st, d, q), v in m.rows.items()
            if (s, st, d) == (scene, setting, duration) and q.startswith('part: ')}


def counts_of(m, window):
    scene, setting, duration = window
    return {q[7:]: float(v[0]) for (s, _, st, d, q), v in m.rows.items()
            if (s, st, d) == (scene, setting, duration) and q.startswith('count: ')}


def parts(m):
    found = windows(m)
    text = head('us per body and step', *[f'{s}, {st}' for s, st, _ in found])
    for part in parts_of(m, found[0]) if found else ():
        text += row(part, *[number(parts_of(m, w)[part]) for w in found])
    text += row('**sum**', *[number(sum(parts_of(m, w).values())) for w in found])
    return text + '\n' + head('per body and step', *[f'{s}, {st}' for s, st, _ in found]) + ''.join(
        row(count.replace('_', ' '), *[number(counts_of(m, w)[count]) for w in found])
        for count in (counts_of(m, found[0]) if found else ()))


def functions(m):
    text = head('scene', 'function', '% of CPU', texts=(0, 1))
    for (scene, _, setting, _, quantity), value in m.rows.items():
        if setting == 'functions':
            text += row(scene, f"`{quantity.removeprefix('function: ')}`", value[0])
    return text


def pieces_of(m):
    return {q: float(v[0]) for (_, _, setting, _, q), v in m.rows.items() if setting == 'pieces'}


def pieces(m):
    units = {'machine: arithmetic': 'Gflop/s', 'machine: copy': 'GB/s'}
    return head('', '', 'unit', texts=(0, 2)) + ''.join(
        row(what, number(value), next((u for w, u in units.items() if what.startswith(w)), 'ns'))
        for what, value in pieces_of(m).items())


# Lower bounds for a unit of work: (part, counted unit, flops, bytes, distance of those in memory). Counted by hand:
# - an exchange of a pair with four points (contact/kernel.c): rates of seven rows 101, one sweep 156, impulses onto two
#   bodies 141, limits 50; it reads 114 doubles of the pair and 24 of the bodies, and writes 8 and 12;
# - narrow phase of two boxes (contact/boxes.h): nine products of axes 135, fifteen axes of some 22, clipping a face
#   against four sides some 100; two poses and sizes read, a pair of four points written;
# - a substep of a body: its turn as a quaternion and a matrix 110, prediction 24; its rows read and written;
# - a body of an island: its motion and body properties in, its motion out;
# - a visit of a flying body: a plan of its rotation 400, ten evaluations of it on the way to the ground, 110 each; its
#   motion, body properties and box, and those of a neighbour.
UNITS = [
    ('solve', 'pair_solves', 448, 1264, 'near'),
    ('narrowphase', 'narrowphase_tests', 565, 700, 'near'),
    ('move', 'body_substeps', 134, 600, 'near'),
    ('load', 'body_steps', 100, 448, 'far'),
    ('publish', 'body_steps', 150, 300, 'far'),
    ('ballistic', 'ballistic_advances', 1500, 900, 'far'),
    ('broadphase', 'box_tests', 6, 24, 'far'),
]


def floor(m):
    """Each part against the least time of its arithmetic, or its memory traffic."""
    machine = pieces_of(m)
    if not machine:
        return ''
    flops = machine['machine: arithmetic, four lanes of doubles']  # per ns
    rate = {'near': machine['machine: copy within 256 kB'], 'far': machine['machine: copy within 64 MB']}
    text = head('scene', 'part', 'units per body and step', 'flops of one', 'bytes of one', 'floor, us', 'measured, us',
                'measured / floor', texts=(0, 1))
    for window in windows(m):
        counts, measured = counts_of(m, window), parts_of(m, window)
        for part, count, work, size, where in UNITS:
            units = counts.get(count, 0.)
            least = 1e-3 * units * max(work / flops, size / rate[where])
            if measured.get(part, 0.) > 0 and units > .01:
                text += row(f'{window[0]}, {window[1]}', part, number(units), work, size, number(least),
                            number(measured[part]), number(measured[part] / least))
    return text


def machine(m):
    return ''.join(f'Measured on {where}, commit {commit}, {day}.\n' for where, commit, day in m.places)


TABLES = {f.__name__: f for f in (machine, promises, usual, equal, parts, functions, pieces, floor)}


def main():
    paths = [word for word in sys.argv[1:] if word.endswith('.csv')]
    pages = [word for word in sys.argv[1:] if not word.endswith('.csv')]
    if not paths or len(pages) > 1 or (pages and pages[0].startswith('-')):
        sys.exit(__doc__)
    try:
        measured = Measured(paths)
    except (OSError, KeyError, TypeError, ValueError, csv.Error) as e:
        sys.exit(f"{', '.join(paths)}: not of bench/run.py: {e}")
    if not measured.rows:
        sys.exit(f"{', '.join(paths)}: no results")
    if not pages:
        for name, table in TABLES.items():
            print(f'{name}\n\n{table(measured)}')
        return
    with open(pages[0], encoding='utf-8') as f:
        text = f.read()
    text = re.sub(r'(<!-- performance: (\w+) -->\n).*?(<!-- end -->)',
                  lambda found: found.group(1) + '\n' + TABLES[found.group(2)](measured) + '\n' + found.group(3), text,
                  flags=re.S)
    with open(pages[0], 'w', encoding='utf-8') as f:
        f.write(text)


if __name__ == '__main__':
    main()
