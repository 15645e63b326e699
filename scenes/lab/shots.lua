-- Fast bodies must not pass through thin ones: boxes at a wall, and at each other. A hundred aims share a world, each in a lane of its
-- own, 40 m from the next; a run has one speed. Every box would be at its aim 3 to 4 m from its start.
local wall_speed, bullet_speed = { 10, 30, 100, 300, 1000 }, { 200, 500, 1000 }
local this = case { variants = {
	{
		name = "thin-wall", row = 18, title = "Thin wall", duration = .6, runs = 5,
		setup = "Boxes of .2 m fly at a fixed wall of 20 mm, turned and aimed at random: 100 aims at each of 10, 30, 100, 300 and "
			.. "1000 m/s.",
		others = "ODE 77 to 100 of 100",
	}, {
		name = "bullets", row = 19, title = "Two bullets head-on", duration = .15, runs = 3,
		setup = "Boxes of .2 m fly at each other, turned and aimed at random: 100 pairs at each of +-200, 500 and 1000 m/s.",
		others = "Box3D 75 to 100 of 100, Jolt 2 to 100",
	},
} }
scene { title = this.title, duration = this.duration, gravity = { 0, 0, 0 } }
local walls = this.name == "thin-wall"
local speeds = walls and wall_speed or bullet_speed
local speed, aims, lane, wall_half, far = speeds[this.run + 1], 100, 40, 4, 5 -- far: m travelled: by then it has hit
local random = lab.splitmix((walls and 18 or 19) + this.run)
local function middle_of(aim) return vector(0, lane * (aim % 10), lane * (aim // 10)) end

-- A box with random attitude and spin, up to a tenth off course, so that its centre would be at the target after so many metres.
local function shoot(target, velocity, way)
	local off = random.vector(.1 * math.abs(velocity))
	local v = vector(velocity, off.y, off.z)
	local spin = random.vector(1)
	return box { size = { .2, .2, .2 }, mass = 8, at = target + -way / math.abs(velocity) * v, velocity = v, spin = spin,
		q = random.rotation(), friction = .3 }
end

local a, b, hit, passed = {}, {}, {}, {}
for i = 0, aims - 1 do
	if walls then
		a[i] = box { size = { .02, 2 * wall_half, 2 * wall_half }, at = middle_of(i), friction = .3, static = true }
		local off = random.vector(.25)
		local way = random.within(3, 4)
		b[i] = shoot(middle_of(i) + vector(0, off.y, off.z), speed, way)
	else
		local off = random.vector(.05)
		local way = random.within(3, 4)
		a[i] = shoot(middle_of(i), speed, way)
		b[i] = shoot(middle_of(i) + vector(0, off.y, off.z), -speed, way)
	end
end

watch(function(run)
	if run.time > far / speed + 4 * run.step then return end
	for i = 0, aims - 1 do
		local p, q = run[a[i]], run[b[i]]
		if walls then -- half inside is as bad as through; beyond the wall's rim, positions do not count
			local off = q.at - p.at
			local beside = math.abs(off.y) > wall_half or math.abs(off.z) > wall_half
			if q.velocity.x < .99 * speed then hit[i] = true end
			if off.x > -.05 and not beside then passed[i] = true end
		elseif p.velocity.x - q.velocity.x < 1.8 * speed then
			hit[i] = true
		elseif p.at.x > q.at.x then -- their sides are swapped; a pair that hits and then slips past each other is slower
			passed[i] = true
		end
	end
end)
for run_of, at in ipairs(speeds) do
	expect { "passes of 100 at " .. at .. " m/s", below = 0, source = "a solid body passes through none", function(run)
		local through, missed = 0, 0
		for i = 0, aims - 1 do
			if passed[i] then through = through + 1 end
			if not hit[i] then missed = missed + 1 end
		end
		if through > 0 then run:fail("passed through") elseif missed > 0 then run:fail("never arrived") end
		return run_of == this.run + 1 and math.max(through, missed) or 0
	end }
end
