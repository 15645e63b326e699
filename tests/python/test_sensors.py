"""Sensors: against closed forms, noise by its statistics, lidars against brute force, the same bits in all ways to run. Exit 77
(skipped) without NumPy."""
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

G = 9.81


def scene(text):
    """A file that holds a scene."""
    f = tempfile.NamedTemporaryFile('w', suffix='.lua') # pylint: disable=consider-using-with # goes with the test
    f.write(text)
    f.flush()
    return f


def samples(text, steps, *names, **named):
    """Times and values of sensors after so many steps of a scene."""
    with scene(text) as f, obsim.run(f.name, inside=True, **named) as u:
        u.step(steps)
        return [u.sensors[name].samples()[1:] for name in names]


def integrate(rate, x, times, step=2e-4):
    """States of x' = rate(x) at ascending times from 0 (Runge and Kutta, of order 4, extrapolated to order 5)."""
    def go(y, h):
        a = rate(y)
        b = rate(y + h / 2 * a)
        c = rate(y + h / 2 * b)
        return y + h / 6 * (a + 2 * b + 2 * c + rate(y + h * c))
    x, now, out = numpy.array(x, float), 0., []
    for t in times:
        n = max(1, math.ceil((t - now) / step))
        for _ in range(n):
            h = (t - now) / n
            two = go(go(x, h / 2), h / 2)
            x = two + (two - go(x, h)) / 15
        now = t
        out.append(x)
    return numpy.array(out)


def turn(q):
    """The matrix of a quaternion w, x, y, z."""
    w, x, y, z = q / numpy.linalg.norm(q)
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def about(axis, angle):
    """The same of a turn about one of x, y, z."""
    return turn(numpy.array([math.cos(angle / 2), *(math.sin(angle / 2) * numpy.eye(3)[axis])]))


def felt(r, w, change, arm, a=(0, 0, 0)):
    """An imu's values, from world vectors: rate, its change, arm, acceleration of the centre."""
    of_place = numpy.array(a) + numpy.cross(change, arm) + numpy.cross(w, numpy.cross(w, arm))
    return numpy.concatenate([r.T @ (of_place + [0, 0, G]), r.T @ w])


class ClosedForms(unittest.TestCase):
    """At instants between steps."""

    def close(self, got, expected, most):
        self.assertEqual(numpy.shape(got), numpy.shape(expected))
        self.assertLess(numpy.abs(got - expected).max(), most)

    def test_pendulum(self):
        """An imu off the centre and an encoder on a pendulum that is let go level, from the eighth step on."""
        arm, at = numpy.array([.05, .02, -.03]), numpy.array([.8, 0, -.6])
        (t, v), (times, values) = samples(f"""scene {{ step = 1/480, gravity = {{ 0, 0, -{G} }} }}
            sphere {{ name = 'bob', radius = .1, mass = 1, at = {{ .8, 0, -.6 }} }}
            hinge {{ 'bob', at = {{ 0, 0, 0 }}, axis = {{ 0, 1, 0 }}, name = 'pivot' }}
            imu {{ on = 'bob', name = 'imu', rate = 333, keep = 1000, at = {{ .05, .02, -.03 }} }}
            encoder {{ joint = 'pivot', name = 'encoder', rate = 777, keep = 2000 }}""", 480, 'imu', 'encoder')
        k = G / (1 + .4 * .1 ** 2)
        swing = lambda x: numpy.array([x[1], k * (.8 * math.cos(x[0]) - .6 * math.sin(x[0]))]) # about y; place: Ry(angle) at
        path = integrate(swing, (0, 0), t)
        expected = [felt(about(1, x), numpy.array([0, w, 0]), [0, swing((x, w))[1], 0], about(1, x) @ (at + arm)) for x, w in path]
        late = t > 8 / 480
        self.assertEqual(len(t), 333)
        self.close(v[late], numpy.array(expected)[late], 1e-9)
        self.close(t, numpy.arange(1, 334) / 333, 1e-15)
        late = times > 8 / 480
        self.close(values[late], integrate(swing, (0, 0), times)[late], 1e-9)

    def test_top_in_flight(self):
        """A box thrown with three moments of inertia: Euler's equations."""
        i = numpy.array([.3 ** 2 + .2 ** 2, .2 ** 2 + .5 ** 2, .5 ** 2 + .3 ** 2]) * 2 / 12
        (t, v), = samples(f"""scene {{ step = 1/60, gravity = {{ 0, 0, -{G} }} }}
            box {{ name = 'box', size = {{ .5, .3, .2 }}, mass = 2, at = {{ 0, 0, 50 }}, velocity = {{ 1, 2, 3 }}, spin = {{ 3, .2, -4 }} }}
            imu {{ on = 'box', name = 'imu', rate = 97, keep = 1000, at = {{ .1, -.2, .3 }} }}""", 60, 'imu')

        def rate(x):
            w = x[4:]
            q = .5 * numpy.array([-x[1:4] @ w, *(x[0] * w + numpy.cross(x[1:4], w))])
            return numpy.concatenate([q, numpy.cross(i * w, w) / i])
        path = integrate(rate, (1, 0, 0, 0, 3, .2, -4), t)
        arm = numpy.array([.1, -.2, .3])
        expected = []
        for x in path:
            r, w = turn(x[:4]), x[4:]
            expected.append(felt(r, r @ w, r @ rate(x)[4:], r @ arm, (0, 0, -G)))
        self.close(v, numpy.array(expected), 1e-9)

    def test_top_on_a_pivot(self):
        """Lagrange's top in steady precession."""
        m, radius, length, lean, precession = 1.5, .2, .1, .5, 6.
        c = m * radius ** 2 / 2
        a = m * (3 * radius ** 2 + length ** 2) / 12 + m * .3 ** 2
        spin = (a * precession ** 2 * math.cos(lean) + m * G * .3) / (c * precession) # about its axis, in all
        axis = about(1, lean) @ [0, 0, 1]
        own = spin - precession * math.cos(lean)
        w = precession * numpy.array([0, 0, 1]) + own * axis
        v = numpy.cross(w, .3 * axis)
        (t, got), = samples(f"""scene {{ step = 1/2000, gravity = {{ 0, 0, -{G} }} }}
            cylinder {{ name = 'top', radius = {radius}, length = {length}, mass = {m}, rotation = {{ axis = {{ 0, 1, 0 }},
                degrees = {math.degrees(lean)!r} }}, at = {{ {.3 * axis[0]!r}, 0, {.3 * axis[2]!r} }},
                velocity = {{ {v[0]!r}, {v[1]!r}, {v[2]!r} }}, spin = {{ {w[0]!r}, {w[1]!r}, {w[2]!r} }} }}
            ball {{ 'top', at = {{ 0, 0, 0 }} }}
            imu {{ on = 'top', name = 'imu', rate = 777, keep = 1000, at = {{ .1, 0, .05 }} }}""", 1000, 'imu')
        expected = []
        for x in t:
            r = about(2, precession * x) @ about(1, lean) @ about(2, own * x)
            e = r @ [0, 0, 1]
            w = precession * numpy.array([0, 0, 1]) + own * e
            expected.append(felt(r, w, numpy.cross([0, 0, precession], own * e), r @ [.1, 0, .35]))
        late = t > 8 / 2000
        self.close(got[late], numpy.array(expected)[late], 1e-9)

    def test_rest_and_path(self):
        """A body at rest feels its weight, one that goes round on a path is pulled inwards, each in the sensor's own frame."""
        (_, rests), (t, turns), (_, still) = samples(f"""scene {{ step = 1/60, gravity = {{ 0, 0, -{G} }} }}
            ground {{}}
            box {{ name = 'shelf', size = {{ 1, 1, 1 }}, at = {{ 9, 0, 9 }}, static = true }}
            box {{ name = 'box', size = {{ 1, 1, 1 }}, at = {{ 0, 0, .5 }} }}
            box {{ name = 'arm', size = {{ .1, .1, .1 }}, at = {{ 3, 0, 2 }}, kind = 'kinematic',
                path = {{ kind = 'circle', centre = {{ 1, 0, 2 }}, axis = {{ 0, 0, 1 }}, frequency = .7 }} }}
            imu {{ on = 'box', name = 'rests', rotation = {{ axis = {{ 1, 0, 0 }}, degrees = 90 }} }}
            imu {{ on = 'arm', name = 'turns', rate = 31, keep = 100 }}
            imu {{ on = 'shelf', name = 'still' }}""", 120, 'rests', 'turns', 'still')
        self.close(rests[-1], numpy.array([0, G, 0, 0, 0, 0]), 1e-9)
        self.close(still[-1], numpy.array([0, 0, G, 0, 0, 0]), 1e-12)
        f = 2 * math.pi * .7
        expected = numpy.array([(-2 * f * f * math.cos(f * x), -2 * f * f * math.sin(f * x), G, 0, 0, 0) for x in t])
        self.close(turns, expected, 1e-9)

    def test_hit(self):
        """A hit spoils no samples of later steps: the mean over its step, and the rest by the flight."""
        (t, v), = samples(f"""scene {{ step = 1/60, gravity = {{ 0, 0, -{G} }} }}
            ground {{ restitution = .5 }}
            sphere {{ name = 'ball', radius = .5, at = {{ 0, 0, 1.5 }}, restitution = .5 }}
            imu {{ on = 'ball', name = 'imu', rate = 500, keep = 1000 }}""", 60, 'imu')
        hit = math.sqrt(2 / G)
        for x, a in zip(t, v):
            if abs(x - hit) > 1 / 60:
                self.assertLess(numpy.abs(a).max(), 1e-9)


class Errors(unittest.TestCase):
    """Noise and delays. A test of a statistic fails by chance in one of 10^8 seeds, and the seed is fixed."""

    SIX = 5.73 # normal deviations beyond which a value lies with a probability of 1e-8

    @classmethod
    def setUpClass(cls):
        cls.n = 20000
        text = """scene { step = 1/50, seed = 5 }
            box { name = 'box', size = { 1, 1, 1 }, at = { 0, 0, .5 }, static = true }
            """ + '\n'.join(f"imu {{ on = 'box', name = '{name}', rate = 1000, keep = 20000, {fields} }}" for name, fields in {
                'white': 'noise = .3, gyro_noise = .02', 'walk': 'walk = .5', 'exact': '', 'late': 'noise = .3, delay = .137'}.items())
        text += '\n'.join(f"touch {{ on = 'box', name = 't{i}', bias = 2 }}" for i in range(400))
        cls.file = scene(text)
        cls.run_ = obsim.run(cls.file.name, inside=True)
        cls.run_.step(cls.n // 20)

    @classmethod
    def tearDownClass(cls):
        cls.run_.close()
        cls.file.close()

    def values(self, name):
        number, _, values = self.run_.sensors[name].samples()
        self.assertEqual(number.tolist(), list(range(1, self.n + 1)))
        return values

    def test_white(self):
        """Mean, deviation, no correlation at any of many lags or between values, a flat spectrum."""
        v = (self.values('white') - self.values('exact')) / [.3, .3, .3, .02, .02, .02]
        n = len(v)
        self.assertLess(numpy.abs(v.mean(0)).max(), self.SIX / math.sqrt(n))
        self.assertLess(numpy.abs(v.std(0) - 1).max(), self.SIX / math.sqrt(2 * n))
        self.assertLess(abs((v ** 4).mean() - 3), self.SIX * math.sqrt(96 / v.size)) # as that of a normal distribution
        for i in range(6):
            for lag in 1, 2, 3, 10, 100:
                self.assertLess(abs((v[lag:, i] * v[:-lag, i]).mean()), self.SIX / math.sqrt(n - lag))
            for j in range(i):
                self.assertLess(abs((v[:, i] * v[:, j]).mean()), self.SIX / math.sqrt(n))
        power = numpy.abs(numpy.fft.rfft(v, axis=0)[1:-1]) ** 2 / n # each exponential with the mean 1
        bands = power[:len(power) // 20 * 20].reshape(20, -1, 6).mean(1)
        self.assertLess(numpy.abs(bands - 1).max(), self.SIX / math.sqrt(len(power) // 20))

    def test_walk(self):
        """Increments of a random walk are white, with a deviation of .5 after a second; its spectrum falls with the square."""
        v = self.values('walk')[:, :3] - self.values('exact')[:, :3]
        d = numpy.diff(v, axis=0) / (.5 / math.sqrt(1000))
        self.assertLess(numpy.abs(d.mean(0)).max(), self.SIX / math.sqrt(len(d)))
        self.assertLess(numpy.abs(d.std(0) - 1).max(), self.SIX / math.sqrt(2 * len(d)))
        for lag in 1, 2, 4, 64:
            self.assertLess(numpy.abs((d[lag:] * d[:-lag]).mean(0)).max(), self.SIX / math.sqrt(len(d) - lag))
        self.assertLess(numpy.abs(v[0]).max(), self.SIX * .5 / math.sqrt(1000))
        bend = 4 * numpy.sin(numpy.pi * numpy.arange(1, 400) / len(d)) ** 2 # response of a sum of increments
        power = numpy.abs(numpy.fft.rfft(numpy.cumsum(d - d.mean(0), axis=0), axis=0)[1:400]) ** 2 * bend[:, None] / len(d)
        self.assertLess(numpy.abs(power.mean(0) - 1).max(), self.SIX / math.sqrt(len(power)))
        self.assertTrue((self.values('walk')[:, 3:] == self.values('exact')[:, 3:]).all())

    def test_bias(self):
        """Constant for each sensor, normal among sensors."""
        values = numpy.array([self.run_.sensors[f't{i}'].samples()[2] for i in range(400)])[..., 0]
        self.assertTrue((values == values[:, :1]).all())
        b = values[:, 0] / 2
        self.assertLess(abs(b.mean()), self.SIX / 20)
        self.assertLess(abs(b.std() - 1), self.SIX / math.sqrt(800))

    def test_delay(self):
        """A sample is read once its delay has passed; its noise is its own."""
        s = self.run_.sensors['late']
        number, time, _ = s.samples()
        self.assertEqual(number[-1], self.n - 137)
        self.assertEqual(s.time, time[-1])
        self.assertLess(abs(s.time - (self.run_.time - .137)), 1e-9)
        self.assertEqual(len(s.samples(after=int(number[-1]) - 5)[0]), 5)
        self.assertEqual(len(s.samples(most=7)[0]), 7)


class Loads(unittest.TestCase):
    """The weight of what stands."""

    STACK = f"""scene {{ step = 1/60, gravity = {{ 0, 0, -{G} }}, duration = 9 }}
        box {{ name = 'floor', size = {{ 3, 3, .2 }}, at = {{ 0, 0, -.1 }}, static = true }}
        box {{ name = 'plate', size = {{ 1, 1, .1 }}, at = {{ 0, 0, 1.05 }}, mass = 2, rotation = {{ axis = {{ 0, 0, 1 }}, degrees = 30 }} }}
        fixed {{ 'plate', name = 'post', at = {{ .3, 0, 1 }} }}
        for i = 0, 4 do box {{ name = 'on' .. i, size = {{ .4, .4, .2 }}, at = {{ .1, 0, 1.2 + .2 * i }}, mass = 1 + .1 * i }} end
        for i = 0, 4 do box {{ name = 'below' .. i, size = {{ .4, .4, .2 }}, at = {{ 1.2, 0, .1 + .2 * i }}, mass = 1 + .1 * i }} end
        force_torque {{ joint = 'post', name = 'scale' }}
        touch {{ on = 'floor', name = 'floor' }}
        touch {{ on = 'below0', name = 'lowest' }}
        touch {{ on = 'plate', name = 'plate', rate = 240 }}
        touch {{ on = 'below4', name = 'highest' }}"""

    def test_weight(self):
        """A stack is weighed to a millionth, solved and asleep: by the joint that holds its plate, and by touch."""
        with scene(self.STACK) as f, obsim.run(f.name, inside=True) as u:
            for steps in 90, 400:
                u.step(steps)
                read = {name: s.value for name, s in u.sensors.items()}
                weight = 6 * G
                load = read['scale']
                self.assertLess(abs(load[2] / (weight + 2 * G) - 1), 1e-6)
                self.assertLess(numpy.abs(load[:2]).max(), 1e-5 * weight)
                torque = .3 * 2 * G + .2 * weight # about y, through the post; the frame is the world's
                self.assertLess(numpy.abs(load[3:] - [0, torque, 0]).max(), 1e-5 * weight)
                self.assertLess(abs(read['plate'][0] / weight - 1), 1e-6)
                self.assertLess(abs(read['floor'][0] / weight - 1), 1e-6)
                self.assertLess(abs(read['lowest'][0] / (2 * weight - G) - 1), 1e-6) # from below and from above
                self.assertLess(abs(read['highest'][0] / (1.4 * G) - 1), 1e-6)

    def test_frame(self):
        """On a beam that turns: centripetal force and torque in the joint's own frame."""
        (_, v), = samples("""scene { step = 1/500, gravity = { 0, 0, 0 } }
            box { name = 'hub', size = { .1, .1, .1 }, at = { 0, 0, 0 }, kind = 'kinematic', spin = { 0, 0, 3 } }
            sphere { name = 'bob', radius = .1, mass = 2, at = { 1, 0, .5 }, velocity = { 0, 3, 0 }, spin = { 0, 0, 3 } }
            fixed { 'bob', 'hub', at = { .5, 0, 0 }, name = 'arm' }
            force_torque { joint = 'arm', name = 'ft', rate = 170, keep = 1000 }""", 500, 'ft')
        inward = 2 * 3 ** 2 * 1.
        self.assertLess(numpy.abs(v - [-inward, 0, 0, 0, -.5 * inward, 0]).max(), .01 * inward) # mean over a step, whose frame turns


def sphere(p, at, r):
    """Distances of points from a shape: below 0 inside; those of hulls are bounds."""
    return numpy.linalg.norm(p - at, axis=-1) - r


def box(p, at, half, r):
    """The same of a box with the attitude r."""
    q = numpy.abs((p - at) @ r) - half
    return numpy.linalg.norm(numpy.maximum(q, 0), axis=-1) + numpy.minimum(q.max(-1), 0)


def capsule(p, at, r, half):
    """The same of an upright one."""
    q = p - at
    return numpy.linalg.norm(q - numpy.clip(q[..., 2:], -half, half) * [0, 0, 1], axis=-1) - r


def cylinder(p, at, r, half):
    """The same of an upright one."""
    q = p - at
    d = numpy.stack([numpy.hypot(q[..., 0], q[..., 1]) - r, numpy.abs(q[..., 2]) - half], -1)
    return numpy.linalg.norm(numpy.maximum(d, 0), axis=-1) + numpy.minimum(d.max(-1), 0)


def march(distance, p, d, reach):
    """Distance along rays to where it is 0: goes on by as much as there is nothing (Hart 1996). infinity: none within reach."""
    t, goes = numpy.zeros(len(d)), numpy.arange(len(d))
    for _ in range(10000):
        gap = distance(p + t[goes, None] * d[goes])
        t[goes] += gap
        goes = goes[(t[goes] < reach) & (gap > 1e-13)]
    t[goes] = numpy.nan
    return numpy.where(t >= reach, numpy.inf, t)


def triangles(p, d, corners):
    """Distance along each ray to the nearest triangle that faces it, among all (Moeller and Trumbore 1997)."""
    best = numpy.full(len(d), numpy.inf)
    for a, b, c in corners:
        across = numpy.cross(d, c - a)
        det = across @ (b - a)
        side = numpy.cross(p - a, b - a)
        with numpy.errstate(divide='ignore', invalid='ignore'):
            u, v, t = across @ (p - a) / det, d @ side / det, side @ (c - a) / det
            best = numpy.where((det > 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0), numpy.minimum(best, t), best)
    return best


class Lidar(unittest.TestCase):
    """Against brute force, all beams against all surfaces."""

    def beams(self, s, r):
        """Directions in the world of a lidar with the attitude r."""
        rows, beams = s.shape if len(s.shape) > 1 else (1, s.shape[0])
        rise = numpy.linspace(-.5, .5, rows) if rows > 1 else numpy.zeros(1)
        up, round_ = numpy.meshgrid(rise, s.angles, indexing='ij')
        self.assertEqual(up.shape, (rows, beams))
        return numpy.stack([numpy.cos(up) * numpy.cos(round_), numpy.cos(up) * numpy.sin(round_), numpy.sin(up)], -1).reshape(-1, 3) @ r.T

    def compare(self, got, expected):
        self.assertEqual(numpy.isnan(expected).sum(), 0)
        self.assertTrue((numpy.isinf(got) == numpy.isinf(expected)).all())
        near = numpy.isfinite(expected)
        self.assertLess(numpy.abs(got[near] - expected[near]).max(), 1e-9)
        return near.mean()

    def test_shapes(self):
        """10,000 beams and more, on all shapes."""
        r, tilted = about(2, .3) @ about(0, .1), about(1, .7)
        planes = numpy.array([[1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1], [-1, 1, 1], [-1, 1, -1], [-1, -1, 1], [-1, -1, -1]]) / 3 ** .5
        q = numpy.array([math.cos(.05), math.sin(.05), 0, 0])
        z = numpy.array([math.cos(.15), 0, 0, math.sin(.15)])
        q = numpy.array([z[0] * q[0], z[0] * q[1], z[3] * q[1], z[3] * q[0]])
        text = f"""scene {{ step = 1/60 }}
            ground {{}}
            box {{ name = 'car', size = {{ .4, .3, .2 }}, at = {{ 0, 0, 1 }}, static = true, q = {{ {', '.join(map(repr, q))} }} }}
            sphere {{ radius = .5, at = {{ 0, 4, 1.5 }}, static = true }}
            capsule {{ radius = .3, length = 1.4, at = {{ -4, .5, 1 }}, static = true }}
            cylinder {{ radius = .4, length = 1.2, at = {{ -3, -3, .6 }}, static = true }}
            box {{ size = {{ .6, 1, 1.4 }}, at = {{ 4, -1, 1 }}, static = true, rotation = {{ axis = {{ 0, 1, 0 }}, degrees = {math.degrees(.7)!r} }} }}
            box {{ size = {{ .1, 30, .1 }}, at = {{ -1, 0, 2.5 }}, static = true }}
            hull {{ points = {{ {{1,0,0}}, {{-1,0,0}}, {{0,1,0}}, {{0,-1,0}}, {{0,0,1}}, {{0,0,-1}} }}, at = {{ 1, -4, 1.1 }}, static = true }}
            compound {{ parts = {{ {{ size = {{ .4, .4, .4 }} }}, {{ radius = .3, at = {{ .1, 0, .8 }} }} }}, name = 'two',
                at = {{ 3, 3, 1 }}, static = true }}
            box {{ name = 'door', size = {{ 1, 1, 1 }}, at = {{ 1.2, 0, 1 }}, sensor = true, static = true }}
            lidar {{ on = 'car', name = 'ring', beams = 4000, at = {{ .1, .2, .3 }}, reach = 20 }}
            lidar {{ on = 'car', name = 'rows', beams = 256, rows = 16, fan = 300, rise = {math.degrees(1.)!r}, reach = 6 }}
            lidar {{ on = 'car', name = 'down', beams = 4001, fan = 180, rotation = {{ axis = {{ 1, 0, 0 }}, degrees = 90 }}, reach = 50 }}
            lidar {{ on = 'two', name = 'one', beams = 1, reach = 50 }}"""
        def distance(p):
            two = p - [3, 3, 1]
            return numpy.min([p[..., 2], sphere(p, [0, 4, 1.5], .5), capsule(p, [-4, .5, 1], .3, .7), cylinder(p, [-3, -3, .6], .4, .6),
                              box(p, [4, -1, 1], [.3, .5, .7], tilted), box(p, [-1, 0, 2.5], [.05, 15, .05], numpy.eye(3)),
                              ((p - [1, -4, 1.1]) @ planes.T).max(-1) - 3 ** -.5,
                              box(two, [0, 0, 0], [.2, .2, .2], numpy.eye(3)), sphere(two, [.1, 0, .8], .3)], 0)
        with scene(text) as f, obsim.run(f.name, inside=True) as u:
            u.step(1)
            self.assertEqual(sum(s._passport.width for s in u.sensors.values()), 4000 + 4096 + 4001 + 1)
            self.assertEqual(u.sensors['one'].value[0], math.inf) # from its parts' origin, inside of the part that it is on
            for name, place, own, reach in (('ring', [.1, .2, .3], numpy.eye(3), 20), ('rows', [0, 0, 0], numpy.eye(3), 6),
                                            ('down', [0, 0, 0], about(0, math.pi / 2), 50)):
                s = u.sensors[name]
                p = numpy.array([0, 0, 1]) + r @ place
                share = self.compare(s.value.ravel(), march(distance, p, self.beams(s, r @ own), reach))
                self.assertGreater(share, .2)

    def test_terrain(self):
        """Ridges: both halves of a cell lie in one plane, so triangles are known."""
        n, size = 24, 12.
        height = lambda x: .6 * math.sin(1.7 * x)
        with scene(f"""scene {{ step = 1/60 }}
            heightfield {{ size = {{ {size}, {size} }}, cells = {{ {n}, {n} }}, height = function(x, y) return .6 * math.sin(1.7 * x) end }}
            box {{ name = 'car', size = {{ .1, .1, .1 }}, at = {{ .3, .4, .9 }}, static = true }}
            lidar {{ on = 'car', name = 'lidar', beams = 1000, rows = 4, rise = 60, reach = 9 }}""") as f, obsim.run(f.name, inside=True) as u:
            u.step(1)
            s = u.sensors['lidar']
            up, round_ = numpy.meshgrid(numpy.radians(numpy.linspace(-30, 30, 4)), s.angles, indexing='ij')
            d = numpy.stack([numpy.cos(up) * numpy.cos(round_), numpy.cos(up) * numpy.sin(round_), numpy.sin(up)], -1).reshape(-1, 3)
            x = (numpy.arange(n + 1) / n - .5) * size
            strips = [numpy.array([[x[i], -size / 2, height(x[i])], [x[i + 1], -size / 2, height(x[i + 1])],
                                   [x[i + 1], size / 2, height(x[i + 1])], [x[i], size / 2, height(x[i])]]) for i in range(n)]
            corners = [c[k] for c in strips for k in ([0, 1, 2], [0, 2, 3])]
            expected = triangles(numpy.array([.3, .4, .9]), d, corners)
            expected[expected > 9] = numpy.inf
            self.assertGreater(self.compare(s.value.ravel(), expected), .3)


class SameBits(unittest.TestCase):
    """Samples, noise and all, in all ways to run."""

    SCENE = """scene { step = 1/60, seed = 3, room = 4, duration = 5 }
        ground {}
        for i = 1, 12 do box { name = 'box' .. i, size = { .3, .3, .3 }, at = { .4 * (i % 3), .1 * i, .35 * i }, spin = { i, 1, 1 } } end
        sphere { name = 'bob', radius = .1, at = { 2, 0, 3 } }
        hinge { 'bob', at = { 1.2, 0, 3 }, axis = { 0, 1, 0 }, name = 'pivot' }
        capsule { name = 'arm', radius = .1, length = .5, at = { -2, 0, .4 } }
        hinge { 'arm', 'box1', at = { -1.8, 0, .5 }, axis = { 0, 1, 0 }, name = 'elbow' }
        for i = 1, 12, 3 do
            imu { on = 'box' .. i, rate = 170 * i, noise = .1, bias = .2, walk = .3, gyro_walk = .1, keep = 300 }
            touch { on = 'box' .. i, noise = .01, keep = 100 }
        end
        imu { on = 'bob', name = 'bob', rate = 333, noise = .1, delay = .05, keep = 500 }
        encoder { joint = 'pivot', name = 'pivot', rate = 1000, rate_noise = .1, keep = 900 }
        encoder { joint = 'elbow', rate = 37, keep = 30 }
        force_torque { joint = 'pivot', walk = .1, torque_noise = .2, keep = 50 }
        lidar { on = 'bob', name = 'lidar', beams = 500, rows = 3, rate = 20, noise = .01, keep = 10 }
        lidar { on = 'box12', beams = 60, rate = 200, delay = .03, keep = 100 }"""

    def read(self, u):
        return {name: tuple(a.tobytes() for a in s.samples()) for name, s in u.sensors.items()}

    def test_all_ways(self):
        """Threads, processes, contained ones, a worker for each object, inside; beside kills; put back; resumed from a file."""
        with scene(self.SCENE) as f:
            with obsim.run(f.name, inside=True) as u:
                u.step(100)
                half = self.read(u)
                u.step(80)
                end = self.read(u)
                self.assertNotEqual(half, end)
            with obsim.run(f.name, inside=True, options={'seed': 4}) as u:
                u.step(100)
                self.assertNotEqual(self.read(u)['lidar'], half['lidar'])
            ways = [{'workers': 1}, {'workers': 3}, {'workers': 'objects'}, {'workers': 2, 'isolation': 'process'},
                    {'workers': 'objects', 'isolation': 'process'}, {'workers': 2, 'isolation': 'process', 'harden': True}]
            for options in ways:
                with self.subTest(options=options), obsim.run(f.name, options=options) as u:
                    start = u.snapshot()
                    u.step(30)
                    u.restore(start)
                    u.step(100)
                    self.assertEqual(self.read(u), half)
                    if 'isolation' in options:
                        u.kill([u['box3'].id])
                    with tempfile.TemporaryDirectory() as folder:
                        u.save(folder + '/half.ck')
                        u.step(80)
                        self.assertEqual(u.deaths > 0, 'isolation' in options)
                        self.assertEqual(self.read(u), end)
                        with obsim.run(resume=folder + '/half.ck') as resumed:
                            self.assertEqual(self.read(resumed), half)
                            resumed.step(80)
                            self.assertEqual(self.read(resumed), end)

    def test_states_stay(self):
        """Sensors change no state."""
        ends = []
        for text in self.SCENE, self.SCENE[:self.SCENE.index('for i = 1, 12, 3')]:
            with scene(text) as f, obsim.run(f.name, inside=True) as u:
                u.step(120)
                ends.append(b''.join(a.tobytes() for a in u.states().values()))
        self.assertEqual(*ends)

    def test_one_ode_world(self):
        """There, too, sensors are read."""
        text = self.SCENE.replace("lidar { on = 'box12'", "lidar { name = 'last', on = 'box12'")
        with scene(text) as f, obsim.run(f.name, options={'arch': 'monolith'}) as u:
            u.step(120)
            for s in u.sensors.values():
                self.assertGreater(len(s.samples()[0]), 0)
            self.assertTrue(numpy.isfinite(u.sensors['bob'].value).all())

    def test_gone(self):
        """A sensor whose object or joint is removed keeps its last sample."""
        with scene(self.SCENE) as f, obsim.run(f.name, inside=True) as u:
            u.step(10)
            imu, joint = u.sensors['bob'], u.sensors['pivot']
            u.unjoin([u.joints['pivot']])
            before = joint.time
            u.step(10)
            self.assertEqual(joint.time, before)
            self.assertGreater(imu.time, before)
            u['bob'].remove()
            u.step(4) # the delay
            before = imu.time
            u.step(10)
            self.assertEqual(imu.time, before)


class Scripts(unittest.TestCase):
    """Scripts read sensors, as programs do."""

    def test_sense(self):
        """The newest values that no delay hides, and their time, in each way to run."""
        text = """scene { step = 1/60 }
            script('feels', [[
                function on_step()
                    local v, t = sense('lidar')
                    assert(not sense('none'))
                    if v then self:force(#v, v[1], t) end
                end]])
            ground {}
            box { name = 'box', size = { 1, 1, 1 }, at = { 0, 0, 5 }, script = 'feels' }
            lidar { on = 'box', name = 'lidar', beams = 3, fan = 60, rotation = { axis = { 0, 1, 0 }, degrees = 90 },
                noise = .01, delay = .03, rate = 100 }"""
        for options in {'workers': 1}, {'workers': 2, 'isolation': 'process', 'harden': True}:
            with scene(text) as f, obsim.run(f.name, options=options) as u:
                u.step(9)
                s = u.sensors['lidar']
                expected = (3, s.value[0], s.time)
                u.step(1)
                self.assertEqual(tuple(u['box'].force), expected)


class Refusals(unittest.TestCase):
    """One clear line."""

    def test_scenes(self):
        """Bad input is refused with its place."""
        start = """scene {}
            box { name = 'box', size = { 1, 1, 1 }, at = { 0, 0, 3 } }
            sphere { name = 'late', radius = .1, born = 1, at = { 4, 4, 4 } }
            hinge { 'box', at = { 0, 0, 0 }, axis = { 0, 0, 1 }, name = 'pivot' }
            fixed { 'box', at = { 0, 0, 0 }, name = 'weld' }
            imu { on = 'box', name = 'imu' }
            """
        for line, words in {
                "imu { on = 'bxo' }": 'imu: unknown object "bxo", did you mean "box"?',
                "imu { on = 'late' }": 'there from the start',
                "imu {}": 'imu.on',
                "imu { on = 'box', rate = 0 }": 'imu.rate',
                "imu { on = 'box', rate = 1e9 }": 'imu.rate',
                "imu { on = 'box', rate = 0/0 }": 'imu.rate',
                "imu { on = 'box', noise = -1 }": 'imu.noise',
                "imu { on = 'box', delay = 11 }": 'imu.delay',
                "imu { on = 'box', name = 'imu' }": 'imu.name: "imu" is already the name of another sensor',
                "imu { on = 'box', nosie = 1 }": 'did you mean noise',
                "encoder { joint = 'pivto' }": 'encoder.joint: unknown joint "pivto", did you mean "pivot"?',
                "encoder { joint = 'weld' }": 'encoder.joint: expected a joint with a free axis, got "weld"',
                "encoder { on = 'box' }": 'encoder.on: unknown field',
                "lidar { on = 'box', beams = 0 }": 'lidar.beams',
                "lidar { on = 'box', beams = 1000, rows = 5 }": 'lidar.rows: expected at most 4096 beams in all rows, got 5000',
                "for i = 1, 20000 do touch { on = 'box' } end": 'touch: expected at most 16384 sensors in a scene',
                "imu { on = 'box', rate = 1e5, keep = 1000000 } for i = 1, 30 do touch { on = 'box', keep = 1000000 } end": '256 MiB',
        }.items():
            with self.subTest(line=line), scene(start + line) as f:
                done = subprocess.run([os.environ['OBSIM'], 'run', f.name, '--duration', '1'], capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 1 if 'MiB' in words else 2, done.stderr)
                self.assertIn(words, done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_ways(self):
        """A free run has no sensors; names are looked up."""
        with scene("scene {} box { name = 'box', size = { 1, 1, 1 } } touch { on = 'box', name = 'skin' }") as f:
            done = subprocess.run([os.environ['OBSIM'], 'run', f.name, '--sync', 'free'], capture_output=True, text=True, check=False)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn('a free run has none, as this scene has', done.stderr)
            with obsim.run(f.name) as u:
                u.step(3)
                for words, code, text in (('sensors',), 0, 'skin  0.05  0\n'), (('sensors', 'skin'), 0, 'skin  0.05  0\n'), \
                        (('sensors', 'sikn'), 1, ''):
                    done = subprocess.run([os.environ['OBSIM'], 'send', u.universe_name, *words], capture_output=True, text=True, check=False)
                    self.assertEqual((done.returncode, done.stdout), (code, text), done.stderr)
            with obsim.run(f.name, inside=True) as u:
                with self.assertRaisesRegex(obsim.Unknown, "no sensor 'sikn', did you mean 'skin'"):
                    u.sensors['sikn']
                with self.assertRaisesRegex(obsim.Error, 'touch "skin" has no sample yet'):
                    u.sensors['skin'].value


if __name__ == '__main__':
    unittest.main()
