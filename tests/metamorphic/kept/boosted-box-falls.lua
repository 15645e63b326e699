-- relation boosted seed 2
-- The faster a box went along the ground, the fewer of its contacts were found at the midpoint, and the farther it looked
-- for points when it hit.
scene { gravity = { 0, 0, -9.81 }, sleeping = false, duration = 1 }
plane { friction = 0, restitution = 0 }
box { friction = 0, restitution = 0, at = { -.3, .3, .6 }, size = { .2, .2, .2 }, q = { -.20306923302672378, -.20306923302672378, -.50767308256680943, .81227693210689511 }, mass = 1 }
