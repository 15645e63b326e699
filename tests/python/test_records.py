#!/usr/bin/env python3
"""Records as NumPy arrays and pandas data frames. Exit 77 (skipped) without h5py or pandas."""
import os
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py # pylint: disable=unused-import
    import numpy
    import pandas # pylint: disable=unused-import
except ImportError as e:
    print(e)
    sys.exit(77)

from obsim.records import Record

SCENE = """scene { duration = .5, step = .01 }
ground {}
sphere { name = "ball", radius = .1, at = { 0, 0, 9 }, velocity = { 2, 0, 0 } }
box { name = "guest", size = { 1, 1, 1 }, at = { 5, 5, .5 }, born = .1, dies = .3 }
"""


class Records(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        scene, self.path = os.path.join(folder.name, 'a.lua'), os.path.join(folder.name, 'a.h5')
        with open(scene, 'w', encoding='utf-8') as f:
            f.write(SCENE)
        subprocess.run([os.environ['OBSIM'], 'run', scene, '--record', self.path], check=True, stdout=subprocess.DEVNULL)

    def test_all(self):
        with Record(self.path) as r:
            self.assertEqual((r.position.shape, r.name), ((51, 3, 3), ['ground', 'ball', 'guest']))
            numpy.testing.assert_allclose(r.position[:, 1, 0], 2 * r.time, atol=1e-9)
            self.assertEqual(float(r.settings['step']), .01)
            frame = r.frame('position', 'velocity', 'asleep')
            ball = frame[frame.name == 'ball']
            self.assertEqual(len(ball), 51)
            numpy.testing.assert_allclose(ball.position_z, 9 - .5 * 9.81 * ball.time ** 2, atol=1e-6)
            numpy.testing.assert_allclose(ball.velocity_z, -9.81 * ball.time, atol=1e-6)
            guest = frame[frame.name == 'guest']
            self.assertAlmostEqual(guest.time.min(), .1)
            self.assertAlmostEqual(guest.time.max(), .29)
            events = r.events()
            self.assertEqual(events[events.name == 'guest'].what.tolist(), ['came', 'went'])

    def test_wrong(self):
        path = self.path + '.other'
        with h5py.File(path, 'w'):
            pass
        with self.assertRaisesRegex(ValueError, 'expected an obsim record'):
            Record(path)


unittest.main()
