#!/usr/bin/env python3
"""Measures obsim against other engines: cost of a body per step, and errors.

run.py BUILD [OPTION ...]

  --mode short|full|tiny   short (the default): the essential quantities, in less than three minutes; full: every line
                           of docs/notebook/performance.md; tiny: for the tests
  --out FILE               results, a line for each quantity (bench.csv)
  --document FILE          rewrites its tables afterwards, by performance.py
  --scenes GLOB,...        only these, as "falling-*"
  --engines GLOB,...       only these, as "obsim*,bullet"
  --repeats N              runs of each (5; 3 if longer than 6 s, 2 if longer than 20 s, 1 if longer than a minute)
  --no-look                times alone
  --no-equal               full: no search for settings of equal error

Sides alternate, repeat by repeat, so that a busy minute of the machine affects all alike; each run is a process of its
own. Times are of stepping alone. Errors come from one more run of each, as observing disturbs the times; the final
state shows that repeats are the same run. Compare two files with compare.py.
"""
import argparse
import csv
import datetime
import fnmatch
import os
import re
import subprocess
import sys
import tempfile

import plan

COLUMNS = ['date', 'commit', 'machine', 'scene', 'duration', 'engine', 'setting', 'knobs', 'repeat', 'quantity', 'unit',
           'value']
LIMIT = 600  # s, of a run
REPEATS = {60: 1, 20: 2, 6: 3}  # number of repeats for runs longer than so many s


def machine():
    with open('/proc/cpuinfo', encoding='utf-8') as f:
        model = re.search(r'model name\s*: (.*)', f.read())
    return f"{len(os.sched_getaffinity(0))} x {model.group(1) if model else 'unknown'}, {os.uname().release}"


def commit(build):
    """Commit of the measured program."""
    done = subprocess.run([os.path.join(build, 'obsim'), '--version'], capture_output=True, text=True, check=False)
    found = re.search(r'\b[0-9a-f]{12}\+?', done.stdout)
    return found.group(0) if found else 'unknown'


class Side:
    """An engine in a scene with its settings, and all its measurements."""

    def __init__(self, scene, name, knobs, setting):
        self.scene, self.name, self.knobs, self.setting = scene, name, knobs, setting
        self.failed, self.took = False, 0.

    def words(self):
        return ' '.join(f'{k}={v:g}' for k, v in sorted(self.knobs.items()))

    def run(self, what):
        """[(quantity, unit, value)], and the duration; the last quantity of a failed run is "failed"."""
        engine, more = plan.SIDES[self.name]
        words = [f'{k}={v:.17g}' for k, v in {**self.knobs, **more}.items()]
        begin = os.times().elapsed
        try:
            done = subprocess.run([TOOL, self.scene, engine, what, *words], capture_output=True, text=True, timeout=LIMIT,
                                  check=False)
            if 'no engine' in done.stderr:  # Bullet is optional
                return [['failed', '', 'not built']], 0.
            if done.returncode not in (0, 1):
                sys.exit(f"{self.scene}, {self.name}: {done.stderr.strip() or f'exit {done.returncode}'}")
            rows = [line.split('\t') for line in done.stdout.splitlines()]
        except subprocess.TimeoutExpired:
            rows = [['failed', '', f'took longer than {LIMIT} s']]
        return rows, os.times().elapsed - begin


class Results:
    """The file: it grows line by line, so that an interrupted run leaves its results."""

    def __init__(self, path, build):
        self.file = open(path, 'w', encoding='utf-8', newline='')
        self.csv = csv.writer(self.file)
        self.csv.writerow(COLUMNS)
        self.head = [datetime.datetime.now(datetime.timezone.utc).strftime('%Y-%m-%dT%H:%M:%SZ'), commit(build), machine()]

    def add(self, side, repeat, rows):
        for quantity, unit, value in rows:
            self.csv.writerow([*self.head, side.scene, side.knobs.get('duration', ''), side.name, side.setting,
                               side.words(), repeat, quantity, unit, value])
        self.file.flush()


def value_of(rows, quantity):
    return next((float(v) for q, _, v in rows if q == quantity), float('nan'))


def wanted(name, globs):
    return not globs or any(fnmatch.fnmatchcase(name, g) for g in globs.split(','))


def say(side, what, rows):
    failed = next((v for q, _, v in rows if q == 'failed'), None)
    seen = {'time': 'cpu', 'look': rows[0][0]}[what]
    text = failed or f'{seen} {value_of(rows, seen):.4g} {next(u for q, u, _ in rows if q == seen)}'
    print(f'{side.scene:18} {side.name:20} {side.words():40} {text}', flush=True)


def measure(sides, options, results):
    """Measures repeat by repeat; errors first."""
    for side in sides:
        engine, _ = plan.SIDES[side.name]
        if options.no_look or engine == 'host' or re.search(r'-\d{6,}$', side.scene):
            continue  # a host ends in the same bits; observing a hundred thousand bodies takes longer than stepping
        rows, _ = side.run('look')
        results.add(side, 0, rows)
        say(side, 'look', rows)
    for repeat in range(1, options.repeats + 1):
        for side in sides:
            if side.failed or any(repeat > most and side.took > long for long, most in REPEATS.items()):
                continue
            rows, side.took = side.run('time')
            side.failed = any(q == 'failed' for q, _, _ in rows)
            results.add(side, repeat, rows)
            say(side, 'time', rows)


def keeps(rows, bounds):
    return not any(q == 'failed' for q, _, _ in rows) and all(value_of(rows, q) <= most for q, most in bounds.items())


def cheapest(scene, seconds, name, bounds, results):
    """First of the settings, cheapest first, that keeps all errors; None: none does."""
    setting = ', '.join(f'{error} <= {most:g}' for error, most in bounds.items())
    tried = []
    for knobs in plan.KNOBS[name]:
        rows, _ = Side(scene, name, {**knobs, 'duration': seconds}, setting).run('time')
        if not any(q == 'failed' for q, _, _ in rows):
            tried.append((value_of(rows, 'cpu'), Side(scene, name, knobs, setting)))
    for _, side in sorted(tried, key=lambda t: t[0]):
        rows, _ = side.run('look')
        found = keeps(rows, bounds)
        print(f"{scene:18} {name:20} {side.words():40} {'keeps' if found else 'does not keep'} {setting}", flush=True)
        if found:
            return side
    results.add(Side(scene, name, {}, setting), 0, [('failed', '', 'no setting keeps it')])
    return None


def equal(options, results):
    """Number of sides that took part."""
    count = 0
    for scene, seconds, sides in plan.EQUAL:
        if wanted(scene, options.scenes):
            found = [cheapest(scene, seconds, name, bounds, results) for name, bounds in sides.items()
                     if wanted(name, options.engines)]
            measure([s for s in found if s], options, results)
            count += len(found)
    return count


def profile(options, results):
    """obsim's parts and functions, and the cost of its components by themselves."""
    for scene, begin, end, what in plan.PARTS:
        if wanted(scene, options.scenes):
            side = Side(scene, 'obsim 1 thread', {'from': begin, 'duration': end}, what)
            results.add(side, 1, side.run('parts')[0])
            print(f'{scene:18} parts, {what}', flush=True)
    for scene, seconds in plan.CRITICAL:
        for name in ('obsim 1 thread', 'obsim 2 threads') if wanted(scene, options.scenes) else ():
            side = Side(scene, name, {'duration': seconds}, 'critical path')
            rows = [r for r in side.run('parts')[0] if r[0] in ('critical path', 'failed')]
            results.add(side, 1, rows)
            print(f"{scene:18} {name}, critical path {value_of(rows, 'critical path'):.4g} us", flush=True)
    for scene, begin, end, what in plan.SHARED:
        if wanted(scene, options.scenes):
            side = Side(scene, 'obsim 2 threads', {'from': begin, 'duration': end}, f'shared, {what}')
            told = 'cpu, timed', 'arranged by one worker alone', 'speed-up of 16 workers', 'failed'
            results.add(side, 1, [r for r in side.run('parts')[0] if r[0] in told])
            print(f'{scene:18} shared, {what}', flush=True)
    for scene, seconds in plan.FUNCTIONS:
        if wanted(scene, options.scenes):
            side = Side(scene, 'obsim', {'duration': seconds}, 'functions')
            results.add(side, 1, functions(side))
            print(f'{scene:18} functions', flush=True)
    done = subprocess.run([os.path.join(options.build, 'bench', 'bench_step')], capture_output=True, text=True, check=True)
    results.add(Side('', 'obsim', {}, 'pieces'), 1, [line.split('\t') for line in done.stdout.splitlines()])


def functions(side):
    """Shares of CPU time sampled by perf; none without perf."""
    with tempfile.TemporaryDirectory() as folder:
        data = os.path.join(folder, 'perf.data')
        words = [TOOL, side.scene, side.name, 'time', side.words()]
        try:
            subprocess.run(['perf', 'record', '-q', '-e', 'cpu-clock', '-F', '1000', '-o', data, '--', *words],
                           capture_output=True, check=True)
            text = subprocess.run(['perf', 'report', '-i', data, '--stdio', '-q', '--no-children', '-F', 'overhead,symbol'],
                                  capture_output=True, text=True, check=True).stdout
        except (OSError, subprocess.CalledProcessError):
            return []
    found = re.findall(r'^\s*([\d.]+)%\s+\[\S\]\s+(\S+)', text, flags=re.M)
    return [(f'function: {name}', '%', share) for share, name in found[:15]]


def main():
    global TOOL
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('build')
    p.add_argument('--mode', choices=('short', 'full', 'tiny'), default='short')
    p.add_argument('--out', default='bench.csv')
    p.add_argument('--document')
    p.add_argument('--scenes', default='')
    p.add_argument('--engines', default='')
    p.add_argument('--repeats', type=int, default=5)
    p.add_argument('--no-look', action='store_true')
    p.add_argument('--no-equal', action='store_true')
    options = p.parse_args()
    TOOL = os.path.join(options.build, 'bench', 'bench_engine')
    if not os.access(TOOL, os.X_OK):
        p.error(f'{TOOL} is not there: build it first')
    if options.repeats < 1:
        p.error('at least one repeat')
    results = Results(options.out, options.build)
    chosen = 0
    for scene, names, knobs in {'short': plan.SHORT, 'full': plan.FULL, 'tiny': plan.TINY}[options.mode]:
        sides = [Side(scene, n, knobs, 'usual') for n in names if wanted(n, options.engines)]
        if wanted(scene, options.scenes) and sides:
            measure(sides, options, results)
            chosen += len(sides)
    if options.mode == 'full':
        chosen += 0 if options.no_equal else equal(options, results)
        profile(options, results)
    if not chosen:
        p.error('nothing has this name; see bench/plan.py')
    if options.document:
        performance = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'performance.py')
        sys.exit(subprocess.run([sys.executable, performance, options.out, options.document], check=False).returncode)


if __name__ == '__main__':
    main()
