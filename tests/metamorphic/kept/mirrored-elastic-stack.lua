-- relation mirrored seed 9: off by 8.6e-07, limit 1e-09, at 0.25 s 
scene { gravity = { 0, 0, -9.8100000000000005 }, step = 0.016666666666666666, sleeping = false, duration = 1 }
plane { friction = 0, restitution = 0, normal = { 0, 0, 1 } }
box { friction = 0, restitution = 0, at = { -0.009874941460713757, 0.030328949388789717, 0.13122393307724831 }, size = { 0.38137992763062045, 0.42907767934165558, 0.26244786615449661 }, mass = 1 }
box { friction = 0, restitution = 1, at = { 0.0035364316943235843, 0.016415751164591458, 0.33815608770529315 }, size = { 0.33651235960190395, 0.37507008022281058, 0.15141644310159302 }, mass = 1 }
