#!/usr/bin/env python3
"""compare.py A.csv B.csv: what changed from A to B beyond the noise, of two files that bench/run.py wrote.

A time has changed when the repeats say so (Mann and Whitney 1947, two-sided, at 1 %) and its median differs by more than
5 %; memory, when its median does by more than 5 %; an error, which is the same in every repeat, when it is more than
twice as large, or less than half. Times of obsim are held against those of the other engines, which stand for the
machine: where those have all become slower by a tenth, so may obsim.

Exit: 0 nothing became worse, 1 something did, 2 the files cannot be compared.
"""
import collections
import csv
import functools
import math
import statistics
import sys

LEVEL, LEAST = .01, .05  # of the test; of the medians
TIMES = {'cpu', 'wall', 'median step', 'start-up'}
NOISELESS = 1e-12  # errors below are round-off
PLAIN = {'bodies', 'steps', 'state', 'failed'}
PROFILE = ('part: ', 'count: ', 'function: ', 'cpu, timed')  # taken once, for a look at them


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
    """Of n values among m others: the orders in which u pairs stand the other way round."""
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


def of_machine(a, b):
    """The factor by which other engines' CPU time has changed; 1 where no other was measured in both."""
    ratios = [statistics.median(b[k]['cpu']) / statistics.median(a[k]['cpu']) for k in a.keys() & b.keys()
              if not k[1].startswith('obsim') and a[k].get('cpu') and b[k].get('cpu')]
    return statistics.median(ratios) if ratios else 1.


def verdict(quantity, a, b, factor):
    """The ratio of medians, and whether that is a change."""
    old, new = statistics.median(a), statistics.median(b)
    if quantity not in TIMES and quantity != 'memory':
        old, new = abs(old), abs(new)
        if max(old, new) <= NOISELESS:
            return 1., False
        ratio = new / old if old > 0 else math.inf
        return ratio, not .5 <= ratio <= 2
    ratio = new / old if old > 0 else math.inf
    if quantity == 'memory':
        return ratio, abs(ratio - 1) > LEAST
    ratio /= factor
    changed = abs(ratio - 1) > LEAST and mann_whitney(a, [v / factor for v in b]) < LEVEL
    return ratio, changed


def compare(a, b):
    """How many quantities of obsim became worse, and how many were compared."""
    factor = of_machine(a, b)
    print(f'machine: other engines take {factor:.3f} times what they took')
    counts = collections.Counter()
    for key in sorted(k for k in a.keys() & b.keys() if k[2] != 'pieces'):
        ours = key[1].startswith('obsim')
        name = ' '.join((*key[:2], f'({key[2]}; {key[3]})' if key[3] else f'({key[2]})'))
        counts['states'] += ours and set(a[key].get('state', [])) != set(b[key].get('state', []))
        if ours and 'failed' in b[key] and 'failed' not in a[key]:
            print(f"worse   {name} fails: {b[key]['failed'][0]}")
            counts['worse'] += 1
        for quantity in (q for q in a[key] if q in b[key] and q not in PLAIN and not q.startswith(PROFILE)):
            old, new = a[key][quantity], b[key][quantity]
            ratio, changed = verdict(quantity, old, new, factor)
            counts['compared'] += 1
            if changed:
                word = ('worse' if ratio > 1 else 'better') if ours else 'other'
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
