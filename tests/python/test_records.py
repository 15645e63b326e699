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

sys.path.append(os.path.join(os.path.dirname(__file__), '../run'))
import mcap

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

    def test_led(self):
        """A run that a program leads is recorded as one that nobody leads; what is put back is recorded once."""
        with open(self.path + '.lua', 'w', encoding='utf-8') as f:
            f.write(SCENE + 'record { every = 3 }')
        subprocess.run([os.environ['OBSIM'], 'run', self.path + '.lua', '--record', self.path], check=True, stdout=subprocess.DEVNULL)
        for inside in False, True:
            led = self.path + f'.{inside}.h5'
            with obsim.run(self.path + '.lua', {'record': led}, inside=inside) as u:
                u.step(20)
                u.restore(u.snapshot())
                start = u.snapshot()
                u.step(10)
                u.restore(start)
                for n in 1, 2, 27:
                    u.step(n)
            with Record(self.path) as r, Record(led) as other:
                for name in 'time', 'step', 'position', 'velocity', 'asleep':
                    numpy.testing.assert_array_equal(getattr(r, name), getattr(other, name))

    def test_mcap(self):
        """MCAP has the samples of all sensors, with places and times; the same numbers as the record."""
        with open(self.path + '.lua', 'w', encoding='utf-8') as f:
            f.write(SCENE + """record { every = 5 }
                sphere { name = 'bob', radius = .1, at = { 2, 0, 3 } }
                hinge { 'bob', at = { 1.2, 0, 3 }, axis = { 0, 1, 0 }, name = 'pivot' }
                imu { on = "ball", name = "imu", rate = 60, keep = 9 }
                encoder { joint = "pivot", name = "angle", rate = 40, keep = 9 }
                lidar { on = "bob", name = "ring", beams = 12, rate = 20, reach = 9, rotation = { axis = { 0, 1, 0 }, degrees = 30 }, delay = .03 }
                lidar { on = "bob", name = "rows", beams = 20, rows = 3, rate = 20, reach = 9, rise = 60 }
                camera { on = "bob", name = "eye", at = { .1, 0, 0 }, width = 33, height = 20, rate = 20, rotation = { axis = { 0, 1, 0 }, degrees = 30 } }""")
        subprocess.run([os.environ['OBSIM'], 'run', self.path + '.lua', '--record', self.path], check=True, stdout=subprocess.DEVNULL)
        subprocess.run([os.environ['OBSIM'], 'export', self.path, self.path + '.mcap'], check=True, stdout=subprocess.DEVNULL)
        with open(self.path + '.mcap', 'rb') as f, Record(self.path) as r:
            found = mcap.messages(f.read())
            self.assertEqual(set(found), {'/scene', '/poses', '/imu', '/angle', '/ring', '/rows', *(f'/eye/{n}' for n in ('colour', 'depth', 'objects', 'calibration'))})
            times = lambda name: [t for _, t, _ in found['/' + name]]
            for name, topic, field in ('imu', 'imu', 'value'), ('angle', 'angle', 'value'), ('ring', 'ring', 'ranges'):
                _, when, values = r.samples(name)
                self.assertGreater(len(when), 5)
                numpy.testing.assert_allclose(times(topic), when, atol=1e-9)
                numpy.testing.assert_array_equal([m[field] for _, _, m in found['/' + topic]], values)
                for log, t, m in found['/' + topic]:
                    self.assertGreaterEqual(log, t - 1e-9)
                    self.assertAlmostEqual(m['timestamp']['seconds'] + 1e-9 * m['timestamp']['nanos'], t)
            scan = found['/ring'][0][2]
            self.assertEqual(scan['frame_id'], 'object/3')
            self.assertAlmostEqual(scan['end_angle'], numpy.pi - numpy.pi / 6)
            ranges = r.samples('rows')[2]
            for (_, _, cloud), each in zip(found['/rows'], ranges):
                points = numpy.frombuffer(cloud['data'], '<f4').reshape(-1, 3)
                numpy.testing.assert_allclose(numpy.linalg.norm(points, axis=1), each[numpy.isfinite(each)], rtol=1e-6)
                self.assertEqual([(p['name'], p['offset'], p['type']) for p in cloud['fields']], [('x', 0, 7), ('y', 4, 7), ('z', 8, 7)])
            _, when, pixels = r.samples('eye')
            self.assertEqual(pixels.shape, (10, 20, 33))
            for topic, kind, dtype in ('colour', 'rgb8', 'u1'), ('depth', '32FC1', '<f4'), ('objects', '16UC1', '<u2'):
                numpy.testing.assert_allclose(times('eye/' + topic), when, atol=1e-9)
                for (_, _, image), each in zip(found['/eye/' + topic], pixels):
                    self.assertEqual((image['frame_id'], image['width'], image['height'], image['encoding']), ('camera/eye', 33, 20, kind))
                    self.assertEqual(len(image['data']), image['step'] * 20)
                    mine = {'colour': each['colour'][..., :3], 'depth': each['depth'], 'objects': each['id'] & 0xffff}[topic]
                    numpy.testing.assert_array_equal(numpy.frombuffer(image['data'], dtype).reshape(mine.shape), mine)
            # the frame of the camera: a point that its depths and calibration give lies on the ground, as the ids say
            at = {t['child_frame_id']: t for _, _, m in found['/poses'][:1] for t in m['transforms']}
            self.assertEqual(at['camera/eye']['parent_frame_id'], 'object/3')
            f_, x0, y0 = (found['/eye/calibration'][0][2]['K'][k] for k in (0, 2, 5))
            row, column = numpy.argwhere(pixels[0]['id'] == 0)[-1]
            depth = float(pixels[0]['depth'][row, column])
            seen = numpy.array([(column + .5 - x0) / f_, (row + .5 - y0) / f_, 1]) * depth # x to the right, y down
            bob = [t for _, time_, m in found['/poses'] if abs(time_ - when[0]) < 1e-9 for t in m['transforms'] if t['child_frame_id'] == 'object/3'][0]
            for frame in at['camera/eye'], bob:
                q, p = frame['rotation'], frame['translation']
                u, w = numpy.array([q['x'], q['y'], q['z']]), q['w']
                seen = seen + 2 * numpy.cross(u, numpy.cross(u, seen) + w * seen) + [p['x'], p['y'], p['z']]
            self.assertLess(abs(seen[2]), 1e-3)

    def test_damaged_samples(self):
        """Sensors, samples and pixels that make no sense: one line, and no crash."""
        with open(self.path + '.lua', 'w', encoding='utf-8') as f:
            f.write(SCENE + """lidar { on = "ball", name = "ring", beams = 12, rate = 20 } imu { on = "ball", name = "imu" }
                camera { on = "ball", name = "eye", width = 7, height = 5, rate = 20 }""")
        subprocess.run([os.environ['OBSIM'], 'run', self.path + '.lua', '--record', self.path], check=True, stdout=subprocess.DEVNULL)

        def export(where, row, field, value):
            with h5py.File(self.path, 'r+') as f:
                rows = f[where][:]
                before = rows[field][row].copy()
                rows[field][row] = value
                f[where][:] = rows
            done = subprocess.run([os.environ['OBSIM'], 'export', self.path, self.path + '.mcap'], capture_output=True, text=True, check=False)
            with h5py.File(self.path, 'r+') as f:
                rows[field][row] = before
                f[where][:] = rows
            self.assertIn(done.returncode, (0, 1, 2), done.stderr)
            self.assertLessEqual(len(done.stderr.splitlines()), 1)
            return done
        with h5py.File(self.path, 'r') as f:
            picture = int(numpy.flatnonzero(f['samples']['sensor'] == 2)[0])
            sizes = {name: f[name].shape[0] for name in ('sensors', 'samples', 'pixels')}
        for where, row, field, value, words in (
                ('sensors', 0, 'kind', 6, 'a sensor makes no sense'), ('sensors', 0, 'width', 13, None), ('sensors', 0, 'width', 1 << 30, 'a sensor makes no sense'),
                ('sensors', 0, 'beams', 1 << 31, 'a sensor makes no sense'), ('sensors', 2, 'beams', 8, 'a sensor makes no sense'),
                ('sensors', 2, 'rows', 0, 'a sensor makes no sense'), ('sensors', 1, 'rate', numpy.nan, 'a sensor makes no sense'),
                ('sensors', 0, 'name', b'x' * 48, None), ('samples', 0, 'sensor', 3, 'its samples make no sense'),
                ('samples', 0, 'first', 6, 'its samples make no sense'), ('samples', 0, 'time', numpy.nan, '/samples cannot be read'),
                ('samples', picture, 'value', -1, 'its samples make no sense'), ('samples', picture, 'value', 1e300, 'its samples make no sense'),
                ('samples', picture, 'value', sizes['pixels'] - 34, 'its samples make no sense')):
            done = export(where, row, field, value)
            if words:
                self.assertEqual(done.returncode, 2 if where == 'sensors' else done.returncode or 2, (field, value, done.stderr))
                self.assertIn(words, done.stderr)
        random = numpy.random.default_rng(3)
        for _ in range(40):
            where = ('sensors', 'samples', 'pixels')[random.integers(3)]
            with h5py.File(self.path, 'r') as f:
                dtype = f[where].dtype
            field = dtype.names[random.integers(len(dtype.names))]
            row = int(random.integers(sizes[where]))
            value = numpy.frombuffer(random.bytes(dtype[field].itemsize), dtype[field])[0]
            export(where, row, field, value)

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
