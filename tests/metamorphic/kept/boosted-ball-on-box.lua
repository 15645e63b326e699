-- relation boosted seed 29
-- A gliding box was solved differently from a resting one, and a ball that falls on it had another effect.
scene { sleeping = false, duration = 1 }
plane { friction = 0, restitution = 0 }
box { friction = 0, restitution = 0, at = { -.008, .001, .03 }, size = { .08, .1, .06 }, mass = 1 }
sphere { friction = 0, restitution = 0, at = { .008, .004, .2 }, radius = .04, mass = 1 }
