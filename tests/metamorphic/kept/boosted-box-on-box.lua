-- relation boosted seed 8
-- The same on a driven box: the speeds used were not the relative ones.
scene { gravity = { 0, 0, -9.81 }, sleeping = false, duration = 1 }
box { friction = 0, restitution = 0, at = { .03, .09, -.2 }, size = { .4, .4, .4 }, static = true }
box { friction = 0, restitution = 0, at = { .2, .2, .3 }, size = { .2, .2, .2 }, q = { .30290670547115711, -.80775121458975241, .50484450911859524, -.030290670547115713 }, mass = 1 }
