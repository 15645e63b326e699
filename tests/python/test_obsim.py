#!/usr/bin/env python3
"""The Python package: a run that Python leads is the same, to the bit, however it is run and however often it was put back;
its arrays are those of the universe; errors are explained. Exit 77 (skipped) without NumPy.
"""
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

try:
    import numpy
except ImportError:
    print('python3-numpy is not installed')
    sys.exit(77)

import obsim

SCENE = """local n, speed = param("n", 12), param("speed", 1)
scene { title = "Test", duration = 5, step = .01 }
ground {}
for i = 1, n do box { size = { .3, .3, .3 }, at = { .1 * (i % 3), .05 * i, .4 * i }, spin = { random(), speed, 1 } } end
sphere { name = "ball", radius = .2, at = { 3, 0, .2 }, script = [[
function on_message(from, what, number) self.state.heard = what; self:push({ 0, 0, number }) end
]] }
box { name = "lift", size = { 1, 1, .1 }, at = { 6, 0, 1 }, kind = "kinematic" }
box { name = "gate", size = { 1, 1, 1 }, at = { 3, 0, 0 }, static = true, sensor = true, group = 5 }
box { name = "top", size = { 1, 1, 1 }, at = { 9, 0, 5 }, mass = 2, inertia = { .5, .6, .7 } }
"""
CART = """scene { duration = 100, step = .02 }
ground {}
sphere { name = "cart", radius = .1, at = { random(), 0, .1 }, friction = 0 }
"""


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.scene = self.write(folder, 'scene.lua', SCENE)
        self.cart = self.write(folder, 'cart.lua', CART)

    @staticmethod
    def write(folder, name, text):
        path = os.path.join(folder.name, name)
        with open(path, 'w', encoding='utf-8') as f:
            f.write(text)
        return path

    def run_(self, options=None, **parameters):
        u = obsim.run(self.scene, options=options, **parameters)
        self.addCleanup(u.close)
        return u

    def says(self, text, function, *arguments, **named):
        with self.assertRaises(obsim.Error) as caught:
            function(*arguments, **named)
        self.assertIn(text, str(caught.exception))


class Sensors(Case):
    def test_inside(self):
        u = self.run_()
        gate = u['gate']
        self.assertEqual([o.name for o in gate.inside()], ['ball'])
        with unittest.mock.patch.object(obsim.Universe, '_passport', lambda _universe, _id: None): # it goes between two reads
            self.assertEqual(gate.inside(), [])
        self.assertTrue(u['gate'].sensor and not u['ball'].sensor and u['gate'].group == 5)
        u['ball'].position = 3, 0, 9
        self.assertEqual(u['gate'].inside(), [])
        self.assertEqual(u['ball'].inside(), [])
        self.assertEqual(u['top'].inertia.tolist(), [.5, .6, .7])


class Steps(Case):
    @staticmethod
    def live(u, chance=None):
        """The same life; with detours through snapshots, if there is some chance."""
        for k in range(20):
            if chance and chance.random() < .5:
                before, s = u.states(), u.snapshot()
                u.create('sphere { radius = .1, at = { 0, 0, 9 } }')
                u.kick(u.id[3:6], (1, 0, 2), (0, .01, 0))
                u.step(chance.randrange(30))
                u.restore(s)
                assert all((before[name] == now).all() for name, now in u.states().items())
            if k == 3:
                u['box#2'].force = 1, 2, 30
            elif k == 6:
                u['box#4'].kick((0, 1, 2), (.01, 0, 0))
            elif k == 9:
                u['lift'].velocity = 0, 0, .5
            elif k == 11:
                u['ball'].send('up', 3)
            elif k == 12:
                u['lift'].follow([.3, .6], [(6, 0, 2), (5, 0, 1)])
            elif k == 13:
                u['box#7'].position = 2, 2, 2
            elif k == 15:
                u.create('box { size = { .2, .2, .2 }, at = { 0, 0, 6 } }')
                u['box#1'].remove()
            u.step(10)
        return u.states()

    def test_same_bits(self):
        """Property: workers, isolation, containment and detours change no bit."""
        first = self.live(self.run_({'workers': 1}))
        chance = random.Random(1)
        for options in ({'workers': 2}, {'isolation': 'process', 'workers': 2}, {'isolation': 'process', 'harden': True},
                        {'workers': 'objects'}):
            other = self.live(self.run_(options), chance)
            for name, values in first.items():
                self.assertTrue((values == other[name]).all(), (options, name))

    def test_as_run(self):
        """A run that is led makes the steps of one that runs by itself."""
        try:
            import h5py # pylint: disable=import-outside-toplevel
        except ImportError:
            self.skipTest('python3-h5py is not installed')
        record = self.scene + '.h5'
        subprocess.run([os.environ['OBSIM'], 'run', self.scene, '--duration', '2', '--record', record], check=True,
                       stdout=subprocess.DEVNULL)
        u = self.run_()
        u.step(170)
        u.step(30)
        with h5py.File(record, 'r') as f:
            self.assertTrue((f['position'][-1] == u.position.astype(f['position'].dtype)).all())

    def test_clock(self):
        u = self.run_()
        self.assertEqual((u.steps, u.time, u.step_length), (0, 0, .01))
        u.step(7)
        self.assertAlmostEqual(u.time, .07)
        u.run_until(.5)
        self.assertEqual(u.steps, 50)
        u.go(numpy.inf)
        while u.steps < 60:
            time.sleep(.01)
        u.pause()
        stood = u.steps
        self.assertEqual(u.steps, stood)
        u.step()
        self.assertEqual(u.steps, stood + 1)

    def test_reset(self):
        u = self.run_({'seed': 1})
        start = u.states()
        u.step(30)
        u.reset()
        self.assertEqual(u.steps, 0)
        self.assertTrue((u.angular_velocity == start['angular_velocity']).all())
        u.reset(seed=2)
        self.assertFalse((u.angular_velocity == start['angular_velocity']).all())
        u.reset(seed=1)
        self.assertTrue((u.angular_velocity == start['angular_velocity']).all())
        pid = u._process.pid
        u.reset(n=5, speed=2)
        self.assertEqual((len(u), u._process.pid), (10, pid))
        numpy.testing.assert_allclose(u['box#1'].angular_velocity[1:], [2, 1])
        self.says('unknown parameter', u.reset, nonsense=1)
        u.step(30)
        after = u.states()
        u.reset(n=5, speed=2)
        u.step(30)
        self.assertTrue((u.position == after['position']).all())
        u.reset()
        self.assertEqual((u.steps, len(u)), (0, 10))

    def test_file(self):
        """A saved run goes on to the same bits, pulls included, also after a reset."""
        path = self.scene + '.ck'
        u = self.run_()
        u.reset(seed=5, n=6)
        u['ball'].drag((0, 0, 3))
        u.step(20)
        u.save(path)
        u.step(40)
        other = obsim.run(resume=path, options={'isolation': 'process'})
        self.addCleanup(other.close)
        self.assertEqual(other.steps, 20)
        other.step(40)
        self.assertTrue(all((v == other.states()[k]).all() for k, v in u.states().items()))
        self.says('No such file', u.save, '/nowhere/x.ck')
        self.says('is the end of the name of a record', u.save, 'x.h5')
        self.says('opaque', setattr, u['ball'], 'colour', (1, 0, 0, .5))

    def test_contact_events(self):
        """A ball touches the ground once, leaves it when it is lifted, and events of a future that was undone stay away."""
        u = self.run_(n=0)
        ball = u['ball']
        ball.position = 3, 0, .3
        self.says('subscribe first', u.contact_events)
        u.watch_contacts()
        u.step(50)
        begun = u.contact_events()
        self.assertEqual([(e['a'], e['b'], e['begins']) for e in begun], [(0, ball.id, 1)])
        self.assertAlmostEqual(begun[0]['step'], (2 * .1 / 9.81) ** .5 / .01, delta=2)
        s = u.snapshot()
        ball.position = 3, 0, 3
        u.step(3)
        self.assertEqual([e['begins'] for e in u.contact_events()], [0])
        u.restore(s)
        u.step(3)
        self.assertEqual(len(u.contact_events()), 0)
        u.watch_contacts(False)

    def test_belt(self):
        """A belt carries what lies on it."""
        u = self.run_(n=0)
        made, = u.create('box { size = { .2, .2, .2 }, at = { 6, 0, 1.15 } }')
        u['lift'].surface_velocity = .2, 0, 0
        u.step(150)
        numpy.testing.assert_allclose(made.velocity, [.2, 0, 0], atol=.01)
        numpy.testing.assert_allclose(u['lift'].surface_velocity, [.2, 0, 0])
        self.says('static or kinematic', setattr, made, 'surface_velocity', (1, 0, 0))

    def test_path(self):
        """A path that is given during the run has the bits of a scene's own, which begins with the object."""
        begin, points = .5, [(0, 6, 0, 1), (.4, 6, 0, 2), (1, 7, .5, 1), (1.7, 6, 0, 1)]
        turns = [(1, 0, 0, 0), (.8, .6, 0, 0), (.8, .6, 0, 0), (1, 0, 0, 0)]
        box = 'box { name = "own", size = { 1, 1, .1 }, kind = "kinematic", born = %g, path = { kind = "spline", %s points = { %s } } }'
        for turning, loop in (True, False), (False, False), (False, True):
            rows = [point + turn if turning else point for point, turn in zip(points, turns)]
            own = box % (begin, 'loop = true,' if loop else '', ', '.join('{ ' + ', '.join(map(str, r)) + ' }' for r in rows))
            with open(self.scene + '2', 'w', encoding='utf-8') as f:
                f.write('scene { duration = 5, step = .01 }\nbox { name = "lift", size = { 1, 1, .1 }, at = { 6, 0, 1 }, kind = "kinematic" }\n' + own
                        + '\nsphere { radius = .1, mass = 1, at = { 6, 0, 1.5 }, group = 1, hits = {} }\n')
            with obsim.run(self.scene + '2', options={'workers': 1}) as u:
                u.run_until(begin)
                u['lift'].follow([p[0] for p in points[1:]], [p[1:] for p in points[1:]], turns[1:] if turning else None, loop)
                for _ in range(400):
                    for part in 'position', 'attitude', 'velocity', 'angular_velocity':
                        lift, given = u['lift']._row(part), u['own']._row(part)
                        self.assertTrue((lift == given).all(), (u.steps, part, lift, given))
                    u.step()
                self.says('two steps', u['lift'].follow, [.01], [(6, 0, 3)])
                self.says('half a turn', u['lift'].follow, [1], [(6, 0, 3)], [(0, 1, 0, 0)])
                self.says('where the first', u['lift'].follow, [1], [(6, 0, 3)], None, True)
                self.says('grow', u['lift'].follow, [1, 1], [(6, 0, 3), (6, 0, 4)])
                self.says('at most 64', u['lift'].follow, range(1, 66), [(6, 0, 3)] * 65)
                self.says('from -10000000 to', u['lift'].follow, [1], [(numpy.nan, 0, 0)])
                u['lift'].follow([.1], [(6, 0, 3)])
                u['lift'].follow([.1], [(6, 0, 2)]) # replaces the other, which begins and ends as it does
                u.step(20)
                self.assertEqual(u['lift'].position.tolist(), [6, 0, 2])
                u['lift'].velocity = 0, 0, 1
                u.step(100)
                self.assertAlmostEqual(u['lift'].position[2], 3)
        with obsim.run(self.scene) as u:
            self.says('expected a kinematic object', u['ball'].follow, [1], [(0, 0, 0)])

    def test_lone_flight(self):
        """Closed form: an object flies as it was set."""
        u = self.run_()
        ball = u['ball']
        ball.position = 20, 20, 10
        ball.velocity = 1, 2, 3
        u.step(50)
        numpy.testing.assert_allclose(ball.position, [20.5, 21, 10 + 1.5 - .5 * 9.81 * .25], atol=1e-9)
        numpy.testing.assert_allclose(ball.velocity, [1, 2, 3 - 9.81 * .5], atol=1e-9)
        ball.force = -ball.mass * u.gravity
        u.step(10)
        numpy.testing.assert_allclose(ball.velocity, [1, 2, 3 - 9.81 * .5], atol=1e-9)
        ball.kick((ball.mass, 0, 0), (0, 0, ball.inertia[2]))
        numpy.testing.assert_allclose(ball.velocity[0], 2, atol=1e-12)
        numpy.testing.assert_allclose(ball.angular_velocity, [0, 0, 1], atol=1e-12)


class Reading(Case):
    def test_arrays(self):
        u = self.run_(n=5)
        self.assertEqual(len(u), 10)
        self.assertEqual(u.name[0], 'ground')
        self.assertEqual(u.position.shape, (10, 3))
        self.assertEqual(u.attitude.shape, (10, 4))
        numpy.testing.assert_allclose(numpy.linalg.norm(u.attitude, axis=1), 1)
        self.assertEqual([o.id for o in u], u.id.tolist())
        box = u['box#1']
        self.assertEqual((box.shape, box.static, u['lift'].kinematic, u['ground'].static), ('box', False, True, True))
        numpy.testing.assert_allclose(box.size, .15)
        self.assertTrue('box#9' not in u and 2 in u)
        u.step(200)
        contacts = u.contacts
        self.assertGreater(len(contacts), 4)
        self.assertTrue((contacts['a'] < contacts['b']).all())
        weight = contacts[contacts['a'] == 0]
        numpy.testing.assert_allclose(numpy.linalg.norm(weight['normal'], axis=1), 1)

    def test_attached(self):
        u = self.run_()
        other = obsim.attach(u.universe_name)
        self.assertIn(u.universe_name, obsim.names())
        u.step(20)
        self.assertEqual(other.steps, 20)
        self.assertTrue(other.wait(20, 0))
        self.assertFalse(other.wait(21, .01))
        u.go(numpy.inf)
        self.assertTrue(other.wait(30))
        u.pause()
        self.assertTrue((other.position == u.position).all())
        self.says('read only', other.step)
        self.says('read only', setattr, other['ball'], 'force', (0, 0, 1))

    def test_removed(self):
        u = self.run_()
        ball = u['ball']
        ball.remove()
        self.assertFalse(ball.exists)
        self.says('has gone', lambda: ball.position)
        with self.assertRaises(KeyError):
            u['ball']

    def test_created(self):
        u = self.run_()
        made = u.create('for i = 1, 3 do sphere { radius = .1, at = { i, 9, 1 } } end')
        self.assertEqual(len(made), 3)
        numpy.testing.assert_allclose(made[1].position, [2, 9, 1])


class Wrong(Case):
    def test_scene(self):
        self.says('No such file', obsim.run, 'nothing.lua')
        self.says('unknown', obsim.run, self.scene, nonsense=3)
        self.says('workers', obsim.run, self.scene, options={'workers': -1})
        self.says('--set video=a.mp4: there is no such setting', obsim.run, self.scene, options={'video': 'a.mp4'})
        self.says('--set solver=x: expected one of', obsim.run, self.scene, options={'solver': 'x'})
        with obsim.run(self.scene, options={'solver': 'jacobi', 'sleeping': False, 'substeps': 4, 'on_death': 'freeze'}) as u:
            u.step()

    def test_changes(self):
        u = self.run_()
        before = u.states()
        self.says('no object 99', u.kick, [1, 99], (0, 0, 1))
        self.says('does not move by forces', u.set_forces, [0], (0, 0, 1))
        self.says('unit quaternion', u.set_states, [1], (0, 0, 1), (0, 0, 0, 0))
        self.says('no snapshot', u.restore, 7)
        self.says('create:1', u.create, 'sphere {')
        self.says('no script', u['box#1'].send, 'hop')
        self.assertTrue(all((before[name] == now).all() for name, now in u.states().items()))
        u.close()
        self.says('closed', u.step)

    def test_words(self):
        """A misspelt name, and a number too few, set nothing, and what was meant is said."""
        u = self.run_()
        before, box = u.states(), u['box#3']
        for what, name, meant in ((box, 'velocty', 'velocity'), (box, 'angular_velocty', 'angular_velocity'), (u, 'snapshots', 'snapshot'),
                                  (u, 'steps_length', 'step_length')):
            self.says(f"no attribute '{name}', did you mean '{meant}'?", setattr, what, name, (1, 2, 3))
            self.says(f"no attribute '{name}', did you mean '{meant}'?", getattr, what, name)
            self.assertFalse(hasattr(what, name))
        for what, name in ((box, 'mass'), (box, 'kick'), (u, 'position'), (u, 'step')):
            self.says(f'{name} cannot be set', setattr, what, name, 1)
        for name in ('position', 'attitude', 'velocity', 'angular_velocity', 'force', 'torque', 'colour'):
            for value in (1, (), (1, 2), (1, 2, 3, 4, 5), [[1, 2, 3], [1, 2, 3]], None, 'fast', {}, numpy.nan):
                self.says(f'expected {4 if name in ("attitude", "colour") else 3} numbers for each of 1 object, got', setattr, box, name, value)
        self.says('expected 1 number for each of 1 object, got (1, 2)', setattr, box, 'friction', (1, 2))
        for function, arguments in ((u.set_forces, (1,)), (u.set_forces, ([[1, 2, 3]] * 3,)), (u.kick, ((1, 0, 0), 2)), (u.set_states, (7,)),
                                    (u.set_states, ([[1, 2, 3]], 1)), (u.push, (3,)), (u.drag, ([1, 2],)), (u.set_frictions, ((.1, .2, .3),))):
            self.says('for each of 2 objects, got', function, [2, 3], *arguments)
        self.says('expected 3 numbers for each of 2 objects', u['lift'].follow, [1, 2], 5)
        self.assertTrue(all((before[name] == now).all() for name, now in u.states().items()))
        self.says("no object 'box#33', did you mean 'box#3'?", lambda: u['box#33'])
        self.says("no object 99", lambda: u[99])
        self.says("no joint 'elbow'", lambda: u.joints['elbow'])
        self.assertTrue('box#3' in u and 3 in u and 'box#33' not in u and 99 not in u)
        with self.assertRaises(KeyError): # as of other mappings
            u['nobody']
        u.set_frictions([2, 3], (.1, .2))
        u.set_frictions([2, 3], .5)
        u.set_forces([2, 3], (0, 0, 1))
        u.set_forces([2, 3], [(0, 0, 1), (0, 0, 2)])

    def test_monolith(self):
        u = self.run_({'arch': 'monolith'})
        u.step(10)
        self.assertEqual(u.steps, 10)
        self.says('no snapshots', u.snapshot)
        self.says('to itself', u['ball'].kick, (0, 0, 1))

    def test_pulls(self):
        """Pushed, turned, dragged: the closed forms; and what was let go falls."""
        u = self.run_()
        ball = u['ball']
        ball.position = 20, 20, 10
        ball.push((0, 0, 9.81 * ball.mass))
        ball.torque = 0, 0, ball.inertia[2]
        u.step(50)
        numpy.testing.assert_allclose(ball.angular_velocity, [0, 0, .5], atol=1e-12)
        numpy.testing.assert_allclose(ball.position, [20, 20, 10], atol=1e-9)
        ball.release()
        ball.drag((19, 20, 12))
        u.step(200)
        numpy.testing.assert_allclose(ball.position, [19, 20, 12], atol=.04)
        self.says('point: expected', ball.drag, (0, 0, 0), (9, 0, 0))
        ball.release()
        u.step(1)
        ball.velocity = 1, 0, 0
        numpy.testing.assert_allclose(ball.position, [19, 20, 12], atol=.04)
        ball.friction = .25
        self.assertEqual(ball.friction, .25)
        self.says('isolation process', ball.kill)

    def test_killed_simulator(self):
        u = self.run_({'isolation': 'process', 'workers': 2})
        other = self.run_()
        u.step(30)
        u['box#3'].kill()
        u.step(30)
        other.step(60)
        self.assertEqual(u.deaths, 1)
        self.assertTrue((u.position == other.position).all())

    def test_killed(self):
        u = self.run_()
        os.kill(u._process.pid, signal.SIGKILL)
        self.says('the run has ended', u.step, 3)

    def test_python_ends(self):
        """A run does not outlive the program that leads it."""
        code = f'import obsim, sys, time; u = obsim.run({self.scene!r}); print(u.universe_name, flush=True); time.sleep(1000)'
        with subprocess.Popen([sys.executable, '-c', code], stdout=subprocess.PIPE, text=True) as python:
            name = python.stdout.readline().strip()
            self.assertIn(name, obsim.names())
            python.kill()
        while name in obsim.names():
            time.sleep(.01)


class Documents(unittest.TestCase):
    def test_examples(self):
        root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
        with open(os.path.join(root, 'docs/control.md'), encoding='utf-8') as f:
            blocks = re.findall(r'```python\n(.*?)```', f.read(), re.S)
        self.assertTrue(blocks)
        folder = tempfile.TemporaryDirectory() # they write files
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        for block in blocks:
            try:
                exec(compile(block, 'docs/control.md', 'exec'), {}) # pylint: disable=exec-used
            except ModuleNotFoundError as e:
                print(e)


class Control(Case):
    """A cart on ice: a force along x brings it to the origin."""

    def begin(self, n):
        b = obsim.batch(self.cart, n)
        self.addCleanup(b.close)
        row = b.id[0].tolist().index(b[0]['cart'].id)
        return b, b[0]['cart'].mass, lambda: numpy.stack([b.position[:, row, 0], b.velocity[:, row, 0]], axis=1)

    @staticmethod
    def push(b, newtons):
        b.step(5, forces={'cart': numpy.outer(newtons, [1, 0, 0])})

    def test_one(self):
        b, mass, see = self.begin(1)
        starts = []
        for seed in 4, 3:
            b.reset(seeds=[seed])
            starts.append(see()[0, 0])
        self.assertNotEqual(*starts)
        for _ in range(40):
            self.push(b, -mass * (see() @ [6, 4]))
        self.assertLess(abs(see()[0, 0]), .02)

    def test_random_search(self):
        """Gains of a controller, found by chance on universes side by side."""
        b, mass, see = self.begin(4)
        chance, best = numpy.random.default_rng(2), None

        def play(gains):
            b.reset()
            total = numpy.zeros(4)
            for _ in range(40):
                self.push(b, -mass * (gains * see()).sum(axis=1))
                total -= see()[:, 0] ** 2
            return total
        for _ in range(4):
            total = play(chance.uniform(0, 6, (4, 2)))
            best = total.max() if best is None else max(best, total.max())
        self.assertGreater(best, play(numpy.zeros((4, 2)))[0])


class Policy(Case):
    """A pole that is held up at its foot, as a broom on a hand: a policy found by random search on 16 universes side by side."""
    POLE = """scene { duration = 100, step = .01 }
box { name = "pole", size = { .1, .1, 1 }, at = { 0, 0, 5 }, rotation = { axis = { 0, 1, 0 }, degrees = 4 * random() + 1 } }
"""
    UNIVERSES, ACTIONS = 16, 40

    def test_pole(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        with obsim.batch(self.write(folder, 'pole.lua', self.POLE), self.UNIVERSES) as b:
            mass, chance = b[0]['pole'].mass, numpy.random.default_rng(3)
            centre, width = numpy.zeros(2), numpy.array([40., 6.])
            for _ in range(2):
                gains = centre + width * mass * chance.uniform(-1, 1, (self.UNIVERSES, 2))
                gains[0] = centre
                total, _ = self.play(b, gains, None)
                centre, width = gains[total.argmax()], width / 3
            policies = numpy.tile(centre, (self.UNIVERSES, 1))
            policies[0] = 0
            total, leans = self.play(b, policies, range(10, 10 + self.UNIVERSES))
            self.assertLess(numpy.abs(leans[1:]).max(), .05) # starts that it has not seen
            self.assertGreater(abs(leans[0]), .3) # without a policy it falls
            self.assertLess(total[0], total[1:].min())

    @staticmethod
    def observe(b):
        """The lean of each axis along x, and its spin."""
        w, x, y, z = b.attitude[:, 0].T
        return numpy.stack([2 * (x * z + w * y), b.angular_velocity[:, 0, 1]], axis=1)

    def play(self, b, gains, seeds):
        """(rewards, last leans) of an episode of each universe."""
        b.reset(seeds=seeds)
        poles = [u['pole'] for u in b]
        total, most, weight = numpy.zeros(len(b)), 9 * poles[0].mass, 9.81 * poles[0].mass
        for _ in range(self.ACTIONS):
            for pole, force in zip(poles, numpy.clip((gains * self.observe(b)).sum(axis=1), -most, most).tolist()):
                pole.push((force, 0, weight), (0, 0, -.5))
            b.step(5)
            total -= self.observe(b)[:, 0] ** 2
        return total, self.observe(b)[:, 0]


class Joints(Case):
    POLE = """scene { duration = 100, step = 1/50 }
box { name = "cart", size = { .4, .2, .1 }, at = { 0, 0, 1 }, mass = 2 }
slider { "cart", name = "rail", axis = { 1, 0, 0 }, motor = { rate = 0, most = 100 } }
box { name = "pole", size = { .05, .05, 1 }, at = { .05, 0, 1.55 }, mass = .5, rotation = { axis = { 0, 1, 0 }, degrees = 6 } }
hinge { "pole", "cart", name = "foot", at = { 0, 0, 1.05 }, axis = { 0, 1, 0 } }
"""

    def hold_up(self, u, steps, gains=(60, 15, 2, 4)):
        """Moves the cart below the pole: the target of its motor is set before each step. Returns how far the pole leans."""
        rail, foot = u.joints['rail'], u.joints['foot']
        for _ in range(steps):
            begun = numpy.arctan2(.05, .5) # the value of the foot is 0 there
            seen = foot.value + begun, foot.rate, rail.value, rail.rate
            rail.target = rail.rate + u.step_length * numpy.dot(gains, seen)
            u.step()
        return foot.value + begun

    def test_pole_on_a_cart(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        scene, kept = self.write(folder, 'cart.lua', self.POLE), os.path.join(folder.name, 'kept.ck')
        with obsim.run(scene) as u, obsim.run(scene, options={'isolation': 'process', 'harden': True}) as other:
            start = u.snapshot()
            self.assertLess(abs(self.hold_up(u, 500)), 5e-3)
            self.assertLess(abs(u.joints['rail'].value), .05)
            self.hold_up(other, 500)
            self.assertTrue((u.position == other.position).all())
            u.restore(start)
            self.assertEqual(u.joints['rail'].target, 0) # it is part of the state
            self.assertGreater(abs(self.hold_up(u, 40, (0, 0, 0, 0))), .5) # nobody holds it up
            u.joints['rail'].target = .25
            u.save(kept)
            with obsim.run(resume=kept) as again:
                self.assertEqual(again.joints['rail'].target, .25)
            self.assertEqual([o.name for o in u.joints['foot'].objects], ['pole', 'cart'])
            self.says('joint 1 (foot) has no motor', lambda: setattr(u.joints['foot'], 'target', 1))
            self.says('must be a number', lambda: setattr(u.joints['rail'], 'target', numpy.nan))

    def test_restore_forgets(self):
        """Objects created since are gone without a trace: near many triangles flights follow the number of objects."""
        scene = """
            heightfield { size = { 20, 20 }, cells = { 40, 40 }, height = function(x, y) return .2 * math.sin(x * y) end }
            for i = 1, 10 do
                box { size = { .4, .3, .2 }, at = { i - 6, 0, 3 }, velocity = { 2, i - 2, 2 }, spin = { 1, 2, 3 }, restitution = .9 }
            end"""
        with tempfile.NamedTemporaryFile('w', suffix='.lua') as f:
            f.write(scene)
            f.flush()
            with obsim.run(f.name, options={'workers': 1}) as u:
                start = u.snapshot()
                u.step(300)
                expected = u.states()
                u.restore(start)
                u.create('for i = 1, 200 do sphere { radius = .04, at = { 6, .1 * i, 9 } } end')
                u.step(20)
                u.restore(start)
                u.step(300)
                for name, values in u.states().items():
                    numpy.testing.assert_array_equal(values, expected[name])

    def test_joints_come_and_go(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        scene = self.write(folder, 'bobs.lua', """scene { duration = 10 }
            sphere { name = "a", radius = .1, at = { 0, 0, 3 }, mass = 2 }
            sphere { name = "b", radius = .1, at = { 1, 0, 3 }, mass = 1 }""")
        with obsim.run(scene) as u, obsim.run(scene, options={'isolation': 'process', 'harden': True}) as other:
            for v in u, other:
                self.assertEqual(v.joints, {})
                start = v.snapshot()
                v.create('fixed { "a", name = "hook", breaks_at = { force = 40 } } ball { "b", "a", at = { 1, 0, 3 } }')
                self.assertEqual(sorted(v.joints), ['ball#1', 'hook'])
                v.step(2)
                self.assertAlmostEqual(v.joints['hook'].force[2], 3 * 9.81, 6)
                self.assertFalse(v.joints['hook'].broken)
                v.joints['ball#1'].remove()
                self.assertEqual(list(v.joints), ['hook'])
                v.step(10)
                self.assertAlmostEqual(v.joints['hook'].force[2], 2 * 9.81, 6)
                v.restore(start)
                self.assertEqual(v.joints, {})
                v.create('ball { "b", "a", name = "rope", at = { 0, 0, 3 }, breaks_at = { force = 1e-3 } } fixed { "a", name = "hook" }')
                v.step(3)
                self.assertTrue(v.joints['rope'].broken)
                v['a'].remove()
                self.assertEqual(v.joints, {})
                v.step(3)
            self.assertTrue((u.position == other.position).all())
            self.says('expected the name of an object, got "c"', lambda: u.create('fixed { "c" }'))


unittest.main()
