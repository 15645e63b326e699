#!/usr/bin/env python3
"""compare.py A.csv B.csv: changes from A to B beyond the noise, in two files written by bench/run.py.

Other engines, whose code is the same, calibrate the machine: obsim's times are compared relative to the median change
of theirs. A change counts only if it exceeds the largest deviation of one of theirs. In addition, a time has changed if
the repeats show it (Mann and Whitney 1947, two-sided, at 1 %) and its median differs by more than 5 %. Memory has
changed if its median differs by more than 5 %; an error, equal in all repeats, if it more than doubles or halves.

Exit: 0 nothing became worse, 1 something did, 2 the files cannot be compared.
"""
import collections
import csv
import functools
import math
import statistics
import sys

LEVEL, LEAST = .01, .05  # for the test; for the medians
# Times, and quantities of the machine.
CONTROL = {'cpu': 'cpu', 'wall': 'wall', 'median step': 'wall', 'start-up': 'wall'}
NOISELESS = 1e-12  # errors below are round-off
PLAIN = {'bodies', 'steps', 'state', 'failed'}
PROFILE = ('part: ', 'count: ', 'function: ', 'cpu, timed', 'critical path')  # taken once, for information


def give_up(why):
    sys.stderr.write(f'{why}\n')
    sys.exit(2)


def read(path):
    """{(scene, engine, setting, knobs): {quantity: [values]}}"""
    rows = collections.defaultdict(lambda: collections.defaultdict(list))
    try:
        with open(path, encoding='utf-8', newline='') as f:
            for line in csv.DictReader(f):
                value = line['value'] if line['quantity'] in ('state', 'failed') else float(line['value'])
                rows[line['scene'], line['engine'], line['setting'], line['knobs']][line['quantity']].append(value)
    except (OSError, KeyError, TypeError, ValueError, csv.Error) as e:
        give_up(f'{path}: not a file of bench/run.py: {e}')
    return rows or give_up(f'{path}: no results')


@functools.cache
def ways(n, m, u):
    """Number of orders of n values among m others with u inverted pairs."""
    if u < 0 or (not n or not m) and u:
        return 0
    if not n or not m:
        return 1
    return ways(n - 1, m, u - m) + ways(n, m - 1, u)


def mann_whitney(a, b):
    """Two-sided p, exact; equal values count half to either side."""
    u = sum((x > y) + .5 * (x == y) for x in a for y in b)
    n, m = len(a), len(b)
    least = math.floor(min(u, n * m - u))
    return min(1., 2 * sum(ways(n, m, k) for k in range(least + 1)) / math.comb(n + m, n))


def of_machine(a, b, quantity):
    """Factor by which other engines' time has changed, and the largest deviation of one of them from it."""
    ratios = [statistics.median(b[k][quantity]) / statistics.median(a[k][quantity]) for k in a.keys() & b.keys()
              if not k[1].startswith('obsim') and a[k].get(quantity) and b[k].get(quantity)]
    factor = statistics.median(ratios) if ratios else 1.
    return factor, max((max(r / factor, factor / r) for r in ratios), default=1.)


def verdict(quantity, a, b, controls):
    """Ratio of medians, and True if that is a change."""
    old, new = abs(statistics.median(a)), abs(statistics.median(b))
    if quantity in CONTROL:
        factor, noise = controls[CONTROL[quantity]]
        ratio = new / old / factor if old > 0 else math.inf
        apart = max(ratio, 1 / ratio) > max(1 + LEAST, noise)
        return ratio, apart and mann_whitney(a, [v / factor for v in b]) < LEVEL
    ratio = new / old if old > 0 else math.inf
    if quantity == 'memory':
        return ratio, abs(ratio - 1) > LEAST
    if max(old, new) <= NOISELESS:
        return 1., False
    return ratio, not .5 <= ratio <= 2


def compare(a, b):
    """Number of obsim's quantities that became worse, and number compared."""
    controls = {q: of_machine(a, b, q) for q in ('cpu', 'wall')}
    for quantity, (factor, noise) in controls.items():
        print(f'machine: {quantity} of other engines is {factor:.3f} times what it was, '
              f'each within a factor of {noise:.3f}')
    counts = collections.Counter()
    for key in sorted(k for k in a.keys() & b.keys() if k[2] != 'pieces'):
        if not key[1].startswith('obsim'):
            continue
        name = ' '.join((*key[:2], f'({key[2]}; {key[3]})' if key[3] else f'({key[2]})'))
        counts['states'] += set(a[key].get('state', [])) != set(b[key].get('state', []))
        if 'failed' in b[key] and 'failed' not in a[key]:
            print(f"worse   {name} fails: {b[key]['failed'][0]}")
            counts['worse'] += 1
        for quantity in (q for q in a[key] if q in b[key] and q not in PLAIN and not q.startswith(PROFILE)):
            old, new = a[key][quantity], b[key][quantity]
            ratio, changed = verdict(quantity, old, new, controls)
            counts['compared'] += 1
            if changed:
                word = 'worse' if ratio > 1 else 'better'
                counts[word] += 1
                print(f'{word:7} {name} {quantity}: {statistics.median(old):.4g} -> {statistics.median(new):.4g}'
                      f' ({ratio:.3f} x)')
    print(f"{counts['compared']} quantities compared; obsim: {counts['worse']} worse, {counts['better']} better, "
          f"{counts['states']} runs end in other bits")
    return counts['worse'], counts['compared']


def main():
    if len(sys.argv) != 3 or sys.argv[1].startswith('-'):
        give_up('usage: compare.py A.csv B.csv')
    worse, compared = compare(read(sys.argv[1]), read(sys.argv[2]))
    if not compared:
        give_up(f'{sys.argv[1]} and {sys.argv[2]} have nothing in common')
    sys.exit(1 if worse else 0)


if __name__ == '__main__':
    main()
