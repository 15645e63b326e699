#!/usr/bin/env python3
"""Entity state PDUs: their bytes, by the layout of IEEE 1278.1-2012 and, where it is installed, by tshark; objects are
where receivers extrapolate them to be. Exit 77 (skipped) without NumPy.
"""
import os
import random
import shutil
import socket
import struct
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
from obsim import _native, dis

SCENE = """scene { duration = 5, step = .01 }
ground {}
box { name = "flier", size = { 1, .5, .2 }, at = { 10, 20, 30 }, velocity = { 3, 4, 5 }, spin = { 0, 0, 1 } }
sphere { name = "ball", radius = .1, at = { 0, 0, .1 } }
"""
NEAR_PARIS = (48.85, 2.35, 35.)


class Meanwhile:
    """A universe in which something is done just after its states were read."""

    def __init__(self, u):
        self.u, self.deed = u, None

    def __getattr__(self, name):
        return getattr(self.u, name)

    def __getitem__(self, key):
        return self.u[key]

    def states(self):
        states, deed, self.deed = self.u.states(), self.deed, None
        if deed:
            deed()
        return states


def names_of(pdus, known=()):
    """Markings of active entities by number, after these PDUs."""
    known = dict(known)
    for pdu in pdus:
        number = struct.unpack_from('>HHH', pdu, 12)
        if struct.unpack_from('>I', pdu, 84)[0] & dis.DEACTIVATED:
            del known[number]
        else:
            known[number] = pdu[129:140].rstrip(b'\0').decode()
    return known


def receive(s):
    found = []
    while True:
        try:
            found.append(s.recv(2000))
        except BlockingIOError:
            return found


class Dis(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        scene = os.path.join(folder.name, 'a.lua')
        with open(scene, 'w', encoding='utf-8') as f:
            f.write(SCENE)
        self.u = obsim.run(scene)
        self.addCleanup(self.u.close)
        self.s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(self.s.close)
        self.s.bind(('127.0.0.1', 0))
        self.s.setblocking(False)
        self.sender = dis.Sender(self.u, self.s.getsockname(), 7, dis.Place(*NEAR_PARIS))
        self.addCleanup(self.sender.close)

    def test_bytes(self):
        """Field by field, at the places of the standard."""
        self.u.step(100)
        self.assertEqual(self.sender.look(), 2) # a plane is no entity
        pdu = receive(self.s)[0]
        self.assertEqual(len(pdu), 144)
        self.assertEqual(struct.unpack_from('>BBBB', pdu), (7, 7, 1, 1)) # version, exercise, entity state, its family
        self.assertAlmostEqual(struct.unpack_from('>I', pdu, 4)[0] / 2 ** 32 * 3600, 1, places=5) # s past the hour
        self.assertEqual(struct.unpack_from('>H', pdu, 8), (144,))
        self.assertEqual(struct.unpack_from('>HHH', pdu, 12), (1, 1, 2))
        position = numpy.array(struct.unpack_from('>3d', pdu, 48))
        self.assertAlmostEqual(numpy.linalg.norm(position), 6366050, delta=3000) # the ellipsoid has this radius there
        place = dis.Place(*NEAR_PARIS)
        numpy.testing.assert_allclose(place.turn.T @ (position - place.at), self.u['flier'].position, atol=1e-6)
        velocity = numpy.array(struct.unpack_from('>3f', pdu, 36))
        numpy.testing.assert_allclose(place.turn.T @ velocity, self.u['flier'].velocity, atol=1e-5)
        self.assertEqual(pdu[88], 4) # dead reckoning by acceleration and spin, world coordinates
        self.assertEqual(pdu[128:140], b'\x01flier\0\0\0\0\0\0')

    def test_angles(self):
        """Above longitude and latitude 0 east is geocentric y, up is x: a front to the east, its right to the south."""
        psi, theta, phi = dis.Place().angles(numpy.array([1., 0, 0, 0]))
        numpy.testing.assert_allclose([psi, theta], [numpy.pi / 2, 0], atol=1e-12)
        # from entity to geocentric: Rz(psi) Ry(theta) Rx(phi); its third axis points down, to -x
        down = [numpy.sin(psi) * numpy.sin(phi) + numpy.cos(psi) * numpy.sin(theta) * numpy.cos(phi),
                -numpy.cos(psi) * numpy.sin(phi) + numpy.sin(psi) * numpy.sin(theta) * numpy.cos(phi),
                numpy.cos(theta) * numpy.cos(phi)]
        numpy.testing.assert_allclose(down, [-1, 0, 0], atol=1e-12)

    def test_few(self):
        """A flight and an object at rest are sent a few times; extrapolation is near all the while; an object that goes is deactivated."""
        self.sender.look()
        place, sent, worst = dis.Place(*NEAR_PARIS), 0, 0
        last = {}
        for _ in range(100):
            self.u.step()
            sent += self.sender.look()
            for pdu in receive(self.s):
                last[struct.unpack_from('>H', pdu, 16)[0]] = pdu
            pdu = last[2]
            t = self.u.time - struct.unpack_from('>I', pdu, 4)[0] / 2 ** 32 * 3600
            p, v, a = (numpy.array(struct.unpack_from(f, pdu, at)) for f, at in (('>3d', 48), ('>3f', 36), ('>3f', 104)))
            there = place.turn.T @ (p + t * v + .5 * t * t * a - place.at)
            worst = max(worst, numpy.linalg.norm(there - self.u['flier'].position))
        self.assertLess(worst, .011)
        self.assertLess(sent, 20)
        self.u['ball'].remove()
        self.sender.look()
        gone = receive(self.s)[-1]
        self.assertEqual(struct.unpack_from('>H', gone, 16), (3,))
        self.assertTrue(struct.unpack_from('>I', gone, 84)[0] & 1 << 23)

    def test_meanwhile(self):
        """Objects come, go and take each other's numbers while the sender looks: receivers know those that there are."""
        u, rng, known = Meanwhile(self.u), random.Random(1), {}
        self.sender = dis.Sender(u, self.s.getsockname())
        self.addCleanup(self.sender.close)

        def change():
            here = [o for o in self.u if o.shape != 'plane']
            deed = rng.choice(['create', 'remove', 'replace', 'none'])
            if here and deed in ('remove', 'replace'):
                rng.choice(here).remove()
            if deed in ('create', 'replace'):
                self.u.create(f'sphere {{ name = "new {rng.randrange(10 ** 6)}", radius = .1, '
                              f'at = {{ {rng.uniform(-9, 9)}, {rng.uniform(-9, 9)}, {rng.uniform(1, 9)} }} }}')

        for _ in range(150):
            u.deed = change
            self.sender.look()
            known = names_of(receive(self.s), known)
            self.u.step()
            self.sender.look()
            known = names_of(receive(self.s), known)
            self.assertEqual(known, {(1, 1, 1 + o.id): o.name for o in self.u if o.shape != 'plane'})

    def test_numbers(self):
        """Ids beyond the numbers of an application are those of the next one; none has a number with a meaning of its own."""
        class Many:
            time = 0.
            ids = 0, 1, 65532, 65533, 65534, 65535, 131065, 131066, 1000063

            def states(self):
                n = len(self.ids)
                return {'id': numpy.array(self.ids), 'generation': numpy.ones(n), 'attitude': numpy.tile([1., 0, 0, 0], (n, 1)),
                        **{name: numpy.zeros((n, 3)) for name in ('position', 'velocity', 'angular_velocity')}}

            def _passport(self, _):
                p = _native.Passport()
                p.generation = 1
                return p

        sender = dis.Sender(Many(), self.s.getsockname())
        self.addCleanup(sender.close)
        self.assertEqual(sender.look(), len(Many.ids))
        numbers = [struct.unpack_from('>HHH', pdu, 12) for pdu in receive(self.s)]
        self.assertEqual(len(set(numbers)), len(Many.ids))
        self.assertEqual(numbers[:4], [(1, 1, 1), (1, 1, 2), (1, 1, 65533), (1, 2, 1)])
        self.assertTrue(all(1 <= entity <= 65533 for _, _, entity in numbers), numbers)

    @unittest.skipUnless(shutil.which('tshark') and shutil.which('text2pcap'), 'tshark is not installed')
    def test_tshark(self):
        self.u.step(100)
        self.sender.look()
        dump, capture = os.path.join(self.folder, 'a.txt'), os.path.join(self.folder, 'a.pcap')
        with open(dump, 'w', encoding='ascii') as f:
            for pdu in receive(self.s):
                f.write('000000 ' + ' '.join(f'{b:02x}' for b in pdu) + '\n')
        subprocess.run(['text2pcap', '-q', '-u', '3000,3000', dump, capture], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        said = subprocess.run(['tshark', '-r', capture, '-d', 'udp.port==3000,dis', '-V'], check=True, capture_output=True,
                              text=True).stdout
        for text in 'Distributed Interactive Simulation', 'Entity State', 'flier', 'ball', 'DRM(R, V, W)':
            self.assertIn(text, said)
        self.assertNotIn('Malformed', said)


unittest.main()
