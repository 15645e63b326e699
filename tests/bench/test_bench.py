"""test_bench.py BENCH BUILD: a tiny run writes its file; compare.py finds a planted change, ignores noise, and rejects
invalid files with one line; performance.py fills a page.
"""
import csv
import os
import random
import re
import statistics
import subprocess
import sys
import tempfile

BENCH, BUILD = sys.argv[1:3]
COLUMNS = ['date', 'commit', 'machine', 'scene', 'duration', 'engine', 'setting', 'knobs', 'repeat', 'quantity', 'unit',
           'value']


def call(script, *words):
    words = [sys.executable, os.path.join(BENCH, script), *words]
    return subprocess.run(words, capture_output=True, text=True, check=False)


def rows_of(path):
    with open(path, encoding='utf-8', newline='') as f:
        reader = csv.DictReader(f)
        assert reader.fieldnames == COLUMNS, reader.fieldnames
        return list(reader)


def test_run(folder):
    path = os.path.join(folder, 'tiny.csv')
    done = call('run.py', BUILD, '--mode', 'tiny', '--repeats', '3', '--out', path)
    assert done.returncode == 0, done.stderr
    rows = rows_of(path)
    sides = {(r['scene'], r['engine']) for r in rows}
    assert sides == {('stack-10', 'obsim'), ('stack-10', 'obsim 2 processes'), ('stack-10', 'ode-quick'),
                     ('falling-8', 'obsim')}, sides
    for scene, engine in sides:
        own = [r for r in rows if (r['scene'], r['engine']) == (scene, engine)]
        costs = [float(r['value']) for r in own if r['quantity'] == 'cpu']
        assert len(costs) == 3 and min(costs) > 0, own
        assert {r['repeat'] for r in own if r['quantity'] == 'wall'} == {'1', '2', '3'}
        assert len({r['value'] for r in own if r['quantity'] == 'state'}) == 1, 'repeats differ'
    assert all(r['commit'] and r['machine'] and r['date'] for r in rows)
    assert len({r['value'] for r in rows if r['scene'] == 'stack-10' and r['quantity'] == 'state'
                and r['engine'].startswith('obsim')}) == 1, 'the host ends in other bits'
    assert any(r['quantity'] == 'worst penetration' and r['unit'] == 'mm' and r['repeat'] == '0' for r in rows)
    done = call('run.py', BUILD, '--mode', 'tiny', '--out', path, '--scenes', 'no-such-scene')
    assert done.returncode == 2 and 'nothing has this name' in done.stderr, done.stderr
    only = ('--scenes', 'fall*', '--engines', 'obsim', '--repeats', '1')
    done = call('run.py', BUILD, '--mode', 'tiny', '--out', path, *only)
    assert done.returncode == 0 and {r['scene'] for r in rows_of(path)} == {'falling-8'}
    assert call('run.py', folder).returncode == 2


def test_document(folder):
    path, results = os.path.join(folder, 'page.md'), os.path.join(folder, 'tiny.csv')
    text = 'before\n<!-- performance: usual -->\nold\n<!-- end -->\nafter <!-- performance: promises -->\n<!-- end -->\n'
    with open(path, 'w', encoding='utf-8') as f:
        f.write(text)
    done = call('run.py', BUILD, '--mode', 'tiny', '--repeats', '1', '--out', results, '--document', path)
    assert done.returncode == 0, done.stderr
    for _ in range(2):  # written twice, it is the same
        done = call('performance.py', results, path)
        assert done.returncode == 0, done.stderr
        with open(path, encoding='utf-8') as f:
            page = f.read()
    assert page.startswith('before') and 'old' not in page and page.count('<!-- end -->') == 2, page
    assert re.search(r'\| stack-10, 0.2 s (\| [\d.]+ \([\d.e-]+\) ){2}\|  \|  \| worst penetration \|', page) and 'sparse 10,000' in page, page
    assert call('performance.py').returncode == 1


def write(path, seed, changes=(), failing=False):
    """Five repeats of made-up results, 2 % noise; changes: {(engine, quantity): factor}."""
    noise, changes = random.Random(seed), dict(changes)
    with open(path, 'w', encoding='utf-8', newline='') as f:
        out = csv.writer(f)
        out.writerow(COLUMNS)
        for scene in ('pile', 'sparse-10'):
            for engine in ('obsim', 'bullet', 'ode-quick'):
                head = ['2026-01-01', 'abc', 'here', scene, '', engine, 'usual', '']
                for repeat in range(1, 6):
                    for quantity in ('cpu', 'wall'):
                        value = 3 * changes.get((engine, quantity), 1) * noise.gauss(1, .02)
                        out.writerow([*head, repeat, quantity, 'us', value])
                out.writerow([*head, 0, 'worst penetration', 'mm', .5 * changes.get((engine, 'error'), 1)])
                if failing and engine == 'obsim':
                    out.writerow([*head, 5, 'failed', '', 'it fell'])


def compare(a, b, code, *texts):
    done = call('compare.py', a, b)
    assert done.returncode == code, (code, done.stdout, done.stderr)
    for text in texts:
        assert text in done.stdout + done.stderr, (text, done.stdout, done.stderr)
    return done


def test_compare(folder):
    a, b = os.path.join(folder, 'a.csv'), os.path.join(folder, 'b.csv')
    write(a, 1)
    for seed in range(2, 12):
        write(b, seed)
        compare(a, b, 0, '0 worse, 0 better')
    write(b, 2, {('obsim', 'cpu'): 1.15})
    assert compare(a, b, 1, '2 worse').stdout.count('worse   ') == 2
    compare(b, a, 0, '2 better')
    write(b, 3, {('obsim', 'error'): 3})
    compare(a, b, 1, 'worst penetration')
    write(b, 4, {(engine, q): 1.3 for engine in ('obsim', 'bullet', 'ode-quick') for q in ('cpu', 'wall')})
    compare(a, b, 0, '0 worse')  # the machine was slower
    write(b, 5, {('bullet', 'wall'): 2., ('obsim', 'wall'): 1.3, ('obsim', 'cpu'): 1.15})
    assert 'wall:' not in compare(a, b, 1, '2 worse').stdout  # the machine is too noisy to judge wall times
    write(b, 6, failing=True)
    compare(a, b, 1, 'it fell')


def test_bad_input(folder):
    good, bad = os.path.join(folder, 'a.csv'), os.path.join(folder, 'bad.csv')
    for text in (b'', b'\0\1\2', b'a,b\n1,2\n', ','.join(COLUMNS).encode() + b'\n',
                 ','.join(COLUMNS).encode() + b'\nd,c,m,s,,e,u,,1,cpu,us,fast\n', b'\xff\xfe\n'):
        with open(bad, 'wb') as f:
            f.write(text)
        done = compare(good, bad, 2, 'bad.csv')
        assert done.stderr.count('\n') == 1 and not done.stdout, done
    assert compare(good, os.path.join(folder, 'none'), 2).stderr.count('\n') == 1
    assert call('compare.py', good).returncode == 2


def test_p(_):
    """The test's p against tables: 5 against 5, apart: 2 / C(10, 5); 4 against 4: 2 / C(8, 4)."""
    sys.path.insert(0, BENCH)
    from compare import mann_whitney  # pylint: disable=import-outside-toplevel
    assert abs(mann_whitney([1, 2, 3, 4, 5], [6, 7, 8, 9, 10]) - 2 / 252) < 1e-12
    assert abs(mann_whitney([5, 6, 7, 8], [1, 2, 3, 4]) - 2 / 70) < 1e-12
    assert mann_whitney([1, 1, 1], [1, 1, 1]) > .5
    r = random.Random(1)
    p = [mann_whitney([r.random() for _ in range(5)], [r.random() for _ in range(5)]) for _ in range(2000)]
    assert statistics.mean(x < .01 for x in p) < .02


with tempfile.TemporaryDirectory() as place:
    for test in (test_run, test_document, test_compare, test_bad_input, test_p):
        test(place)
