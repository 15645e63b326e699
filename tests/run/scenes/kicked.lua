-- Boxes that are kicked in flight, in a small room and in long steps: many pairs are checked again and again.
scene { step = 1/15, seed = 3, room = 4, sleeping = false }
script("kicker", [[
function on_start() self:wake(random(.05, .4)) end
function on_wake()
	self:push(self:mass() * random(-3, 3), self:mass() * random(-3, 3), self:mass() * random(0, 4))
	self:wake(random(.1, .5))
end
]])
plane { normal = { 0, 0, 1 }, at = { 0, 0, -.5 } }
for i = 0, 47 do
	box { size = { random(.3, .6), random(.3, .6), random(.3, .6) }, at = { i % 4 - 1.5, i // 4 % 4 - 1.5, i // 16 * .9 + .5 },
		spin = { random(-5, 5), random(-5, 5), random(-5, 5) }, restitution = .3, script = i % 3 == 0 and "kicker" or nil }
end
