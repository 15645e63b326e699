#!/usr/bin/env python3
"""Interrupts runs at random moments, resumes them in another configuration, and compares their ends; measures the cost
of a checkpoint.

resume.py OBSIM [--moments N] [--seed N] [--cost]

Each moment is one of a scene's steps; workers and isolation are random for both parts. Exit 1 if a run ends in other
bits.
"""
import argparse
import json
import os
import random
import subprocess
import sys
import tempfile

SCENES = {'falling_boxes': (['-D', 'n=40'], 2), 'pile': ([], .5), 'cradle': ([], 1), 'shapes': ([], 1.2), 'stack': ([], 1),
          'pyramid': ([], .5)}
WAYS = [['--isolation', i, '--workers', w] for i in ('thread', 'process') for w in ('1', '2', '3', 'objects')]
FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scenes')


def report(obsim, *words):
    done = subprocess.run([obsim, 'run', *map(str, words), '--set', 'measure=end', '--json', '-'], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}: {done.stderr}")
    return json.loads(done.stdout)


def moments(obsim, count, seed, file):
    chance, wrong, whole = random.Random(seed), 0, {}
    for i in range(count):
        name = chance.choice(list(SCENES))
        more, duration = SCENES[name]
        path = os.path.join(FOLDER, name + '.lua')
        if name not in whole:
            whole[name] = report(obsim, path, *more, '--duration', duration)
        end, first, second = whole[name], chance.choice(WAYS), chance.choice(WAYS)
        step = chance.randrange(1, end['steps'])
        report(obsim, path, *more, *first, '--duration', step * end['step'], '--checkpoint', file)
        same = report(obsim, '--resume', file, *second, '--duration', duration)['state_hash'] == end['state_hash']
        wrong += not same
        if not same:
            print(f"{name} at step {step}, {' '.join(first)}, then {' '.join(second)}: other bits")
    print(f'{count} moments, {wrong} wrong')
    return wrong


def cost(obsim, file):
    for n in 1000, 100000:
        words = [os.path.join(FOLDER, 'falling_boxes.lua'), '-D', f'n={n}', '--duration', .1]
        done = report(obsim, *words, '--checkpoint', file, '--set', f'every={1 / 60}')
        held = done['checkpoint_s'] / done['checkpoints']
        print(f"{n} boxes: {done['checkpoint_bytes']} bytes, {1e3 * held:.3g} ms held up each ({done['checkpoints']} written)")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('obsim')
    parser.add_argument('--moments', type=int, default=100)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--cost', action='store_true')
    a = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, 'run.ck')
        if a.cost:
            cost(a.obsim, file)
        elif moments(a.obsim, a.moments, a.seed, file):
            sys.exit(1)


main()
