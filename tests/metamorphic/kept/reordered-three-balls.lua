-- relation reordered seed 41
-- Three balls that touch at once: their ids decided the order of the contacts.
scene { gravity = { 0, 0, 0 }, sleeping = false, duration = 1 }
sphere { friction = 0, restitution = 0, at = { -2.05, -2.26, -1.62 }, radius = .364, mass = 1, velocity = { 12.6, 12.3, 12.5 } }
sphere { friction = 0, restitution = 0, at = { 2.3, -2.1, -1.7 }, radius = .38, mass = 1, velocity = { -14, 11, 9.5 } }
sphere { friction = 0, restitution = 0, at = { -2.3, -1.6, 2.3 }, radius = .65, mass = 290, velocity = { 9.3, 8.6, -15 } }
