#!/usr/bin/env python3
"""The examples in C, beside a run that Python leads: a controller, a logger, a second renderer; and one in Python that learns.
Exit 77 without NumPy."""
import csv
import os
import runpy
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

try:
    import numpy
except ImportError:
    print('python3-numpy is not installed')
    sys.exit(77)

sys.path.append(os.path.join(os.path.dirname(__file__), '../run'))
import mcap

import obsim

SCENE = """scene { step = .01 }
ground { colour = "#808080" }
sphere { name = "ball", radius = .5, at = { 0, 0, .5 }, colour = "#ff0000" }
box { name = "box", size = { 1, 1, 1 }, at = { 3, 0, .5 }, colour = "#0000ff" }
"""


def example(name, *words, **more):
    return subprocess.Popen([os.path.join(os.environ['EXAMPLES'], name), *map(str, words)], stdout=subprocess.PIPE, **more)


class Learning(unittest.TestCase):
    def test_balance(self):
        """The policy keeps up all poles, from starts that it has not seen."""
        balance = runpy.run_path(os.path.join(os.path.dirname(__file__), '../../examples/balance.py'))
        self.assertTrue(balance['main']())

    def test_course(self):
        """The car drives a lap by its lidar and its camera, and touches no wall; its record opens as MCAP."""
        course = runpy.run_path(os.path.join(os.path.dirname(__file__), '../../examples/course.py'))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'lap.h5')
            with unittest.mock.patch('sys.argv', ['course.py', path]):
                self.assertTrue(course['main']())
            subprocess.run([os.environ['OBSIM'], 'export', path, path + '.mcap'], check=True, stdout=subprocess.DEVNULL)
            with open(path + '.mcap', 'rb') as f:
                found = mcap.messages(f.read())
        states, last = len(found['/poses']), found['/poses'][-1][0]
        self.assertGreater(last, 10)
        self.assertEqual(len(found['/eye/depth']), round(10 * last))
        self.assertEqual([len(m['ranges']) for _, _, m in found['/lidar']], [61] * len(found['/lidar']))
        self.assertGreater(len(found['/lidar']), states - 2)


class Examples(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.scene = os.path.join(folder.name, 'scene.lua')
        with open(self.scene, 'w', encoding='utf-8') as f:
            f.write(SCENE)

    def test_hover(self):
        name = f'hover-{os.getpid()}'
        with subprocess.Popen([os.environ['OBSIM'], 'control', self.scene, '--name', name], stdout=subprocess.PIPE, text=True) as run:
            run.stdout.readline()
            with example('hover', name, 2, text=True) as hover:
                said = hover.communicate(timeout=60)[0]
            self.assertEqual((hover.returncode, run.wait(60)), (0, 0))
        self.assertAlmostEqual(float(said.split()[-2]), 2, places=3)

    def test_logger(self):
        with obsim.run(self.scene) as u:
            u['ball'].velocity = 1, 0, 0
            with example('logger', u.universe_name, 20, text=True) as logger:
                lines = [logger.stdout.readline(), logger.stdout.readline()] # it has begun
                while logger.poll() is None:
                    u.step()
                lines += logger.stdout.read().splitlines()
            rows = list(csv.DictReader(lines))
            self.assertEqual(logger.returncode, 0)
            self.assertEqual({row['id'] for row in rows}, {'0', '1', '2'})
            ball = [(int(row['step']), float(row['x'])) for row in rows if row['id'] == '1']
            self.assertEqual(ball[0], (0, 0))
            self.assertGreaterEqual(ball[-1][0], 20)
            self.assertGreater(ball[-1][1], 0)

    def test_sketch(self):
        """The ball in the middle, the box beside it, ground and sky."""
        with obsim.run(self.scene) as u, example('sketch', u.universe_name, 0, -6, 2) as sketch:
            data = sketch.communicate(timeout=60)[0]
        head, _, pixels = data.partition(b' 255\n')
        self.assertEqual(head, b'P6 480 270')
        picture = numpy.frombuffer(pixels, numpy.uint8).reshape(270, 480, 3).astype(int)
        red, green, blue = numpy.moveaxis(picture, 2, 0)
        ball, box = (red > 60) & (green < 10), (blue > 60) & (green < 10)
        self.assertTrue(ball[115, 240] and box.sum() > 500, (picture[115, 240], box.sum()))
        self.assertAlmostEqual(numpy.nonzero(ball)[1].mean(), 240, delta=3)
        self.assertGreater(numpy.nonzero(box)[1].min(), 250)
        self.assertGreater(blue[0, 0], red[0, 0])

    def test_wrong(self):
        for name in 'watch', 'logger', 'sketch', 'hover':
            with example(name, stderr=subprocess.PIPE, text=True) as e:
                self.assertIn(f'{name}: usage: {name} NAME', e.communicate(timeout=60)[1])
            self.assertEqual(e.returncode, 1)


unittest.main()
