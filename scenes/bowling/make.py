#!/usr/bin/env python3
"""Writes what ../bowling.lua looks like: pin.glb, lane.glb and ball.glb, in the folder of this file.

A binary glTF is a header, its JSON, and one buffer. Here z points up; in glTF y does.
"""
import json
import math
import pathlib
import random
import struct

INCH = .0254
# Heights and diameters of a tenpin (USBC, Equipment Specifications Manual), inches; above the last one it is a ball.
PIN = [(0, 2.031), (.75, 2.828), (2.25, 3.906), (3.375, 4.510), (4.5, 4.766), (5.875, 4.563), (7.25, 3.703), (8.625, 2.472), (9.375, 1.965),
       (10, 1.797), (10.875, 1.870), (11.75, 2.094), (12.625, 2.406), (13.5, 2.547)]
HEIGHT, HEAD = 15, 1.273


class Part:
    """Triangles of one material: sRGB colour, roughness and metal."""

    def __init__(self, colour, roughness, metal=0):
        self.colour, self.roughness, self.metal = colour, roughness, metal
        self.vertices, self.triangles = [], []

    def vertex(self, p, n):
        length = math.hypot(*n)
        self.vertices.append((*p, *(x / length for x in n)))
        return len(self.vertices) - 1

    def quad(self, a, b, c, d):
        self.triangles += [(a, b, c), (a, c, d)]

    def flat(self, *corners):
        """A convex polygon, counterclockwise from outside."""
        u, v = ([b - a for a, b in zip(corners[0], corners[k])] for k in (1, 2))
        n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        i = [self.vertex(c, n) for c in corners]
        self.triangles += [(i[0], i[k], i[k + 1]) for k in range(1, len(i) - 1)]

    def turn(self, profile, segments=40):
        """Turned on a lathe: (radius, height, slope of the outline as dr, dz) from below."""
        rings = []
        for r, z, dr, dz in profile:
            turns = [2 * math.pi * k / segments for k in range(segments)]
            rings.append([self.vertex((r * math.cos(t), r * math.sin(t), z), (dz * math.cos(t), dz * math.sin(t), -dr)) for t in turns])
        for low, high in zip(rings, rings[1:]):
            for k in range(segments):
                self.quad(low[k], low[(k + 1) % segments], high[(k + 1) % segments], high[k])

    def box(self, low, high):
        at = lambda k: tuple(high[i] if k >> i & 1 else low[i] for i in range(3))
        for face in ((1, 3, 7, 5), (0, 4, 6, 2), (2, 6, 7, 3), (0, 1, 5, 4), (4, 5, 7, 6), (0, 2, 3, 1)):
            self.flat(*map(at, face))


def write(name, parts, place=(0, 0, 0)):
    """place: of the model in the file, as the translation of its node."""
    linear = lambda c: ((c + .055) / 1.055) ** 2.4 if c > .04045 else c / 12.92
    buffer, views, accessors, primitives, materials = b'', [], [], [], []

    def put(data, count, kind, component, **more):
        nonlocal buffer
        views.append({'buffer': 0, 'byteOffset': len(buffer), 'byteLength': len(data)})
        accessors.append({'bufferView': len(views) - 1, 'componentType': component, 'count': count, 'type': kind, **more})
        buffer += data + bytes(-len(data) % 4)
        return len(accessors) - 1

    upright = lambda x, y, z: (x, z, -y)
    for part in parts:
        points = [tuple(struct.unpack('<3f', struct.pack('<3f', *upright(*v[:3])))) for v in part.vertices]
        normals = [upright(*v[3:]) for v in part.vertices]
        corners = [i for t in part.triangles for i in t]
        ends = {'min': [min(c) for c in zip(*points)], 'max': [max(c) for c in zip(*points)]}
        primitives.append({
            'attributes': {'POSITION': put(b''.join(struct.pack('<3f', *p) for p in points), len(points), 'VEC3', 5126, **ends),
                           'NORMAL': put(b''.join(struct.pack('<3f', *n) for n in normals), len(normals), 'VEC3', 5126)},
            'indices': put(struct.pack(f'<{len(corners)}H', *corners), len(corners), 'SCALAR', 5123),
            'material': len(materials)})
        colour = [round(linear(int(part.colour[k:k + 2], 16) / 255), 5) for k in (1, 3, 5)]
        materials.append({'pbrMetallicRoughness': {'baseColorFactor': colour + [1], 'roughnessFactor': part.roughness, 'metallicFactor': part.metal}})
    text = json.dumps({'asset': {'version': '2.0', 'generator': 'obsim scenes/bowling/make.py'}, 'scene': 0, 'scenes': [{'nodes': [0]}],
                       'nodes': [{'mesh': 0, 'translation': upright(*place)}], 'meshes': [{'primitives': primitives}], 'materials': materials,
                       'accessors': accessors, 'bufferViews': views, 'buffers': [{'byteLength': len(buffer)}]}, separators=(',', ':')).encode()
    text += b' ' * (-len(text) % 4)
    chunks = struct.pack('<II', len(text), 0x4e4f534a) + text + struct.pack('<II', len(buffer), 0x004e4942) + buffer
    (pathlib.Path(__file__).parent / name).write_bytes(struct.pack('<4sII', b'glTF', 2, 12 + len(chunks)) + chunks)


def pin_outline(z):
    """Radius at a height, both in inches: Catmull and Rom's spline through the table, then the ball of the head."""
    top = PIN[-1][0]
    if z >= top:
        return math.sqrt(max(0, HEAD ** 2 - (z - (HEIGHT - HEAD)) ** 2))
    k = max(i for i in range(len(PIN) - 1) if PIN[i][0] <= z)
    (z0, d0), (z1, d1) = PIN[k], PIN[k + 1]
    slope = lambda i: (PIN[min(i + 1, len(PIN) - 1)][1] - PIN[max(i - 1, 0)][1]) / (PIN[min(i + 1, len(PIN) - 1)][0] - PIN[max(i - 1, 0)][0])
    h, t = z1 - z0, (z - z0) / (z1 - z0)
    return ((2 * t ** 3 - 3 * t ** 2 + 1) * d0 + (t ** 3 - 2 * t ** 2 + t) * h * slope(k) + (3 * t ** 2 - 2 * t ** 3) * d1
            + (t ** 3 - t ** 2) * h * slope(k + 1)) / 2


def pin():
    white, red, sole = Part('#f4efe4', .14), Part('#c2201f', .14), Part('#3a3431', .6)
    heights = [15 * (1 - math.cos(math.pi * k / 54)) / 2 for k in range(55)]
    bands = [9.15, 9.6, 10.35, 10.8] # the two red rings of the neck
    edges = [0] + bands + [15]
    for k, (low, high) in enumerate(zip(edges, edges[1:])):
        outline = []
        for z in [low] + [z for z in heights if low < z < high] + [high]:
            below, above = max(z - .01, 0), min(z + .01, 15)
            outline.append((pin_outline(z) * INCH, z * INCH, pin_outline(above) - pin_outline(below), above - below))
        if high == 15:
            outline[-1] = (0, 15 * INCH, -1, 0)
        (red if k in (1, 3) else white).turn(outline)
    sole.turn([(0, 0, 1, 0), (PIN[0][1] / 2 * INCH, 0, 1, 0)])
    write('pin.glb', [white, red, sole], (0, 0, -HEIGHT / 2 * INCH))


def lane():
    """39 boards of 1.05 m, 6 m long, .1 m high; the origin is its middle."""
    r, length, width, high = random.Random(7), 6, 1.05, .1
    woods = [Part(c, .12) for c in ('#d9b27c', '#d0a66c', '#dfbb88', '#c99d64')]
    dark, side = Part('#6b3d22', .12), Part('#5b4634', .5)
    for k in range(39):
        y0, y1 = (-width / 2 + width * i / 39 for i in (k, k + 1))
        r.choice(woods).flat((-length / 2, y0, high / 2), (length / 2, y0, high / 2), (length / 2, y1, high / 2), (-length / 2, y1, high / 2))
    for k in range(-3, 4): # arrows that lie in the wood
        y, x = k * width * 5 / 39, -.6 - .18 * abs(k)
        dark.flat((x, y, high / 2 + .0006), (x - .16, y + .018, high / 2 + .0006), (x - .12, y, high / 2 + .0006), (x - .16, y - .018, high / 2 + .0006))
    side.box((-length / 2, -width / 2, -high / 2), (length / 2, width / 2, high / 2 - .0005))
    write('lane.glb', [*woods, dark, side])


def ball():
    """Of radius 1, of two colours, with a ring, so that its turning is seen."""
    halves = Part('#16325c', .08), Part('#1d6fa5', .08)
    ring = Part('#d8dde2', .2, 1)
    cut, n = .12, 16
    arc = lambda a, b: [(math.cos(t), math.sin(t), -math.sin(t), math.cos(t)) for t in (a + (b - a) * k / n for k in range(n + 1))]
    halves[0].turn(arc(-math.pi / 2, -cut), 40)
    ring.turn(arc(-cut, cut), 40)
    halves[1].turn(arc(cut, math.pi / 2), 40)
    write('ball.glb', [*halves, ring])


if __name__ == '__main__':
    pin()
    lane()
    ball()
