-- Linkages that a motor moves, beside where their parts must be.
local this = case { variants = {
	{
		name = "four-bar", row = 49, title = "Four-bar linkage", duration = 60, compared = true,
		setup = "A crank of 1 m at 5 rad/s moves a coupler and a rocker by hinges that are all parallel, so rows depend on each other; "
			.. "60 s.",
	}, {
		name = "slider-crank", row = 50, title = "Slider-crank", duration = 20, compared = true,
		setup = "A motor turns a crank of .5 m at 5 rad/s; a rod of 1.3 m moves a block on a slide; 20 s.",
	}, {
		name = "furuta", row = 51, title = "Furuta's pendulum under a motor", duration = 5,
		setup = "A torque of .4 N m turns an arm of .5 m about the vertical; at its end hangs a pendulum of 1 m; 5 s.",
	},
} }
scene { title = this.title, duration = this.duration }
local g, rate, root = 9.81, 5, math.sqrt(.5)
local along_y, along_x = rotation(root, -root, 0, 0), rotation(root, 0, root, 0) -- frames with z along these axes
local function middle(a, b) return .5 * (a + b) end

if this.name == "four-bar" then
	local foot = vector(3, 0, 0)
	-- Joint of coupler (3 m) and rocker (2.5 m), with the crank's end at b: where two circles meet.
	local function rocker_end(b)
		local to = foot - b
		local far = to:norm()
		local along = (9 - 6.25 + far * far) / (2 * far)
		local above = math.sqrt(9 - along * along)
		return b + along / far * to + above / far * vector(-to.z, 0, to.x)
	end
	local a, b = vector(0, 0, 0), vector(0, 0, 1)
	local c = rocker_end(b)
	local crank = sphere { radius = .1, mass = 1, at = middle(a, b) }
	local coupler = sphere { radius = .1, mass = 1, at = middle(b, c) }
	local rocker = sphere { radius = .1, mass = 1, at = middle(c, foot) }
	hinge { crank, at = a, q = along_y, motor = { rate = rate } }
	hinge { crank, coupler, at = b, q = along_y }
	hinge { coupler, rocker, at = c, q = along_y }
	hinge { rocker, at = foot, q = along_y }
	lab.held(1e-9, "where two circles meet", function(run)
		local angle = rate * run.time
		return (run[rocker].at - middle(rocker_end(vector(math.sin(angle), 0, math.cos(angle))), foot)):norm()
	end, "error of the rocker's position")
elseif this.name == "slider-crank" then
	local crank, rod = .5, 1.3
	local up = rate * crank -- m/s, of the crank's end
	local a, b, c = vector(0, 0, 0), vector(crank, 0, 0), vector(crank + rod, 0, 0)
	local first = sphere { radius = .1, mass = 1, at = middle(a, b), spin = { 0, -rate, 0 }, velocity = { 0, 0, up / 2 } }
	local second = sphere { radius = .1, mass = 1, at = middle(b, c), spin = { 0, up / rod, 0 }, velocity = { 0, 0, up / 2 } }
	local block = box { size = { .2, .2, .2 }, mass = 2, at = c }
	hinge { first, at = a, q = along_y, motor = { rate = -rate } }
	hinge { first, second, at = b, q = along_y }
	ball { second, block, at = c }
	slider { block, at = c, q = along_x }
	lab.held(1e-9, "r cos + sqrt(l^2 - r^2 sin^2)", function(run)
		local angle = rate * run.time
		local z = crank * math.sin(angle)
		return math.abs(run[block].at.x - crank * math.cos(angle) - math.sqrt(rod * rod - z * z))
	end, "error of the block's position")
else -- a motor turns an arm about the vertical, at whose end a pendulum swings across it
	local arm, torque, m, radius = .5, .4, 1, .1
	local turned = box { size = { 2 * arm, .1, .1 }, mass = 2 }
	local bob = sphere { radius = radius, mass = m, at = { arm, 0, -1 } }
	hinge { turned, at = { 0, 0, 0 }, q = rotation(1, 0, 0, 0), motor = { rate = 1e3, most = torque } }
	hinge { bob, turned, at = { arm, 0, 0 }, q = along_x }
	local i, of_arm = .4 * m * radius * radius, 2 / 3 * (.05 * .05 + arm * arm)
	-- Angles of the arm and of the pendulum from straight down, and their rates.
	local follow = lab.follow(function(y)
		local s, c = math.sin(y[2]), math.cos(y[2])
		local across, both, own = of_arm + m * arm * arm + m * s * s + i, m * arm * c, m + i
		local det = across * own - both * both
		local f = torque - 2 * m * s * c * y[3] * y[4] + m * arm * s * y[4] * y[4]
		local h = m * s * c * y[3] * y[3] - m * g * s
		return { y[3], y[4], (own * f - both * h) / det, (across * h - both * f) / det }
	end, { 0, 0, 0, 0 })
	lab.held(1e-5, "Lagrange's equations, Dormand and Prince's method to 1e-13", function(run)
		local y = follow(run.time)
		local out, along = vector(math.cos(y[1]), math.sin(y[1]), 0), vector(-math.sin(y[1]), math.cos(y[1]), 0)
		return (run[bob].at - (arm * out + math.sin(y[2]) * along + vector(0, 0, -math.cos(y[2])))):norm()
	end)
end
