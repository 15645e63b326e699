#!/usr/bin/env python3
"""accuracy.py OBSIM FILE FOLDER [OPTION ...]: runs obsim lab with these options into FOLDER, and writes the results
into FILE: the tables between <!-- lab: NAME --> and <!-- end -->, and the diagrams that FILE shows from images/.

All cases run once at the engines' usual settings, for errors against targets, as errors are the same every time. obsim
also runs them at all settings of the audit. The cases with cost at equal error, and the one of late partners, are swept
and repeated (--repeats).

Results that FOLDER has already are not measured again. Needs an otherwise idle machine; it takes some twenty minutes,
and ten more for each repeat.
"""
import csv
import os
import re
import shutil
import subprocess
import sys


def read(name):
    with open(os.path.join(FOLDER, name), encoding='utf-8', newline='') as f:
        return f.read()


def results():
    return list(csv.DictReader(read('results.csv').splitlines()))


def machine():
    """Machine and commit of the measurement."""
    rows = results()
    cases, engines = len({r['case'] for r in rows}), len({r['engine'] for r in rows})
    return f"{len(rows)} runs of {cases} cases with {engines} engines; {rows[0]['machine']}; commit {rows[0]['commit']}.\n"


def rows():
    return read('rows.md')


def conserved():
    return read('conserved.md')


def audit():
    return read('audit.md')


def equal():
    return read('equal.md')


def failed():
    """Failed runs of other engines at their usual settings: a row for each case."""
    first = {}
    for r in results():  # each engine's settings are adjacent; the usual ones of others are the coarsest
        first.setdefault((r['engine'], r['case']), r)
    engines = list(dict.fromkeys(engine for engine, _ in first if not engine.startswith('obsim')))
    reasons = {key: r['reason'] for key, r in first.items() if key[0] in engines and r['reason']}
    if not reasons:
        return 'No other engine failed.\n' if engines else 'No other engine took part.\n'
    lines = [['Case', *engines], ['---'] * (1 + len(engines))]
    for case in dict.fromkeys(case for _, case in reasons):
        lines.append([f'`{case}`', *[reasons.get((engine, case), '') for engine in engines]])
    return ''.join('| ' + ' | '.join(line) + ' |\n' for line in lines)


def lab(*words):
    if subprocess.run([os.path.abspath(sys.argv[1]), 'lab', '--out', FOLDER, *words],
                      stdout=subprocess.DEVNULL, check=False).returncode != 0:
        sys.exit('obsim lab failed; the same command goes on where it stopped')


TABLES = {f.__name__: f for f in (machine, rows, conserved, audit, equal, failed)}


def refresh(path):
    with open(path, encoding='utf-8') as f:
        text = f.read()
    text = re.sub(r'(<!-- lab: (\w+) -->\n).*?(<!-- end -->)',
                  lambda m: m.group(1) + '\n' + TABLES[m.group(2)]() + '\n' + m.group(3), text, flags=re.S)
    with open(path, 'w', encoding='utf-8') as f:
        f.write(text)
    for image in sorted(set(re.findall(r'\((images/[\w.-]+)\)', text))):
        target = os.path.join(os.path.dirname(os.path.abspath(path)), image)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        shutil.copyfile(os.path.join(FOLDER, 'plots', os.path.basename(image)), target)


if len(sys.argv) < 4:
    sys.exit(__doc__)
FOLDER = sys.argv[3]
OPTIONS = sys.argv[4:]
ONCE = OPTIONS[:]
if '--repeats' in ONCE:
    at = ONCE.index('--repeats')
    del ONCE[at:at + 2]
lab('--sweep', 'none', *ONCE)
lab('--audit', *ONCE)
lab(*dict.fromkeys(r['case'] for r in csv.DictReader(read('equal.csv').splitlines())), 'lag', *OPTIONS)
refresh(sys.argv[2])
