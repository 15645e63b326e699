-- relation boosted seed 17
-- The centripetal acceleration of the paddle at this distance counted like gravity, so that no hit was fast enough.
scene { gravity = { 0, 0, 0 }, sleeping = false, duration = 1 }
sphere { friction = 0, restitution = 0, at = { .0615, .0785, -.0656 }, radius = .0151, mass = 1, velocity = { -.109, -.0729, .11 } }
box { friction = 0, restitution = .3511, size = { .04674, .04756, .0562 }, q = { .55810994002654868, .37400666111795233, -.42460756232802821, .60691080917776807 }, kind = "kinematic", spin = { 135.7, 54.59, -179.6 } }
