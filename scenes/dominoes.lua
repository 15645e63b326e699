-- Four hundred dominoes in a spiral, and a ball that rolls into the first: the wave runs inwards for forty seconds.
-- Islands come and go with it: obsim run dominoes --colour-by island --out dominoes.mp4
--   -D n=400          how many
--   -D gap=.105       m, from one to the next
local n = param("n", 400, { whole = true, min = 2, max = 5000, label = "dominoes" })
local gap = param("gap", .105, { min = .03, max = .2, unit = "m" })
local width, thick, height = .14, .035, .24

scene { title = n .. " dominoes", duration = 44 }
ground { colour = "#d9d2c3", grid = false }
sky { top = "#6fa3d6", horizon = "#f1e9dc" }
sun { towards = { -.7, -.5, .75 } }
material "domino" { friction = .35, restitution = .05, density = 700, roughness = .25 }
material "steel" { friction = .3, density = 7800, colour = "#c8ccd2" }

-- Archimedes' spiral from outside inwards; the turns are `lane` apart.
local lane, angle = .34, 0
local inner = .62
local length = n * gap
local r = math.sqrt(inner * inner + length * lane / math.pi)
local outer = r
camera "main" { eye = { -.44 * outer, -2.2 * outer, 1.45 * outer }, target = { 0, -.12 * outer, 0 }, fov = 36 }
camera "close" { eye = { -outer - .9, -1.3, .75 }, target = { -outer + .35, .2, .05 }, fov = 42 }

-- From light amber by red and violet to deep blue, as the wave runs.
local stops = { { .98, .80, .35 }, { .93, .42, .22 }, { .72, .17, .38 }, { .35, .18, .55 }, { .12, .24, .50 }, { .10, .45, .55 } }
local function shade(s)
	local at = s * (#stops - 1)
	local k = math.min(math.floor(at), #stops - 2)
	local a, b, f = stops[k + 1], stops[k + 2], at - k
	return { a[1] + f * (b[1] - a[1]), a[2] + f * (b[2] - a[2]), a[3] + f * (b[3] - a[3]) }
end

for i = 0, n - 1 do
	local c, s = math.cos(angle), math.sin(angle)
	box {
		name = "domino " .. i + 1, size = { width, thick, height }, at = { -r * c, -r * s, height / 2 }, material = "domino",
		rotation = { axis = { 0, 0, 1 }, degrees = math.deg(angle) + math.deg(lane / (2 * math.pi * r)) }, colour = shade(i / math.max(n - 1, 1)),
	}
	angle = angle + gap / r
	r = r - lane / (2 * math.pi) * gap / r
end
sphere { name = "spark", radius = .1, at = { -outer, .7, .1 }, velocity = { 0, -1.2, 0 }, spin = { 12, 0, 0 }, material = "steel" }
