"""Many universes within this program (obsim.batch): the bits of single ones, resets by mask, and memory that stays."""
import os
import resource
import tempfile
import threading
import unittest

import numpy

import obsim

POLE = """
scene { step = 1/500 }
box { name = "cart", size = { .4, .2, .1 }, at = { 0, 0, 1 }, mass = 2 }
slider { "cart", name = "rail", axis = { 1, 0, 0 }, motor = { rate = 0, most = 100 } }
box { name = "pole", size = { .05, .05, 1 }, at = { .02 * random(), 0, 1.55 }, mass = .5 }
hinge { "pole", "cart", name = "foot", at = { 0, 0, 1.05 }, axis = { 0, 1, 0 } }
"""
JOINTS = 'foot', 'rail'


def resident():
    """Pages of this program in memory."""
    with open('/proc/self/statm', encoding='ascii') as f:
        return int(f.read().split()[1])


class Batch(unittest.TestCase):
    def setUp(self):
        with tempfile.NamedTemporaryFile('w', suffix='.lua', delete=False) as f:
            f.write(POLE)
        self.addCleanup(os.unlink, f.name)
        self.pole = f.name

    def batch(self, n, **how):
        b = obsim.batch(self.pole, n, **how)
        self.addCleanup(b.close)
        return b

    def test_same_bits(self):
        """Each universe ends as one alone that is led alike, for any number of threads."""
        n, steps = 6, 50
        target, force = numpy.linspace(-1, 1, n), numpy.arange(3 * n).reshape(n, 3) * .1
        found = []
        for threads in 1, 4:
            b = self.batch(n, threads=threads, seeds=range(n))
            for k in range(steps):
                values = b.step(2, targets={'rail': target * k}, forces={'pole': force}, read=JOINTS)
            found.append((b.states(), values))
        for k in range(n):
            with obsim.run(self.pole, inside=True, options={'seed': k}) as u:
                joints = [u.joints[name] for name in JOINTS]
                for i in range(steps):
                    alone = u.step(2, targets={joints[1]: target[k] * i}, forces={u['pole']: force[k]}, read=joints)
                for states, values in found:
                    self.assertEqual(alone.tobytes(), values[k].tobytes())
                    for name, column in u.states().items():
                        self.assertEqual(column.tobytes(), states[name][k].tobytes(), name)
        self.assertEqual(states['position'].shape, (n, 2, 3))
        self.assertEqual(len({p.tobytes() for p in states['position']}), n)

    def test_names(self):
        """Threads find scenes by name at the same time."""
        for _ in range(10):
            with obsim.batch('stack', 16, threads=8) as b:
                self.assertEqual(b.position.shape, (16, 11, 3))

    def test_masks(self):
        n = 5
        b, mask = self.batch(n, threads=2), numpy.array([True, False, True, False, False])
        start = b.position
        b.step(20)
        later, kept = b.position, b.snapshot()
        self.assertFalse((start == later).all(axis=(1, 2)).any())
        b.reset(mask)
        self.assertEqual(b.position.tobytes(), numpy.where(mask[:, None, None], start, later).tobytes())
        self.assertEqual((b.time > 0).tolist(), (~mask).tolist())
        b.restore(kept)
        self.assertEqual(b.position.tobytes(), later.tobytes())
        b.forget(kept)
        with self.assertRaisesRegex(obsim.Error, 'run 0: '):
            b.restore(kept)
        b.reset(mask, seeds=range(7, 7 + n))
        seen = b.position
        self.assertEqual(seen[~mask].tobytes(), later[~mask].tobytes())
        self.assertFalse((seen[0] == seen[2]).all())
        with obsim.run(self.pole, inside=True, options={'seed': 9}) as u:
            self.assertEqual(u.position.tobytes(), seen[2].tobytes())
        self.assertEqual(b.step(1, targets={'rail': 1}, read=JOINTS).shape, (n, 2, 2))
        b.reset()
        self.assertEqual(b.time.tolist(), [0] * n)
        self.assertEqual(b.position[mask].tobytes(), seen[mask].tobytes())

    def test_errors(self):
        b = self.batch(3)
        for wrong in (lambda: b.step(targets={'rail': (1, 2)}), lambda: b.step(targets={'rial': 1}), lambda: b.step(read=['nothing']),
                      lambda: b.step(forces={'pole': (1, 2)}), lambda: b.reset([True]), lambda: b.reset(seeds=[1]),
                      lambda: b.step(targets={'rail': numpy.nan}), lambda: obsim.batch(self.pole, 2, options={'workers': 3}),
                      lambda: obsim.batch('no such scene', 2), lambda: obsim.batch(self.pole, 2, seeds=[1])):
            with self.assertRaises(obsim.Error):
                wrong()
        b.reset()
        b.step(0, read=['foot'])
        b[1]['pole'].remove()
        with self.assertRaisesRegex(obsim.Error, 'run 1: '):
            b.step(read=['foot'])
        self.assertEqual([u.steps for u in b], [1, 1, 1]) # the others have gone on
        with self.assertRaisesRegex(obsim.Error, 'numbers of objects'):
            b.position # pylint: disable=pointless-statement
        b.reset()
        self.assertEqual(b.position.shape, (3, 2, 3))
        b[2].close()
        with self.assertRaisesRegex(obsim.Error, 'closed'):
            b.step()

    def test_lock(self):
        """Other threads of Python go on while a batch steps."""
        b, ended, ticks = self.batch(2), threading.Event(), 0

        def step():
            b.step(2000)
            ended.set()
        thread = threading.Thread(target=step)
        thread.start()
        while not ended.wait(.001):
            ticks += 1
        thread.join()
        self.assertGreater(ticks, 3)

    def test_branches(self):
        """10,000 branches from one state: the same bits for the same action, and no more memory."""
        b = self.batch(4)
        b.step(10, targets={'rail': .3})
        kept, ends, memory = b.snapshot(), {}, []
        for k in range(2500):
            b.restore(kept)
            action = k % 10
            end = b.step(2, targets={'rail': .3 + .01 * action}, read=JOINTS).tobytes()
            self.assertEqual(ends.setdefault(action, end), end)
            if k % 25 == 0:
                memory.append(resident())
        self.assertEqual(len(set(ends.values())), 10)
        early, late = numpy.median(memory[8:40]), numpy.median(memory[-32:]) # one look alone is off by a megabyte
        self.assertLess((late - early) * resource.getpagesize(), 1 << 20)


if __name__ == '__main__':
    unittest.main()
