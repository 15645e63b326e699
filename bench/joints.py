#!/usr/bin/env python3
"""joints.py OBSIM FILE FOLDER: runs obsim lab into FOLDER on mechanisms, with steps of each engine that become shorter
and shorter, and writes into FILE, between <!-- lab: joints --> and <!-- end -->, the CPU that each needs for an error.

Results that FOLDER has already are not measured again. Needs an otherwise idle machine; it takes some ten minutes.
"""
import csv
import os
import re
import subprocess
import sys

CASES = {'pendulum-90': 'Pendulum, 20 s', 'double-pendulum': 'Double pendulum, 4 s', 'top': 'Heavy top, 10 s', 'chain-100': 'Chain of 100, 2 s',
         'four-bar': 'Four-bar, 60 s', 'slider-crank': 'Slider-crank, 20 s'}
STEPS = 'substeps=1,2,4,8,16,32,64'
RUNS = [('obsim', 'tolerance=5mm,.5mm,.05mm'), ('ode-world,mujoco,mujoco-rk4', STEPS), ('ode-quick,bullet', STEPS + ',iterations=20,100')]
ENGINES = ['obsim', 'mujoco', 'mujoco-rk4', 'ode-world', 'ode-quick', 'bullet']
LEVELS = [1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10]
LIMIT = '40'  # s of CPU for a run


def error(row):
    """First figure of a run; nothing of one that failed."""
    return float(row['figure1'] or 'inf') if not row['reason'] else float('inf')


def cost(rows, level):
    """Least CPU (us per body and simulated second) with an error of at most "level"; None: never."""
    return min((1e6 * float(r['cpu_s_per_body_and_simulated_s']) for r in rows if error(r) <= level), default=None)


def table(results):
    lines = [['Case', 'at an error of', *ENGINES], ['---', *['--:'] * (1 + len(ENGINES))]]
    for case, title in CASES.items():
        for level in LEVELS:
            costs = [cost([r for r in results if (r['case'], r['engine']) == (case, engine)], level) for engine in ENGINES]
            best = min((c for c in costs if c), default=None)
            if best:
                lines.append([title, f'{level:g}'] + ['never' if not c else f'**{c:,.0f}**' if c == best else f'{c:,.0f}' for c in costs])
    return ''.join('| ' + ' | '.join(line) + ' |\n' for line in lines)


def main(obsim, path, folder):
    for engines, sweep in RUNS:
        words = [os.path.abspath(obsim), 'lab', *CASES, '--engines', engines, '--sweep', sweep, '--limit', LIMIT, '--out', folder]
        if subprocess.run(words, stdout=subprocess.DEVNULL, check=False).returncode != 0:
            sys.exit('obsim lab failed; the same command goes on where it stopped')
    with open(os.path.join(folder, 'results.csv'), encoding='utf-8', newline='') as f:
        results = list(csv.DictReader(f))
    with open(path, encoding='utf-8') as f:
        text = f.read()
    machine = f"{results[0]['machine']}; commit {results[0]['commit']}.\n\n"
    text = re.sub(r'(<!-- lab: joints -->\n).*?(<!-- end -->)', lambda m: m.group(1) + '\n' + machine + table(results) + '\n' + m.group(2),
                  text, flags=re.S)
    with open(path, 'w', encoding='utf-8') as f:
        f.write(text)


if len(sys.argv) != 4:
    sys.exit(__doc__)
main(*sys.argv[1:])
