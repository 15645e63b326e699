scene { step = 1/120 }
ground {}
box { name = 'base', size = { .4, .4, .2 }, at = { 0, 0, .1 }, static = true }
box { name = 'arm', size = { .05, .05, 1 }, at = { 0, 0, .7 }, mass = .5 }
hinge { 'arm', 'base', name = 'shoulder', at = { 0, 0, .2 }, axis = { 0, 1, 0 }, motor = { rate = 0, most = 20 } }
for i = 1, 6 do sphere { name = 'ball' .. i, radius = .1, at = { math.sin(i), math.cos(i), .2 + i ^ .5 } } end
imu { on = 'arm', at = { 0, 0, .4 }, rate = 200, noise = .02 }
