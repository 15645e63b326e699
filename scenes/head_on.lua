-- Head-on: one body runs into another at rest, without gravity. Momentum and restitution say what comes after:
-- v1 = (1 - e ratio) / (1 + ratio), v2 = (1 + e) / (1 + ratio), in m/s.
--   -D shape=sphere    sphere or box, each 1 m wide
--   -D ratio=1.0       mass of the second over mass of the first
--   -D e=1.0           restitution
local shape = param("shape", "sphere", { "sphere", "box" })
local ratio = param("ratio", 1.0, { min = 1e-6, max = 1e6, label = "ratio of masses" })
local e = param("e", 1.0, { min = 0, max = 1, label = "restitution" })

scene { title = "Head-on pair", duration = 2, gravity = { 0, 0, 0 }, sleeping = false }
camera "main" { eye = { 1.1, -5.15, 2.51 }, target = { 1.1, 0, 0 }, fov = 40 }

local function body(fields)
	fields.restitution = e
	fields.friction = .3
	if shape == "box" then
		fields.size = { 1, 1, 1 }
		box(fields)
	else
		fields.radius = .5
		sphere(fields)
	end
end

body { name = "first", mass = 1000, at = { 0, 0, 0 }, velocity = { 1, 0, 0 } }
body { name = "second", mass = 1000 * ratio, at = { 1.537, 0, 0 } }
