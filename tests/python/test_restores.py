#!/usr/bin/env python3
"""Snapshots taken and put back at random moments of a scene that lands, with scripts and joints, change no bit of its end:
for the caller's own thread, threads, processes and contained ones, any number of workers, and beside kills. Exit 77 (skipped) without NumPy.

test_restores.py [MOMENTS]    of each way to run; 5
"""
import os
import random
import sys
import tempfile
import unittest

try:
    import numpy # pylint: disable=unused-import
except ImportError:
    print('python3-numpy is not installed')
    sys.exit(77)

import obsim

MOMENTS = 5
STEPS = 150
SCENE = """scene { title = "Landing", step = 1/60, room = 40 }
ground {}
script("hopper", [[
function on_start() self.state.hops = 0 self:wake(random(.1, .5)) end
function on_wake() self.state.hops = self.state.hops + 1 self:push(0, 0, 2 * self:mass()) self:wake(.4) end
function on_contact(other) self:colour("#e4572e") if self.state.hops < 2 then sphere { radius = .05, at = { 0, 3, 5 } } end end
]])
for i = 1, 20 do
	box { size = { .3, .3, .3 }, at = { .1 * (i % 3), .05 * i, .35 * i }, spin = { random(), 1, 1 },
		script = i % 4 == 0 and "hopper" or nil }
end
for i = 1, 5 do
	sphere { name = "bob" .. i, radius = .1, at = { 2 + .4 * i, 0, 1 } }
	if i > 1 then ball { "bob" .. i - 1, "bob" .. i, at = { 1.8 + .4 * i, 0, 1 } } end
end
hinge { "bob1", at = { 2, 0, 1 }, axis = { 0, 1, 0 } }
box { name = "paddle", size = { 2, .1, .3 }, at = { 0, -1, .2 }, kind = "kinematic" }
"""
WAYS = ({'workers': 1}, {'workers': 2}, {'workers': 'objects'}, {'isolation': 'process', 'workers': 2},
        {'isolation': 'process', 'harden': True}, None) # None: within this program


class Restores(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.scene = os.path.join(folder.name, 'scene.lua')
        with open(self.scene, 'w', encoding='utf-8') as f:
            f.write(SCENE)

    @staticmethod
    def kill(o):
        try:
            o.kill()
        except obsim.Error: # it was not solved yet, so it has no simulator
            pass

    def end_of(self, options, chance=None, kills=False):
        """States at the end, by name. chance: with detours from random moments."""
        with obsim.run(self.scene, options=options, inside=options is None) as u:
            u.step()
            u['paddle'].follow((.4, 1, 2.2), ((0, 0, .2), (0, 0, .6), (0, -1, .2)), ((1, 0, 0, 0), (.8, 0, 0, .6), (1, 0, 0, 0)))
            for moment in sorted(chance.sample(range(STEPS), MOMENTS)) if chance else []:
                if moment > u.steps:
                    u.step(moment - u.steps)
                before, s = u.states(), u.snapshot()
                u.kick(u.id[3:6], (1, 0, 2))
                if kills and chance.random() < .3:
                    self.kill(u['box#3'])
                u.step(chance.randrange(1, 20))
                u.restore(s)
                u.forget(s)
                for name, now in u.states().items():
                    self.assertTrue((before[name] == now).all(), (options, moment, name))
                if kills and chance.random() < .3:
                    self.kill(u['box#5'])
            u.step(STEPS - u.steps)
            return u.states()

    def test_same_bits(self):
        first = self.end_of({'workers': 1})
        self.assertGreater(len(first['id']), 27) # scripts have created some
        chance = random.Random(7)
        for options in WAYS:
            for kills in (False, True) if options and 'isolation' in options else (False,):
                with self.subTest(options=options, kills=kills):
                    for name, values in self.end_of(options, chance, kills).items():
                        self.assertTrue((first[name] == values).all(), name)


if __name__ == '__main__':
    if len(sys.argv) > 1:
        MOMENTS = int(sys.argv.pop(1))
    unittest.main()
