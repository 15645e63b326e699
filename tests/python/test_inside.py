"""Universes within this program (obsim.run(.., inside=True)): the same bits as outside, several side by side, errors as exceptions."""
import os
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy

import obsim

ARM = """
scene { step = 1/120 }
ground {}
box { name = 'base', size = { .4, .4, .2 }, at = { 0, 0, .1 }, static = true }
box { name = 'arm', size = { .05, .05, 1 }, at = { 0, 0, .7 }, mass = .5 }
hinge { 'arm', 'base', name = 'shoulder', at = { 0, 0, .2 }, axis = { 0, 1, 0 }, motor = { rate = 0, most = 20 } }
for i = 1, 6 do sphere { name = 'ball' .. i, radius = .1, at = { math.sin(i), math.cos(i), .2 + i ^ .5 } } end
"""


def scene(text):
    """A file that holds a scene."""
    f = tempfile.NamedTemporaryFile('w', suffix='.lua') # pylint: disable=consider-using-with # goes with the test
    f.write(text)
    f.flush()
    return f


def states(u):
    """All states as bytes."""
    s = u.states()
    return b''.join(s[name].tobytes() for name in sorted(s))


def lead(u):
    """Steps, changes, snapshots; returns the states along the way."""
    seen = []
    shoulder = u.joints['shoulder']
    for k in range(40):
        values = u.step(targets={shoulder: (-1) ** (k // 10)}, forces={u['ball1']: (0, 0, .1 * k)}, read=[shoulder])
        assert values[0, 0] == shoulder.value and values[0, 1] == shoulder.rate
    seen.append(states(u))
    start = u.snapshot()
    u.kick([u['ball2'].id], [(1, 0, 2)])
    u['ball3'].position = 2, 0, 3
    made = u.create("box { size = { .2, .2, .2 }, at = { 0, 2, 2 } }")
    u.step(60)
    seen.append(states(u))
    u.restore(start)
    seen.append(states(u))
    assert not made[0].exists
    u['ball4'].remove()
    u.step(60)
    seen.append(states(u))
    u.reset(seed=3)
    u.step(10)
    seen.append(states(u))
    return seen


class Inside(unittest.TestCase):
    def test_same_bits(self):
        with scene(ARM) as f:
            with obsim.run(f.name, inside=True) as u:
                inside = lead(u)
            with obsim.run(f.name, options={'workers': 2}) as u:
                self.assertEqual(inside, lead(u))

    def test_scenes(self):
        for name, parameters in ('falling_boxes', {'n': 40}), ('flock', {}), ('plaza', {}), ('hills', {}), ('shapes', {}):
            with self.subTest(name):
                found = []
                for inside in False, True:
                    with obsim.run(name, inside=inside, **parameters) as u:
                        u.step(90)
                        found.append(states(u))
                self.assertEqual(*found)

    def test_one_exchange(self):
        with scene(ARM) as f, obsim.run(f.name, inside=True) as u:
            shoulder, ball = u.joints['shoulder'], u['ball1']
            start = u.snapshot()
            u.step(3, targets={shoulder: 2}, forces={ball: (1, 2, 3)})
            together = states(u)
            u.restore(start)
            shoulder.target, ball.force = 2, (1, 2, 3)
            u.step(3)
            self.assertEqual(together, states(u))
            before = u.steps
            for targets in {shoulder: 'fast'}, {shoulder: None}, {shoulder: numpy.nan}:
                with self.assertRaises(obsim.Error):
                    u.step(targets=targets)
            with self.assertRaises(obsim.Error):
                u.step(forces={ball: (1, 2)})
            shoulder.remove()
            with self.assertRaises(obsim.Error):
                u.step(targets={shoulder: 1})
            with self.assertRaises(obsim.Error):
                u.step(0, read=[shoulder])
            self.assertEqual(u.steps, before)

    def test_refused(self):
        for options, word in ({'workers': 2}, 'workers'), ({'isolation': 'process'}, 'isolation'), ({'harden': True}, 'harden'):
            with self.assertRaisesRegex(obsim.Error, word):
                obsim.run('stack', options=options, inside=True)
        with self.assertRaisesRegex(obsim.Error, 'no scene|cannot read'):
            obsim.run('no such scene', inside=True)
        for text, word in ('box {', 'symbol'), ('box {}', 'box.size'):
            with scene(text) as f, self.assertRaisesRegex(obsim.Error, word):
                obsim.run(f.name, inside=True)
        with obsim.run('stack', inside=True) as u:
            for function in u.go, lambda: u.kill([0]):
                with self.assertRaises(obsim.Error):
                    function()
            u.step()
            self.assertEqual(u.steps, 1)
        with self.assertRaisesRegex(obsim.Error, 'closed'):
            u.step()

    def test_side_by_side(self):
        """Four universes in threads of their own, whose scenes differ, and one that begins and ends meanwhile."""
        expected, found = {}, {}

        def run(n):
            with obsim.run('falling_boxes', inside=True, n=n) as u:
                for _ in range(6):
                    u.step(10)
                    u.restore(u.snapshot())
                found[n] = states(u)

        for n in 5, 10, 15, 20:
            run(n)
        expected.update(found)
        found.clear()
        threads = [threading.Thread(target=run, args=(n,)) for n in expected]
        for t in threads:
            t.start()
        with obsim.run('stack', inside=True) as u:
            u.step(20)
        for t in threads:
            t.join()
        self.assertEqual(expected, found)

    def test_seen_by_others(self):
        with obsim.run('stack', inside=True) as u:
            u.step(5)
            other = subprocess.run([sys.executable, '-c', f'import obsim; print(obsim.attach({u.universe_name!r}).steps)'],
                                   capture_output=True, text=True, check=True)
            self.assertEqual(other.stdout.strip(), '5')
            name = u.universe_name
        self.assertNotIn(name, obsim.names())

    def test_interrupt(self):
        with obsim.run('falling_boxes', inside=True, n=200) as u:
            timer = threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT))
            timer.start()
            with self.assertRaises(KeyboardInterrupt):
                u.step(10 ** 7)
            timer.join()
            before = u.steps
            u.step(2)
            self.assertEqual(u.steps, before + 2)

    def test_fork(self):
        with obsim.run('stack', inside=True) as u:
            u.step()
            child = os.fork()
            if child == 0:
                try:
                    u.step()
                except obsim.Error:
                    u.close()
                    os._exit(3)
                os._exit(0)
            self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 3)
            u.step()
            self.assertEqual(u.steps, 2)
            self.assertIn(u.universe_name, obsim.names())

    def test_errors(self):
        """An error raises an exception, and changes nothing."""
        with obsim.run('stack', inside=True) as u:
            u.step(3)
            before = states(u)
            for text in 'box {', 'box {}', "hinge { 'a', 'b' }":
                with self.assertRaises(obsim.Error):
                    u.create(text)
            for number in 0, 7:
                with self.assertRaises(obsim.Error):
                    u.restore(number)
            with self.assertRaises(obsim.Error):
                u.kick([999], [(1, 0, 0)])
            self.assertEqual(states(u), before)


if __name__ == '__main__':
    unittest.main()
