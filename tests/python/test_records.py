#!/usr/bin/env python3
"""Records as NumPy arrays and pandas data frames. Exit 77 (skipped) without h5py or pandas."""
import os
import subprocess
import sys
import tempfile
import time
import unittest

try:
    import h5py # pylint: disable=unused-import
    import numpy
    import pandas # pylint: disable=unused-import
except ImportError as e:
    print(e)
    sys.exit(77)

import obsim
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

    def test_samples(self):
        """A record has the samples of sensors, of each step or of each that is recorded."""
        for every, kept, number in (1, 0, 300), (3, 20, 300):
            with open(self.path + '.lua', 'w', encoding='utf-8') as f:
                f.write(SCENE + f'record {{ every = {every} }}\n'
                        f'imu {{ on = "ball", name = "imu", rate = 600, noise = .1, keep = {kept} }}\n'
                        'lidar { on = "ball", name = "lidar", beams = 10, rate = 50, reach = 100, delay = .03, rotation = { axis = { 0, 1, 0 }, degrees = 60 } }')
            subprocess.run([os.environ['OBSIM'], 'run', self.path + '.lua', '--record', self.path], check=True, stdout=subprocess.DEVNULL)
            with Record(self.path) as r, obsim.run(self.path + '.lua', inside=True) as u:
                n = 0
                for _ in range(50):
                    u.step()
                    number_, time_, values = u.sensors['imu'].samples(after=n)
                    if u.steps % every == 0:
                        n = int(number_[-1])
                numbers, times, recorded = r.samples('imu')
                self.assertEqual(numbers.tolist(), list(range(1, len(numbers) + 1)))
                self.assertEqual(len(numbers), n)
                last = u.sensors['imu'].samples()
                both = numpy.intersect1d(numbers, last[0])
                numpy.testing.assert_array_equal(recorded[numpy.isin(numbers, both)], last[2][numpy.isin(last[0], both)])
                self.assertEqual(r.samples('lidar')[2].shape[1], 10)
                self.assertTrue(numpy.isfinite(r.samples('lidar')[2]).any())
                self.assertLessEqual(r.samples('lidar')[1].max(), .47 + 1e-9)
                with self.assertRaises(KeyError):
                    r.samples('radar')

    def test_given_path(self):
        """A record has the motion of a path that was given during the run."""
        scene, program, name = self.path + '.lua', os.environ['OBSIM'], f'records-{os.getpid()}'
        with open(scene, 'w', encoding='utf-8') as f:
            f.write('scene { step = .01 }\nbox { name = "lift", size = { 1, 1, .1 }, at = { 6, 0, 1 }, kind = "kinematic" }\n')
        words = [program, 'run', scene, '--record', self.path, '--duration', '1e6', '--pace', 'realtime', '--name', name]
        with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
            while name not in obsim.names():
                time.sleep(.01)
            subprocess.run([program, 'send', name, 'path', 'lift', '.3 6 0 2', '.6 6 1 2'], check=True)
            u = obsim.attach(name)
            while u.position.tolist() != [[6, 1, 2]]:
                time.sleep(.01)
            run.terminate()
        with Record(self.path) as r:
            way = r.position[:, 0]
            self.assertEqual((way[0].tolist(), way[-1].tolist()), ([6, 0, 1], [6, 1, 2]))
            begin = numpy.flatnonzero(way[:, 2] > 1)[0] - 1
            numpy.testing.assert_allclose(way[begin + 15], [6, 0, 1.5], atol=1e-6)
            numpy.testing.assert_allclose(way[begin + 45], [6, .5, 2], atol=1e-6)

    def test_wrong(self):
        path = self.path + '.other'
        with h5py.File(path, 'w'):
            pass
        with self.assertRaisesRegex(ValueError, 'expected an obsim record'):
            Record(path)


unittest.main()
