-- expect: :2: box.surface_velocity: expected a static or kinematic object
box { size = { 1, 1, 1 }, surface_velocity = { 1, 0, 0 } }
