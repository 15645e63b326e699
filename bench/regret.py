#!/usr/bin/env python3
"""Measures what a tolerance costs beside the cheapest fixed number of substeps that errs as little, and false alarms.

regret.py BUILD [OPTION ...]

  --scenes GLOB,...    names of kinds of kinds.lua, shipped scenes, cases of the lab (kinds/*), as "kinds/car,cradle,lab/*"
  --seeds A..B         of each kind (1..2)
  --tolerances LIST    mm (10,1,.1)
  --seconds N          simulated, at most (3)
  --judge N            substeps that count as the truth (512)
  --list               prints each scene and tolerance
  --verdicts           no costs: what the reports say, and whether they say the same with verify=on (exits 1 if not)

The truth of a second is that second gone through again with so many substeps, from the places and velocities that the run
had when it began. A second of a body is wrong if at its end its surface is further from there than the tolerance.

  regret    CPU of the control over that of the cheapest of 1, 2, 4 .. 512 substeps with as few wrong seconds of bodies, and
            a largest error that is no more than the control's
  lavish    the same over the cheapest with as few wrong seconds: what exactness costs that nobody asked for
  alarm     the run said that motion may exceed the tolerance (obsim run --strict exits 1)
  false     alarms without a wrong second
  silent    wrong seconds without an alarm
  verdicts  runs of which a strict one ends otherwise, or elsewhere, with verify=on than without, though verifying found nothing;
            or alike, though it did

CPU is the simulators' alone, the least of three runs with one worker. The search ends with the first number
of substeps that takes as long as the control, for a regret of 1.
"""
import argparse
import fnmatch
import glob
import json
import math
import os
import re
import statistics
import subprocess
import sys

import obsim

BENCH = os.path.dirname(os.path.abspath(__file__))
SHIPPED = ['arch', 'bowling', 'bridge', 'cradle', 'crane', 'fall', 'falling_boxes n=30', 'gas', 'head_on', 'machines', 'pyramid',
           'shapes', 'sparse n=30', 'stack', 'strings', 'wrecking_ball']
ERROR_FLOOR = 1e-9 # m, below which errors are alike


class Scene:
    """A scene file with its parameters."""

    def __init__(self, build, name, path, parameters, seed=None):
        self.build, self.name, self.path, self.parameters, self.seed = build, name, path, parameters, seed
        self.title = name + (f' {seed}' if seed else '')

    def run(self, knob, seconds, *more):
        """The exit status and the report of a run. knob: ('tolerance', m) or ('substeps', n)."""
        words = [f'{self.build}/obsim', 'run', self.path, '--workers', '1', '--set', 'measure=end', '--json', '-', '--duration',
                 repr(seconds), *[w for name, value in self.parameters.items() for w in ('-D', f'{name}={value}')],
                 *(['--seed', str(self.seed)] if self.seed else []),
                 *(['--tolerance', repr(knob[1])] if knob[0] == 'tolerance' else ['--set', f'substeps={knob[1]}']), *more]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        return done.returncode, json.loads(done.stdout) if done.stdout else None

    def report(self, knob, seconds, times=3):
        """The report of a run, with the least CPU of three; None if it failed."""
        runs = [self.run(knob, seconds) for _ in range(times)]
        return None if any(code for code, _ in runs) else min((report for _, report in runs), key=lambda r: r['cpu_s'])

    def play(self, knob):
        options = {knob[0]: knob[1], 'workers': 1} | ({'seed': self.seed} if self.seed else {})
        return obsim.run(self.path, options=options, **self.parameters)


def find_scenes(build, seeds):
    """Kinds, shipped scenes, and cases of the lab that are scenes."""
    with open(f'{BENCH}/kinds.lua', encoding='utf-8') as f:
        kinds = re.findall(r'^function kinds\.(\w+)', f.read(), re.M)
    scenes = [Scene(build, f'kinds/{kind}', f'{BENCH}/kinds.lua', {'kind': kind}, seed) for kind in kinds for seed in seeds]
    for words in SHIPPED:
        name, *defines = words.split()
        scenes.append(Scene(build, name, f'{BENCH}/../scenes/{name}.lua', dict(word.split('=') for word in defines)))
    for path in sorted(glob.glob(f'{BENCH}/../scenes/lab/*.lua')):
        with open(path, encoding='utf-8') as f:
            variants = re.findall(r'\bname = "([\w-]+)", row', f.read())
        name = os.path.basename(path)[:-4]
        scenes += [Scene(build, f'lab/{v}', path, {'variant': v}) for v in variants] or [Scene(build, f'lab/{name}', path, {})]
    return scenes


class Surface:
    """A body's distance from another place of it."""

    def __init__(self, body):
        size = [float(x) for x in body.size]
        self.round, self.axial = body.shape == 'sphere', body.shape in ('capsule', 'cylinder')
        self.radius = {'box': math.hypot(*size) / 2, 'sphere': size[0], 'capsule': size[0] + size[1] / 2,
                       'cylinder': math.hypot(size[0], size[1] / 2)}.get(body.shape, math.hypot(*size))

    def distance(self, p, q, p2, q2):
        moved = math.dist(p, p2)
        if self.round:
            return moved
        if self.axial: # a turn about the axis moves no surface
            return moved + self.radius * math.dist(axis(q), axis(q2))
        return moved + self.radius * 2 * math.sin(math.acos(min(1, abs(sum(a * b for a, b in zip(q, q2))))))


def axis(q):
    w, x, y, z = q
    return 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)


def judge(scene, knob, seconds, truth):
    """Errors (m) of all bodies in all seconds."""
    errors = []
    with scene.play(knob) as run, scene.play(('substeps', truth)) as true:
        surfaces = {o.id: Surface(o) for o in run if not (o.static or o.kinematic)}
        steps = round(1 / run.step_length)
        for _ in range(seconds):
            start, now = run.states(), true.states('id')
            kept = [i for i, id_ in enumerate(start['id']) if id_ in surfaces and id_ in set(now['id'])]
            true.set_states(start['id'][kept], *(start[what][kept] for what in ('position', 'attitude', 'velocity', 'angular_velocity')))
            run.step(steps)
            true.step(steps)
            a, b = run.states(), true.states()
            rows = {id_: i for i, id_ in enumerate(b['id'])}
            for i, id_ in enumerate(a['id']):
                if id_ in surfaces and id_ in rows:
                    k = rows[id_]
                    errors.append(surfaces[id_].distance(a['position'][i], a['attitude'][i], b['position'][k], b['attitude'][k]))
    return errors


def is_torn(scene, tolerance, seconds):
    """True if a strict run says one thing, and another with verify=on."""
    (plain, a), (verified, b) = (scene.run(('tolerance', tolerance), seconds, '--strict', '--set', f'verify={how}') for how in ('off', 'on'))
    if not a or not b:
        return plain != verified
    found = b['verified_steps'] > 0 and b['verified_share'] < 1
    return a['state_hash'] != b['state_hash'] or verified != max(plain, int(found))


class Verdict:
    """The regret of a tolerance in a scene, and what its report was worth."""

    def __init__(self, scene, tolerance, seconds, fixed, truth):
        self.scene, self.tolerance, self.failed, self.torn = scene, tolerance, False, fixed is None and is_torn(scene, tolerance, seconds)
        own = scene.report(('tolerance', tolerance), seconds, 3 if fixed else 1)
        try:
            errors = own and judge(scene, ('tolerance', tolerance), seconds, truth)
        except obsim.Error: # the truth takes more work than a step may
            errors = None
        if not errors:
            self.failed = True
            return
        self.seconds, self.wrong, self.worst = len(errors), sum(e > tolerance for e in errors), max(errors, default=0)
        self.alarm = own['unbounded_steps'] > 0 or own['islands_over'] > 0
        self.bounded = own['bounded_share']
        self.regret = self.lavish = 1
        self.beside = [0, 0]
        for n in (2**k for k in range(10 if fixed else 0)):
            cpu, errors = fixed(n)
            if cpu is None or cpu >= own['cpu_s']:
                break
            try:
                good = sum(e > tolerance for e in errors()) <= self.wrong
            except obsim.Error:
                continue
            if good and not self.beside[1]:
                self.lavish, self.beside[1] = own['cpu_s'] / cpu, n
            if good and max(errors(), default=0) <= max(self.worst, ERROR_FLOOR):
                self.regret, self.beside[0] = own['cpu_s'] / cpu, n
                break

    def line(self):
        if self.failed:
            return f'{self.scene.title:32} {1e3 * self.tolerance:6g} failed'
        return (f'{self.scene.title:32} {1e3 * self.tolerance:6g} {self.regret:7.2f} ({self.beside[0]:3}) {self.lavish:7.2f} '
                f'({self.beside[1]:3}) {self.wrong:4} of {self.seconds:<4} {1e3 * self.worst:9.3g} {100 * self.bounded:5.0f} % '
                f'{"false" if self.alarm and not self.wrong else "alarm" if self.alarm else "SILENT" if self.wrong else ""}'
                f'{" TORN" if self.torn else ""}')


def measure(scene, tolerances, most, truth, verdicts):
    """Verdicts of a scene; runs with a fixed number of substeps are shared."""
    known = {}
    def fixed(n):
        if n not in known:
            report, errors = scene.report(('substeps', n), most), []
            def judged():
                if not errors:
                    errors.append(judge(scene, ('substeps', n), most, truth))
                return errors[0]
            known[n] = (report and report['cpu_s'], judged)
        return known[n]
    return [Verdict(scene, tolerance, most, None if verdicts else fixed, truth) for tolerance in tolerances]


def summary(verdicts, tolerances):
    print(f'\n{"mm":>6} {"runs":>5} {"median":>7} {"90 %":>7} {"worst":>7}  {"alarms":>6} {"false":>6} {"seconds":>8} {"wrong":>6} '
          f'{"silent":>6}  worst scene')
    for tolerance in tolerances:
        of = [v for v in verdicts if v.tolerance == tolerance and not v.failed]
        if not of:
            continue
        regrets, worst = sorted(v.regret for v in of), max(of, key=lambda v: v.regret)
        alarms = [v for v in of if v.alarm]
        print(f'{1e3 * tolerance:6g} {len(of):5} {statistics.median(regrets):7.2f} {regrets[math.ceil(.9 * len(regrets)) - 1]:7.2f} '
              f'{regrets[-1]:7.2f}  {len(alarms):6} {sum(not v.wrong for v in alarms):6} {sum(v.seconds for v in of):8} '
              f'{sum(v.wrong for v in of):6} {sum(v.wrong for v in of if not v.alarm):6}  {worst.scene.title}')
    for v in sorted((v for v in verdicts if not v.failed and v.regret > 2), key=lambda v: -v.regret):
        print(f'above 2: {v.regret:.1f}, {v.scene.title} at {1e3 * v.tolerance:g} mm, beside {v.beside[0]} substeps')


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('build')
    p.add_argument('--scenes', default='kinds/*')
    p.add_argument('--seeds', default='1..2')
    p.add_argument('--tolerances', default='10,1,.1')
    p.add_argument('--seconds', type=int, default=3)
    p.add_argument('--judge', type=int, default=512)
    p.add_argument('--list', action='store_true')
    p.add_argument('--verdicts', action='store_true')
    a = p.parse_args()
    first, last = (int(x) for x in a.seeds.split('..'))
    tolerances = [1e-3 * float(t) for t in a.tolerances.split(',')]
    verdicts = []
    for scene in find_scenes(a.build, range(first, last + 1)):
        if not any(fnmatch.fnmatch(scene.name, wanted) for wanted in a.scenes.split(',')):
            continue
        for v in measure(scene, tolerances, a.seconds, a.judge, a.verdicts):
            verdicts.append(v)
            if a.list or v.failed:
                print(v.line(), flush=True)
    summary(verdicts, tolerances)
    torn = [v for v in verdicts if v.torn]
    for v in torn:
        print(f'two verdicts: {v.scene.title} at {1e3 * v.tolerance:g} mm')
    sys.exit(bool(torn))


if __name__ == '__main__':
    main()
