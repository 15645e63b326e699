#!/usr/bin/env python3
"""Writes what ../bowling.lua looks like: pin.glb, lane.glb and ball.glb, in the folder of this file.

A binary glTF is a header, its JSON, and one buffer, in which the pictures are, too. Here z points up; in glTF y does.
"""
import json
import math
import pathlib
import random
import struct
import zlib

INCH = .0254
# Heights and diameters of a tenpin (USBC, Equipment Specifications Manual), inches; above the last one it is a ball.
PIN = [(0, 2.031), (.75, 2.828), (2.25, 3.906), (3.375, 4.510), (4.5, 4.766), (5.875, 4.563), (7.25, 3.703), (8.625, 2.472), (9.375, 1.965),
       (10, 1.797), (10.875, 1.870), (11.75, 2.094), (12.625, 2.406), (13.5, 2.547)]
HEIGHT, HEAD = 15, 1.273


class Part:
    """Triangles of one material: sRGB colour, roughness, metal, and the PNG on it, which multiplies the colour."""

    def __init__(self, colour, roughness, metal=0, picture=None):
        self.colour, self.roughness, self.metal, self.picture = colour, roughness, metal, picture
        self.vertices, self.triangles, self.places = [], [], []

    def vertex(self, p, n, place=(0, 0)):
        """place: in the picture, from its upper left corner."""
        length = math.hypot(*n)
        self.vertices.append((*p, *(x / length for x in n)))
        self.places.append(place)
        return len(self.vertices) - 1

    def quad(self, a, b, c, d):
        self.triangles += [(a, b, c), (a, c, d)]

    def flat(self, *corners, places=None):
        """A convex polygon, counterclockwise from outside."""
        u, v = ([b - a for a, b in zip(corners[0], corners[k])] for k in (1, 2))
        n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        i = [self.vertex(c, n, place) for c, place in zip(corners, places or [(0, 0)] * len(corners))]
        self.triangles += [(i[0], i[k], i[k + 1]) for k in range(1, len(i) - 1)]

    def turn(self, profile, segments=40):
        """Turned on a lathe: (radius, height, slope of the outline as dr, dz) from below. Round it goes the picture, once."""
        rings = []
        for i, (r, z, dr, dz) in enumerate(profile):
            turns = [2 * math.pi * k / segments for k in range(segments)]
            up = 1 - i / (len(profile) - 1)
            shift = 0 if r > 1e-9 else math.copysign(.5, -z) # moves the tip of each triangle at a pole to the middle of its base
            rings.append([self.vertex((r * math.cos(t), r * math.sin(t), z), (dz * math.cos(t), dz * math.sin(t), -dr), ((k + shift) / segments, up))
                          for k, t in enumerate(turns + turns[:1] * (self.picture is not None))])
        for low, high in zip(rings, rings[1:]):
            for k in range(segments):
                self.quad(low[k], low[(k + 1) % len(low)], high[(k + 1) % len(high)], high[k])

    def box(self, low, high):
        at = lambda k: tuple(high[i] if k >> i & 1 else low[i] for i in range(3))
        for face in ((1, 3, 7, 5), (0, 4, 6, 2), (2, 6, 7, 3), (0, 1, 5, 4), (4, 5, 7, 6), (0, 2, 3, 1)):
            self.flat(*map(at, face))


def write(name, parts, place=(0, 0, 0)):
    """place: position of the model in the file, as the translation of its node."""
    linear = lambda c: ((c + .055) / 1.055) ** 2.4 if c > .04045 else c / 12.92
    buffer, views, accessors, primitives, materials, images = b'', [], [], [], [], []

    def view(data):
        nonlocal buffer
        views.append({'buffer': 0, 'byteOffset': len(buffer), 'byteLength': len(data)})
        buffer += data + bytes(-len(data) % 4)
        return len(views) - 1

    def put(data, count, kind, component, **more):
        accessors.append({'bufferView': view(data), 'componentType': component, 'count': count, 'type': kind, **more})
        return len(accessors) - 1

    def texture(picture):
        if picture not in pictures:
            pictures.append(picture)
            images.append({'bufferView': view(picture), 'mimeType': 'image/png'})
        return {'index': pictures.index(picture)}

    pictures = []

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
        if part.picture:
            materials[-1]['pbrMetallicRoughness']['baseColorTexture'] = texture(part.picture)
            places = b''.join(struct.pack('<2f', *p) for p in part.places)
            primitives[-1]['attributes']['TEXCOORD_0'] = put(places, len(part.places), 'VEC2', 5126)
    shown = {'images': images, 'textures': [{'source': i} for i in range(len(images))]} if images else {}
    text = json.dumps({'asset': {'version': '2.0', 'generator': 'obsim scenes/bowling/make.py'}, 'scene': 0, 'scenes': [{'nodes': [0]}],
                       'nodes': [{'mesh': 0, 'translation': upright(*place)}], 'meshes': [{'primitives': primitives}], 'materials': materials,
                       'accessors': accessors, 'bufferViews': views, 'buffers': [{'byteLength': len(buffer)}], **shown}, separators=(',', ':')).encode()
    text += b' ' * (-len(text) % 4)
    chunks = struct.pack('<II', len(text), 0x4e4f534a) + text + struct.pack('<II', len(buffer), 0x004e4942) + buffer
    (pathlib.Path(__file__).parent / name).write_bytes(struct.pack('<4sII', b'glTF', 2, 12 + len(chunks)) + chunks)


def png(width, height, palette, pixel):
    """palette: its sRGB colours; pixel(x, y): the number of one of them."""
    rows = b''.join(b'\0' + bytes(pixel(x, y) for x in range(width)) for y in range(height))
    chunk = lambda kind, data: struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, 8, 3, 0, 0, 0)) + chunk(b'PLTE', bytes(sum(palette, ())))
            + chunk(b'IDAT', zlib.compress(rows, 9)) + chunk(b'IEND', b''))


def ramp(count, *stops):
    """So many colours, evenly between these."""
    rgb = [[int(c[k:k + 2], 16) for k in (1, 3, 5)] for c in stops]
    out = []
    for i in range(count):
        at = i / (count - 1) * (len(rgb) - 1)
        k = min(int(at), len(rgb) - 2)
        out.append(tuple(round(a + (b - a) * (at - k)) for a, b in zip(rgb[k], rgb[k + 1])))
    return out


class Noise:
    """Smooth, from -1 to 1, of period "period" in each coordinate."""

    def __init__(self, seed, period):
        r = random.Random(seed)
        self.period, self.values = period, {}
        self.draw = lambda: r.uniform(-1, 1)
        for at in self.cells((0,) * len(period), period):
            self.values[at] = self.draw()

    @staticmethod
    def cells(low, high):
        out = [()]
        for a, b in zip(low, high):
            out = [c + (k,) for c in out for k in range(a, b)]
        return out

    def __call__(self, *at):
        whole = [math.floor(x) for x in at]
        share = [x - w for x, w in zip(at, whole)]
        share = [s * s * (3 - 2 * s) for s in share]
        sum_ = 0
        for corner in self.cells((0,) * len(at), (2,) * len(at)):
            weight = math.prod(s if c else 1 - s for c, s in zip(corner, share))
            sum_ += weight * self.values[tuple((w + c) % p for w, c, p in zip(whole, corner, self.period))]
        return sum_


def grain():
    """Eight boards of wood, one above the other, with the gaps between them; it goes on along the boards."""
    width, height, shades = 512, 128, 48
    long, fine, rings = Noise(3, (8, 8)), Noise(4, (32, 128)), Noise(5, (6, 64))

    def pixel(x, y):
        board, across = divmod(y, 16)
        u = x / width
        waves = math.sin(2 * math.pi * (across / 7 + 1.3 * rings(6 * u, 8 * board + across / 8)))
        bright = .72 + .1 * long(8 * u, board) + .1 * waves + .14 * fine(32 * u, y)
        if across in (0, 15):
            bright *= .66
        return round(max(0, min(1, bright)) * (shades - 1))

    return png(width, height, ramp(shades, '#6a4a32', '#c9b299', '#ffffff'), pixel)


def marble():
    """Picture of a ball: swirls, and three holes."""
    width, height, shades = 512, 256, 63
    warp = [Noise(seed, (8, 8, 8)) for seed in (11, 12, 13)]
    veins = Noise(14, (16, 16, 16))
    holes = [(math.cos(b) * math.cos(a), math.cos(b) * math.sin(a), math.sin(b)) for a, b in ((2.6, .47), (2.88, .47), (2.74, .03))]

    def pixel(x, y):
        turn, down = 2 * math.pi * (x + .5) / width, math.pi * (y + .5) / height
        p = (math.sin(down) * math.cos(turn), math.sin(down) * math.sin(turn), math.cos(down))
        if any(math.dist(p, h) < .1 for h in holes):
            return shades
        q = [2.2 * c + 1.6 * w(*(1.5 * c for c in p)) for c, w in zip(p, warp)]
        swirl = .5 + .5 * math.sin(3.5 * (q[0] + q[1]) + 5 * veins(*q))
        return round(swirl ** 1.6 * (shades - 1))

    return png(width, height, ramp(shades, '#0e2148', '#143a70', '#1f5a96', '#5b97c4') + [(9, 9, 12)], pixel)


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
    wood = grain()
    woods = [Part(c, .12, picture=wood) for c in ('#f0cf9f', '#e8c48f', '#f6dab0', '#e0b980')]
    dark, side = Part('#6b3d22', .12), Part('#5b4634', .5)
    for k in range(39):
        y0, y1 = (-width / 2 + width * i / 39 for i in (k, k + 1))
        u, v = r.random(), r.randrange(8) / 8
        r.choice(woods).flat((-length / 2, y0, high / 2), (length / 2, y0, high / 2), (length / 2, y1, high / 2), (-length / 2, y1, high / 2),
                             places=[(u, v + 1 / 8), (u + 2.5, v + 1 / 8), (u + 2.5, v), (u, v)])
    for k in range(-3, 4): # arrows that lie in the wood
        y, x = k * width * 5 / 39, -.6 - .18 * abs(k)
        dark.flat((x, y, high / 2 + .0006), (x - .16, y + .018, high / 2 + .0006), (x - .12, y, high / 2 + .0006), (x - .16, y - .018, high / 2 + .0006))
    side.box((-length / 2, -width / 2, -high / 2), (length / 2, width / 2, high / 2 - .0005))
    write('lane.glb', [*woods, dark, side])


def ball():
    """Of radius 1."""
    whole, n = Part('#ffffff', .08, picture=marble()), 32
    whole.turn([(math.cos(t), math.sin(t), -math.sin(t), math.cos(t)) for t in (math.pi * (k / n - .5) for k in range(n + 1))], 48)
    write('ball.glb', [whole])


if __name__ == '__main__':
    pin()
    lane()
    ball()
