-- Newton's cradle, without strings: five elastic spheres in a row, without gravity. As many as come in leave at the
-- other end, as fast as they came; the others rest.
--   -D incoming=1    spheres that come in, 1 to 4
local incoming = param("incoming", 1, { whole = true, min = 1, max = 4, label = "incoming balls" })

scene { title = "Newton's cradle", duration = 3, gravity = { 0, 0, 0 }, sleeping = false }
material "steel" { friction = 0, restitution = 1, density = 7850, colour = "#c3c9d0" }
camera "main" { eye = { 1.32, -8.93, 4.42 }, target = { 2.9, 0, 0 }, fov = 30 }

for i = 1, 5 do
	local moves = i <= incoming
	sphere {
		name = "ball " .. i,
		radius = .5,
		at = { i - 1 + (moves and 0 or .7), 0, 0 },
		velocity = { moves and 1 or 0, 0, 0 },
		material = "steel",
		colour = moves and "#e4572e" or nil,
	}
end
