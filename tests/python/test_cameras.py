"""Cameras: depths against lidars whose beams pass through the middle of pixels, objects by their surfaces, the same pictures in all
ways to run. Exit 77 (skipped) without NumPy, or where nothing can be drawn."""
import math
import os
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy
except ImportError:
    print('python3-numpy is not installed')
    sys.exit(77)

import obsim

NONE = 0xffffffff
BLIND = {'__EGL_VENDOR_LIBRARY_FILENAMES': '/dev/null', '__EGL_VENDOR_LIBRARY_DIRS': '/dev/null'}  # as on a server without a driver


def scene(text):
    """A file that holds a scene."""
    f = tempfile.NamedTemporaryFile('w', suffix='.lua') # pylint: disable=consider-using-with # goes with the test
    f.write(text)
    f.flush()
    return f


def times(a, b):
    """Product of two quaternions."""
    (aw, ax, ay, az), (bw, bx, by, bz) = a, b
    return numpy.array([aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by,
                        aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw])


def rays(width, height, fov):
    """Directions through the middles of pixels in a camera's frame; the first component is 1."""
    up = math.tan(fov / 2)
    y = (1 - (numpy.arange(width) + .5) * 2 / width) * up * width / height
    z = (1 - (numpy.arange(height) + .5) * 2 / height) * up
    return numpy.stack([numpy.ones((height, width)), numpy.broadcast_to(y, (height, width)), numpy.broadcast_to(z[:, None], (height, width))], -1)


class Depths(unittest.TestCase):
    """A camera, and a lidar for each of many of its pixels."""

    WIDTH, HEIGHT, FOV = 96, 64, 66
    EYE = "at = { .1, .02, .05 }"

    def beams(self, own, pixels):
        """Lidars of one beam each, through the middles of pixels."""
        d = rays(self.WIDTH, self.HEIGHT, math.radians(self.FOV))
        for n, (row, column) in enumerate(pixels):
            x = d[row, column] / numpy.linalg.norm(d[row, column])
            turn = numpy.array([1 + x[0], 0, -x[2], x[1]]) # from the x axis to there, by the shortest way
            q = times(own, turn / numpy.linalg.norm(turn))
            yield f"lidar {{ on = 'car', name = 'beam{n}', {self.EYE}, q = {{ {', '.join(map(repr, q.tolist()))} }}, beams = 1, fan = 1, rate = RATE, reach = 400 }}"

    def compare(self, things, least, own=(1., 0., 0., 0.), car="static = true", rate=60, steps=1):
        """Depths differ from ranges by less than 1 % of a pixel's footprint on the surface. Returns the picture."""
        seed = numpy.random.default_rng(7)
        pixels = [(int(a), int(b)) for a, b in zip(seed.integers(0, self.HEIGHT, 500), seed.integers(0, self.WIDTH, 500))]
        text = '\n'.join(["scene { step = 1/60 }", f"box {{ name = 'car', size = {{ .05, .05, .05 }}, at = {{ 0, 0, 1 }}, {car} }}", things,
                          f"camera {{ on = 'car', name = 'eye', {self.EYE}, q = {{ {', '.join(map(repr, own))} }}, width = {self.WIDTH}, "
                          f"height = {self.HEIGHT}, fov = {self.FOV}, rate = {rate} }}", *self.beams(numpy.array(own), pixels)]).replace('RATE', str(rate))
        with scene(text) as f, obsim.run(f.name, inside=True) as u:
            u.step(steps)
            eye, sensors = u.sensors['eye'], u.sensors
            picture, d = eye.value, rays(self.WIDTH, self.HEIGHT, math.radians(self.FOV))
            met, off = 0, []
            for n, at in enumerate(pixels):
                beam = sensors[f'beam{n}']
                self.assertEqual(beam.time, eye.time)
                depth, expected = picture['depth'][at], beam.value[0] / numpy.linalg.norm(d[at])
                self.assertEqual(math.isinf(depth), picture['id'][at] == NONE)
                if math.isinf(expected) or depth * numpy.linalg.norm(d[at]) > 399:
                    off.append(0 if math.isinf(expected) and depth * numpy.linalg.norm(d[at]) > 399 else 1)
                    continue
                met += 1
                footprint = expected * 2 * math.tan(math.radians(self.FOV) / 2) / self.HEIGHT
                around = picture['depth'][max(at[0] - 1, 0):at[0] + 2, max(at[1] - 1, 0):at[1] + 2]
                off.append(abs(depth - expected) / max(footprint, numpy.median(numpy.abs(around[numpy.isfinite(around)] - depth))))
            self.assertGreater(met / len(pixels), least)
            self.assertLess(numpy.sort(off)[-3], 1e-2) # on an edge rounding decides which of two surfaces a pixel shows
            self.assertLess(numpy.mean(off), .02)
            return picture

    def test_plane(self):
        """Level and tilted ones, by a camera that is turned about all axes."""
        q = numpy.array([.9, .2, .3, .25])
        for ground in "ground {}", "plane { at = { 4, 0, 0 }, normal = { -1, .3, 1 } }":
            self.compare(ground, .3, own=tuple((q / numpy.linalg.norm(q)).tolist()))
            self.compare(ground, .3)

    def test_shapes(self):
        """All shapes, near and far, as large as the picture and as a pixel; and each pixel's object has its surface there."""
        things = """ground {}
            box { name = 'box', size = { 1, .6, 1.6 }, at = { 3, 1, .9 }, rotation = { axis = { 1, 2, 3 }, degrees = 40 }, static = true }
            sphere { name = 'ball', radius = .5, at = { 1.6, -.3, 1 }, static = true }
            sphere { name = 'far ball', radius = 3, at = { 40, 30, 3 }, static = true }
            capsule { radius = .2, length = .9, at = { 2.5, -1.9, 1.6 }, rotation = { axis = { 1, 0, 1 }, degrees = 50 }, static = true }
            cylinder { radius = .4, length = .8, at = { 5, 0, 2.5 }, rotation = { axis = { 1, .4, 0 }, degrees = 60 }, static = true }
            cylinder { radius = .5, length = .1, at = { 6, 3, .05 }, static = true }
            hull { points = { {1,0,0}, {-1,0,0}, {0,1,0}, {0,-1,0}, {0,0,1}, {0,0,-1} }, at = { 6, -4.6, 1 }, static = true }
            box { size = { .2, .2, .2 }, at = { 2, 0, 1 }, sensor = true, static = true }"""
        picture = self.compare(things, .5)
        d = rays(self.WIDTH, self.HEIGHT, math.radians(self.FOV))
        place = numpy.array([.1, .02, 1.05]) + d * numpy.where(numpy.isinf(picture['depth']), 0, picture['depth'])[..., None]
        for id_, distance in ((1, place[..., 2]), (3, numpy.linalg.norm(place - [1.6, -.3, 1], axis=-1) - .5),
                              (4, numpy.linalg.norm(place - [40, 30, 3], axis=-1) - 3)):
            mine = picture['id'] == id_
            self.assertGreater(mine.sum(), 30)
            self.assertLess(numpy.abs(distance[mine]).max(), 1e-4 * numpy.abs(place[mine]).max())
            self.assertGreater(numpy.abs(distance[~mine & (picture['id'] != NONE)]).min(), 1e-5)
        self.assertEqual(set(numpy.unique(picture['id'])) - {NONE}, {1, 2, 3, 4, 5, 6, 7, 8})
        self.assertGreater(int(picture['colour'][0, 0, 2]), int(picture['colour'][0, 0, 0])) # blue sky

    def test_terrain(self):
        """A heightfield, whose look has its triangles."""
        self.compare("""heightfield { size = { 24, 24 }, cells = { 30, 30 }, height = function(x, y) return .6 * math.sin(1.7 * x) * math.cos(y) - .4 end }
            sphere { radius = .4, at = { 3, 0, 1 }, static = true }""", .4)

    def test_between_steps(self):
        """On a body that flies and turns, at instants between steps, past others that fly."""
        self.compare("""ground {}
            sphere { radius = .3, at = { 2, 0, 1.5 }, velocity = { 0, 1, 2 } }
            box { size = { .5, .8, .4 }, at = { 3, 1, 2 }, velocity = { 1, -2, 3 }, spin = { 3, 1, 2 } }""", .3,
                     car="velocity = { 1, 0, 4 }, spin = { 1, .4, -.7 }, mass = 1", rate=47, steps=17)


class Ways(unittest.TestCase):
    """The same pictures on one machine, however it is run."""

    SCENE = """scene { step = 1/60, seed = 3, duration = 5 }
        ground {}
        for i = 1, 8 do box { name = 'box' .. i, size = { .3, .3, .3 }, at = { .4 * (i % 3) + 1, .1 * i, .35 * i }, spin = { i, 1, 1 } } end
        box { name = 'car', size = { .4, .3, .2 }, at = { 0, 0, .1 }, velocity = { .5, 0, 0 } }
        camera { on = 'car', name = 'eye', at = { .2, 0, .2 }, width = 81, height = 41, rate = 25, keep = 30 }
        camera { on = 'box4', name = 'late', width = 33, height = 9, rate = 90, delay = .05, keep = 100 }
        camera 'main' { eye = { 0, -4, 2 }, target = { 1, 0, 0 } }"""

    def read(self, u):
        return {name: tuple(a.tobytes() for a in s.samples()) for name, s in u.sensors.items()}

    def test_all_ways(self):
        """Threads, processes, contained ones, inside; beside kills; put back; resumed from a file."""
        with scene(self.SCENE) as f:
            with obsim.run(f.name, inside=True) as u:
                u.step(40)
                half = self.read(u)
                u.step(30)
                end = self.read(u)
                self.assertNotEqual(half, end)
                number, time_, _ = u.sensors['eye'].samples()
                self.assertEqual(number.tolist(), list(range(1, 30)))
                self.assertLess(numpy.abs(time_ - number / 25).max(), 1e-12)
                self.assertLessEqual(u.sensors['late'].time, u.time - .05 + 1e-12)
            for options in {'workers': 1}, {'workers': 3}, {'workers': 2, 'isolation': 'process'}, \
                    {'workers': 2, 'isolation': 'process', 'harden': True}:
                with self.subTest(options=options), obsim.run(f.name, options=options) as u:
                    start = u.snapshot()
                    u.step(20)
                    u.restore(start)
                    for n in 7, 1, 32:
                        u.step(n)
                    self.assertEqual(self.read(u), half)
                    if 'isolation' in options:
                        u.kill([u['box3'].id])
                    with tempfile.TemporaryDirectory() as folder:
                        u.save(folder + '/half.ck')
                        u.step(30)
                        self.assertEqual(u.deaths > 0, 'isolation' in options)
                        self.assertEqual(self.read(u), end)
                        with obsim.run(resume=folder + '/half.ck') as resumed:
                            self.assertEqual(self.read(resumed), half)
                            resumed.step(30)
                            self.assertEqual(self.read(resumed), end)

    def test_states_stay(self):
        """Cameras change no state, and one whose object is removed keeps its last picture."""
        ends = []
        for text in self.SCENE, '\n'.join(line for line in self.SCENE.splitlines() if 'camera { on' not in line):
            with scene(text) as f, obsim.run(f.name, inside=True) as u:
                u.step(90)
                ends.append(b''.join(a.tobytes() for a in u.states().values()))
                if 'camera { on' in text:
                    u['car'].remove()
                    before = u.sensors['eye'].time
                    u.step(20)
                    self.assertEqual(u.sensors['eye'].time, before)
                    self.assertGreater(u.sensors['late'].time, before)
        self.assertEqual(*ends)

    def test_batch(self):
        """Threads step universes with cameras in turns."""
        with scene(self.SCENE) as f, obsim.batch(f.name, 3, threads=2) as b, obsim.run(f.name, inside=True) as u:
            for _ in range(3):
                b.step(8)
            u.step(24)
            for each in b:
                self.assertEqual(self.read(each), self.read(u))


class Refusals(unittest.TestCase):
    """One clear line."""

    def test_blind(self):
        """A machine that cannot draw."""
        with scene("scene {} box { name = 'box', size = { 1, 1, 1 } } camera { on = 'box', name = 'eye' }") as f:
            done = subprocess.run([os.environ['OBSIM'], 'run', f.name, '--duration', '1'], capture_output=True, text=True, check=False,
                                  env={**os.environ, **BLIND})
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn('camera "eye": no way to draw off-screen', done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_scenes(self):
        """Bad input is refused with its place."""
        for line, words in {
                "camera { on = 'bxo' }": 'camera: unknown object "bxo", did you mean "box"?',
                "camera {}": 'camera.on',
                "camera { on = 'box', width = 0 }": 'camera.width',
                "camera { on = 'box', width = 4000, height = 4000 }": 'camera.height: expected at most 4194304 pixels, got 16000000',
                "camera { on = 'box', fov = 180 }": 'camera.fov',
                "camera { on = 'box', noise = 1 }": 'camera.noise: unknown field',
                "camera { on = 'box', eye = { 1, 1, 1 } }": 'camera.eye: unknown field',
                "for i = 1, 9 do camera { on = 'box', width = 2000, height = 2000 } end": '256 MiB',
        }.items():
            with self.subTest(line=line), scene("scene {} box { name = 'box', size = { 1, 1, 1 }, at = { 0, 0, 3 } }\n" + line) as f:
                done = subprocess.run([os.environ['OBSIM'], 'run', f.name, '--duration', '1'], capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 1 if 'MiB' in words else 2, done.stderr)
                self.assertIn(words, done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)


if __name__ == '__main__':
    try:
        with scene("scene {} box { name = 'box', size = { 1, 1, 1 } } camera { on = 'box', width = 1, height = 1 }") as able:
            obsim.run(able.name, inside=True).close()
    except obsim.Error as e:
        print(e)
        sys.exit(77)
    unittest.main()
