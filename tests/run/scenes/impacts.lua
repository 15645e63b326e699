-- With --narrow aabb: boxes and cylinders overlap by a kilometre, and hit at all their points, without end. Most of the
-- work is impacts.
scene { gravity = { 0, 0, -9.81 } }
plane { normal = { -1, 0, .01 } }
box { restitution = 5e-6, size = { 2, .5, .0025 }, at = { 3, 0, 0 }, density = 1000 }
cylinder { at = { -3, 3, 0 }, length = .4, radius = .8 }
box { size = { 1e6, .2, .7 }, restitution = 3.6e-5, at = { -1.2, .7, 0 }, spin = { -1.5, -1.5, -5 } }
cylinder { at = { 3, .3, .5 }, length = 1e6, radius = 1.8 }
