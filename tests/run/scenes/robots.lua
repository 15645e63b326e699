-- All that joints, compounds and terrain have: what hundred runs must end with the same bits of.
scene { title = "Robots", duration = 2.5 }
heightfield { name = "hills", size = { 12, 12 }, cells = { 24, 24 }, friction = .8,
	height = function(x, y) return .15 * math.sin(1.3 * x) * math.cos(1.1 * y) end }

-- a ragdoll whose limbs are joined by all that balls, crosses and hinges have; its trunk is a compound of round parts
compound { name = "trunk", at = { 0, 0, 2.2 }, rotation = { axis = { 1, .3, 0 }, degrees = 40 }, friction = .8, density = 900, parts = {
	{ shape = "capsule", radius = .13, length = .4 }, { radius = .11, at = { 0, 0, .5 } }, { size = { .2, .3, .1 }, at = { 0, 0, -.2 } } } }
for i, side in ipairs { -1, 1 } do
	local n = side < 0 and "left " or "right "
	capsule { name = n .. "arm", radius = .05, length = .3, at = { 0, .4 * side, 2.4 }, density = 900 }
	capsule { name = n .. "thigh", radius = .07, length = .3, at = { 0, .15 * side, 1.6 }, density = 900 }
	capsule { name = n .. "shin", radius = .06, length = .3, at = { 0, .15 * side, 1.1 }, density = 900 }
	ball { n .. "arm", "trunk", at = { 0, .2 * side, 2.4 }, high = 1.3, restitution = .3, stiffness = 3, damping = .4, armature = .01 }
	universal { n .. "thigh", "trunk", at = { 0, .15 * side, 1.85 }, axis = { 1, 0, 0 }, across = { 0, 1, 0 }, low = -1, high = 1, friction = .4,
		second = { low = -1.2, high = 1.2, friction = .4, damping = .1 } }
	hinge { n .. "shin", n .. "thigh", at = { 0, .15 * side, 1.35 }, axis = { 0, 1, 0 }, low = -.1, high = 2, friction = .3 }
end

-- a car whose motor a script sets, and wheels that are compounds
box { name = "car", size = { 1.2, .5, .2 }, at = { -3, 2, .7 }, density = 300, script = [[
	function on_start() self:wake(1) end
	function on_wake() for i = 1, 4 do motor("axle" .. i, 6) end end
]] }
for i = 1, 4 do
	local at = { -3 + (i % 2 == 0 and .45 or -.45), 2 + (i > 2 and .4 or -.4), .6 }
	compound { name = "wheel" .. i, at = at, rotation = { axis = { 1, 0, 0 }, degrees = 90 }, friction = .9, density = 400, parts = {
		{ shape = "cylinder", radius = .25, length = .12 }, { radius = .1 } } }
	hinge { "wheel" .. i, "car", name = "axle" .. i, at = at, axis = { 0, 1, 0 }, motor = { rate = -3, most = 60 } }
end

-- a chain that breaks, a lift, a scale, a door that a kinematic post carries
for i = 1, 5 do
	box { name = "link" .. i, size = { .1, .1, .3 }, at = { 3, -2, 4.2 - .4 * i } }
	ball { "link" .. i, i > 1 and "link" .. i - 1 or nil, at = { 3, -2, 4.4 - .4 * i }, breaks_at = { force = i == 3 and 260 or 900 } }
end
sphere { name = "weight", radius = .2, at = { 3, -2, 1.85 }, mass = 20 }
ball { "weight", "link5", at = { 3, -2, 2.05 } }
box { name = "lift", size = { .8, .8, .1 }, at = { 3, 3, .6 }, density = 300 }
slider { "lift", axis = { 0, 0, 1 }, low = 0, high = .6, motor = { rate = .5, most = 900 } }
sphere { name = "rider", radius = .2, at = { 3, 3, .86 } }
box { name = "scale", size = { .6, .6, .1 }, at = { -3, -3, 1 }, density = 300 }
slider { "scale", axis = { 0, 0, 1 }, stiffness = 2000, damping = 120, low = -.4 }
capsule { name = "rod", radius = .1, length = .3, at = { -3, -3, 1.6 }, rotation = { axis = { 0, 1, 0 }, degrees = 80 } }
box { name = "post", size = { .1, .1, 1 }, at = { 0, -4, 1 }, kind = "kinematic", spin = { 0, 0, 1 } }
box { name = "door", size = { .8, .05, .9 }, at = { .5, -4, 1 } }
hinge { "door", "post", at = { .07, -4, 1 }, axis = { 0, 0, 1 }, low = -1, high = 1, restitution = .5 }
sphere { name = "bob", radius = .1, at = { 0, 4, 2 }, dies = 1.7 }
distance { "bob", to = { 0, 4, 3 }, stiffness = 200, damping = 2, rest = .9, low = .5, high = 1.4 }
sphere { name = "end", radius = .1, at = { .5, 4, 2 } }
fixed { "end", "bob" }
