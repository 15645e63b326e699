-- relation mirrored seed 7
-- Lever arms were rounded along the world's axes between two steps.
scene { sleeping = false, duration = 1 }
plane { friction = .401, restitution = 0 }
sphere { friction = .3, restitution = 0, at = { 0, 0, .08 }, radius = .08, mass = 1, velocity = { .2, -.0007, 0 } }
