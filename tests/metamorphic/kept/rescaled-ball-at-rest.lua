-- relation rescaled seed 11
-- Thresholds in metres and in m/s were the same for a run in other units.
scene { sleeping = false, duration = 1 }
plane { friction = 0, restitution = 0 }
sphere { friction = 0, restitution = 0, at = { 0, 12.2, .473 }, radius = .473, mass = 1 }
