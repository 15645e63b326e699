-- relation boosted seed 29
-- A box that glides was not solved as one that stands, and a ball that falls on it was felt otherwise.
scene { sleeping = false, duration = 1 }
plane { friction = 0, restitution = 0 }
box { friction = 0, restitution = 0, at = { -.008, .001, .03 }, size = { .08, .1, .06 }, mass = 1 }
sphere { friction = 0, restitution = 0, at = { .008, .004, .2 }, radius = .04, mass = 1 }
