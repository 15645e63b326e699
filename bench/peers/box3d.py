#!/usr/bin/env python3
"""Measures falling boxes in Box3D beside obsim, at settings from coarse to fine: CPU against the deepest penetration.

box3d.py CHECKOUT OBSIM [N]    CHECKOUT: a clone of github.com/erincatto/box3d; N boxes, 1000 unless given

Builds Box3D's sources with gcc. Both engines get the same boxes, from obsim's scene, one thread, 10 s; each setting runs three times,
in turns. The penetration is what contacts had at any step: Box3D's own figure, obsim's of all pairs. Needs python3-numpy.
"""
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE, SCENE = ROOT / 'bench/peers', ROOT / 'scenes/falling_boxes.lua'
SECONDS, RUNS = 10, 3
BOX3D = ((60, 1), (60, 4), (120, 4), (240, 4), (480, 4), (960, 4))  # Hz, substeps
OBSIM = ('200mm', '50mm', '10mm', '1mm')


def boxes(obsim, n):
    """The scene's boxes as lines for box3d.c, and their friction."""
    sys.path.insert(0, str(ROOT / 'python'))
    import obsim as package  # pylint: disable=import-outside-toplevel
    with package.run(SCENE, n=n, program=obsim) as u:
        moving = [o for o in u if not o.static]
        lines = [(*o.size, *o.position, *o.attitude[[1, 2, 3, 0]], o.mass / (8 * o.size.prod())) for o in moving]
        return ''.join(' '.join(f'{x:.9g}' for x in line) + '\n' for line in lines), moving[0].friction


def build(checkout, program):
    sources = sorted(map(str, pathlib.Path(checkout, 'src').glob('*.c')))
    subprocess.run(['gcc', '-std=gnu17', '-O3', '-DNDEBUG', '-w', '-I', f'{checkout}/include', '-o', program, str(HERE / 'box3d.c'), *sources,
                    '-lm', '-lpthread'], check=True)


def run_box3d(program, text, friction, hz, substeps):
    done = subprocess.run([program, str(SECONDS * hz), str(hz), str(substeps), str(friction)], input=text, capture_output=True, text=True, check=True)
    return tuple(map(float, done.stdout.split()))


def run_obsim(obsim, n, tolerance):
    import json  # pylint: disable=import-outside-toplevel
    def report(*more):
        words = [obsim, 'run', SCENE, '-D', f'n={n}', '--duration', str(SECONDS), '--tolerance', tolerance, '--workers', '1', '--json', '-', *more]
        return json.loads(subprocess.run(words, capture_output=True, text=True, check=True).stdout)
    return report('--set', 'measure=end')['cpu_s'], report()['worst_penetration_m']


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    checkout, obsim, n = sys.argv[1], os.path.abspath(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 1000
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, 'box3d')
        build(checkout, program)
        text, friction = boxes(obsim, n)
        ways = {f'Box3D, {hz} Hz, {s} substeps': lambda hz=hz, s=s: run_box3d(program, text, friction, hz, s) for hz, s in BOX3D}
        ways |= {f'obsim, {t}': lambda t=t: run_obsim(obsim, n, t) for t in OBSIM}
        found = {name: [] for name in ways}
        for _ in range(RUNS):
            for name, way in ways.items():
                found[name].append(way())
    print(f'{n} falling boxes, {SECONDS} s, one thread, medians of {RUNS}\n{"":26} {"CPU, µs a box and second":>25} {"deepest, mm":>12}')
    for name, runs in found.items():
        print(f'{name:26} {1e6 * statistics.median(cpu for cpu, _ in runs) / (n * SECONDS):25.1f} {1e3 * max(d for _, d in runs):12.3g}')


if __name__ == '__main__':
    main()
