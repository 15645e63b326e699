-- A pole on a cart, which is pushed along a rail so that the pole stays up: obsim.gym.
scene { title = "Cart and pole", duration = 10, step = 1/50 }
camera "main" { eye = { 0, -6, 2 }, target = { 0, 0, 1.2 } }

local speed, turn = random(-.3, .3), random(-.3, .3)
ground {}
box { name = "cart", size = { .4, .2, .1 }, at = { 0, 0, 1 }, mass = 1, velocity = { speed, 0, 0 } }
slider { "cart", name = "rail", axis = { 1, 0, 0 } }
box { name = "pole", size = { .05, .05, 1 }, at = { 0, 0, 1.55 }, mass = .1, velocity = { speed + turn / 2, 0, 0 }, spin = { 0, turn, 0 } }
hinge { "pole", "cart", name = "foot", at = { 0, 0, 1.05 }, axis = { 0, 1, 0 } }
