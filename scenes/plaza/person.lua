-- A person: stands upright by a torque, walks where it wants to by a force, and greets whom it touches.
local STIFF, DAMPED = 2600, 420 -- N m, N m s
local PULL, STRONGEST = 5, 520 -- 1/s, N
local STRIDE, TURN = 2.2, 2.2 -- m/s, rad/s: of a visitor's person

local function choose(me)
	local angle, r = random(0, 2 * math.pi), random(2.6, me.state.far)
	me.state.x, me.state.y = r * math.cos(angle), r * math.sin(angle)
end

function on_start()
	choose(self)
	self:wake(random(2, 9))
end

function on_wake()
	choose(self)
	self:colour(self.state.colour)
	self:wake(random(4, 10))
end

-- A walk that was asked for, by a viewer or a program; it goes on until another is. walk: velocity, m/s. go: ahead and to the
-- left, parts of the most.
function on_message(from, what, x, y)
	if what == "walk" then
		self.state.led, self.state.vx, self.state.vy, self.state.ahead = true, x, y, nil
	elseif what == "go" then
		self.state.led, self.state.ahead, self.state.left = true, x, y
	elseif what == "greet" then
		self:colour("#ffd166")
		self:wake(1)
		for _, other in ipairs(near(3)) do
			if other:name():sub(1, 6) == "person" then
				send(other, "hello")
			end
		end
	elseif what == "hello" then
		self:colour("#ffd166")
	end
end

function on_contact(other, impulse)
	if other:exists() and other:name():sub(1, 6) == "person" then
		send(other, "hello")
		choose(self)
	end
end

local function wanted(me, x, y)
	if me.state.ahead then
		local fx, fy = me:turned(STRIDE * me.state.ahead, 0, 0)
		return fx, fy
	elseif me.state.led then
		return me.state.vx, me.state.vy
	end
	local dx, dy = me.state.x - x, me.state.y - y
	local far = math.sqrt(dx * dx + dy * dy)
	if far < .5 then
		return 0, 0
	end
	local nx, ny = dx / far, dy / far
	local r = math.sqrt(x * x + y * y)
	if r < 2.6 and nx * x + ny * y < 0 then -- round the fountain
		nx, ny = -y / r + .3 * x / r, x / r + .3 * y / r
	end
	return me.state.speed * nx, me.state.speed * ny
end

function on_step(dt)
	local x, y = self:position()
	local vx, vy = self:velocity()
	local ux, uy, uz = self:turned(0, 0, 1)
	local wx, wy, wz = self:spin()
	local gx, gy = wanted(self, x, y)
	-- towards where it goes: the body's x axis, about the vertical
	local fx, fy = self:turned(1, 0, 0)
	local turn = (gx * gx + gy * gy > .01) and 60 * (fx * gy - fy * gx) or 0
	if self.state.ahead then
		turn = 30 * TURN * self.state.left
	end
	self:torque(STIFF * uy - DAMPED * wx, -STIFF * ux - DAMPED * wy, turn - 30 * wz)
	local m = self:mass()
	local ax, ay = PULL * m * (gx - vx), PULL * m * (gy - vy)
	local a = math.sqrt(ax * ax + ay * ay)
	local share = a > STRONGEST and STRONGEST / a or 1
	self:force(ax * share, ay * share, 0)
end
