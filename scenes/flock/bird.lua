-- Steering as Reynolds has it ("Flocks, herds and schools", 1987): with the neighbours, towards them, not into them.
local sight, room, cruise = 2.5, .9, 4
local turn <const>, damped <const> = .8, .25 -- N m, N m s, for each kg

local calm, flushed = "#3f7cac", "#e4572e"

function on_step(dt)
	local x, y, z = self:position()
	local vx, vy, vz = self:velocity()
	local mass = self:mass()

	-- round the tower, at one's own height
	local r = math.sqrt(x * x + y * y) + 1e-9
	local ax, ay, az = -y / r * cruise - vx, x / r * cruise - vy, 2 * (self.state.height - z) - 1.5 * vz
	ax, ay = ax - x / r * (r - 6), ay - y / r * (r - 6)

	local others = near(sight)
	local count = math.min(#others, 6)
	for i = 1, count do
		local ox, oy, oz = others[i]:position()
		local ux, uy, uz = others[i]:velocity()
		local dx, dy, dz = ox - x, oy - y, oz - z
		local d2 = dx * dx + dy * dy + dz * dz + .01
		local pull = .6 - 4 * room * room * room / (d2 * math.sqrt(d2))
		ax = ax + (pull * dx + .5 * (ux - vx)) / count
		ay = ay + (pull * dy + .5 * (uy - vy)) / count
		az = az + (pull * dz + .5 * (uz - vz)) / count
	end

	local a = math.sqrt(ax * ax + ay * ay + az * az)
	local most = a > 12 and 12 / a or 1
	self:force(mass * ax * most, mass * ay * most, mass * (az * most + 9.81))

	-- the beak goes ahead, and the back to the side from which its weight and the turn are carried
	local fx, fy, fz = self:turned(1, 0, 0)
	local ux, uy, uz = self:turned(0, 0, 1)
	local wx, wy, wz = self:spin()
	local v = math.sqrt(vx * vx + vy * vy + vz * vz) + 1e-9
	local lift = math.sqrt(ax * ax + ay * ay + 9.81 * 9.81)
	local hx, hy, hz = vx / v, vy / v, vz / v
	local lx, ly, lz = ax / lift, ay / lift, 9.81 / lift
	self:torque(mass * (turn * (fy * hz - fz * hy + uy * lz - uz * ly) - damped * wx),
	            mass * (turn * (fz * hx - fx * hz + uz * lx - ux * lz) - damped * wy),
	            mass * (turn * (fx * hy - fy * hx + ux * ly - uy * lx) - damped * wz))
end

function on_contact(other, impulse, point)
	self:colour(flushed)
	self:wake(1)
end

function on_wake()
	self:colour(calm)
end
