-- relation boosted seed 6
-- Paths were counted in the world frame, so that a group that travels as a whole was tested in other steps.
scene { gravity = { 0, 0, 0 }, sleeping = false, duration = 1 }
box { friction = 0, restitution = 0, at = { .6, -.6, -.6 }, size = { .4, .4, .4 }, mass = 1, velocity = { -1, .8, 1 } }
sphere { friction = 0, restitution = 0, at = { -.51, -.5, .46 }, radius = .15, mass = 1, velocity = { 1.4, 1.1, -1.5 } }
