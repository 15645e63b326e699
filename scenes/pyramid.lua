-- Pyramid: a wall of unit cubes, each row one shorter than the row below. It must stand.
--   -D rows=10    rows; rows * (rows + 1) / 2 cubes
local rows = param("rows", 10, { whole = true, min = 1, max = 100 })

scene { title = "Pyramid of " .. rows .. " rows", duration = 20, sleeping = false }
ground {}
camera "main" { from = { -.35, -1, .52 }, fov = 32 }

local colours = { "#e4572e", "#f3a712", "#29a19c", "#3f7cac" }

for row = 1, rows do
	local count = rows - row + 1
	for i = 1, count do
		box {
			size = { 1, 1, 1 },
			at = { (i - (count + 1) / 2) * 1.05, 0, row - .5 },
			colour = colours[(row - 1) % #colours + 1],
		}
	end
end
