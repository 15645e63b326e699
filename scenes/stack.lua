-- Stack: unit cubes of 1000 kg on top of each other, each a few millimetres off. It must stand.
--   -D n=10           how many cubes
--   -D offset=0.01    m, how far off at most
local n = param("n", 10, { whole = true, min = 1, max = 1000, label = "boxes" })
local offset = param("offset", .01, { min = 0, max = .4, unit = "m" })

scene { title = "Stack of " .. n, duration = 20, sleeping = false }
ground {}

for i = 1, n do
	box {
		size = { 1, 1, 1 },
		at = { random(-offset, offset), random(-offset, offset), i - .5 },
		mass = 1000,
		friction = .5,
	}
end
