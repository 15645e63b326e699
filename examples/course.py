#!/usr/bin/env python3
"""A car finds its way round a course by its lidar: it turns to where the beams reach farthest, and goes faster the farther they do.
Its camera looks out for walls: within half a metre ahead it goes slowly. Drives a lap, and says how long it took; exit 1 if it was
stuck, or against a wall. course.py lap.h5: records it, camera and all. The scene is the first half of this file."""
import sys
import tempfile

import numpy

import obsim

SCENE = """
scene { title = "A lap by lidar", step = 1/120, duration = 90 }
ground { friction = 1 }
local points = 48
local function place(i, aside) -- of a closed curve, so far to its right
	local a = 2 * math.pi * i / points
	local r = 7 + 1.6 * math.cos(2 * a) + .9 * math.sin(3 * a) + aside
	return r * math.cos(a), r * math.sin(a)
end
for _, aside in ipairs { -1.3, 1.3 } do
	for i = 0, points - 1 do
		local x, y = place(i, aside)
		local u, v = place(i + 1, aside)
		box { name = "wall " .. i .. " " .. aside, size = { ((u - x) ^ 2 + (v - y) ^ 2) ^ .5 + .1, .1, .6 }, at = { (x + u) / 2, (y + v) / 2, .3 },
			rotation = { axis = { 0, 0, 1 }, degrees = math.deg(math.atan(v - y, u - x)) }, static = true, colour = "#8d99ae" }
	end
end
local x, y = place(0, 0)
box { name = "car", size = { .36, .6, .14 }, at = { x, y, .17 }, mass = 6, colour = "#d1495b" } -- it looks along y
for side, aside in pairs { left = -.22, right = .22 } do
	cylinder { name = side, radius = .14, length = .06, at = { x + aside, y - .15, .14 }, mass = .5,
		rotation = { axis = { 0, 1, 0 }, degrees = 90 }, friction = 1.2 }
	hinge { side, "car", name = side, at = { x + aside, y - .15, .14 }, axis = { 1, 0, 0 }, motor = { rate = 0, most = 1.2 } }
end
sphere { name = "caster", radius = .07, at = { x, y + .22, .07 }, mass = .2, friction = 0 }
fixed { "caster", "car" }
lidar { on = "car", name = "lidar", at = { 0, .2, .12 }, rotation = { axis = { 0, 0, 1 }, degrees = 90 }, beams = 61, fan = 160,
	reach = 8, rate = 20, noise = .02, delay = .02 }
camera { on = "car", name = "eye", at = { 0, .3, .12 }, rotation = { axis = { 0, 0, 1 }, degrees = 90 }, width = 64, height = 36,
	fov = 50, rate = 10 }
record { every = 12 }
camera "main" { eye = { 0, -14, 13 }, target = { 0, -.5, 0 } }
"""


def drive(u):
    """Drives until the car is round, or 90 s have passed. Returns the time, and True if it has touched no wall."""
    lidar, eye, left, right = u.sensors['lidar'], u.sensors['eye'], u.joints['left'], u.joints['right']
    walls = {o.id for o in u if o.name.startswith('wall')}
    round_, before, clean = 0., None, True
    angles = lidar.angles[6:-6]
    u.step(12) # until a first sample can be read
    while u.time < 90 and round_ < 2 * numpy.pi:
        u.step(6) # 20 times a second
        reach = numpy.minimum(lidar.value, 8)
        open_ = numpy.min([numpy.roll(reach, k) for k in range(-6, 7)], axis=0)[6:-6] # room for the car beside the beam
        way = angles[numpy.argmax(open_ - .5 * numpy.abs(angles))]
        walls_seen = numpy.isin(eye.value['id'][:, 24:40], list(walls)) # in the middle of the picture
        near = eye.value['depth'][:, 24:40][walls_seen].min(initial=8)
        speed, turn = min(2 if near > .5 else .5, .5 * open_.max()), 2.5 * way # m/s, rad/s
        u.set_motors([left, right], [-(speed - .22 * turn) / .14, -(speed + .22 * turn) / .14])
        clean &= not any(a in walls or b in walls for a, b in zip(u.contacts['a'], u.contacts['b']))
        place = complex(*u['car'].position[:2])
        round_ += numpy.angle(place / before) if before else 0
        before = place
    return u.time, clean and round_ >= 2 * numpy.pi


def main():
    with tempfile.NamedTemporaryFile('w', suffix='.lua') as f:
        f.write(SCENE)
        f.flush()
        with obsim.run(f.name, {'record': sys.argv[1]} if sys.argv[1:] else {}, inside=True) as u:
            time, good = drive(u)
            print(f'a lap in {time:.1f} s' if good else f'stuck, or against a wall, after {time:.1f} s')
            return good


if __name__ == '__main__':
    sys.exit(not main())
