-- A thin disk that rolls on its rim, inclined, with its centre at rest: it keeps its energy for ever. Rate at which the
-- inclination goes round: Moffatt, Euler's disk and its finite-time singularity, 2000.
local degrees = param("degrees", 10, { min = 1, max = 60 }) -- inclination
local radius = param("radius", .25, { min = .01, max = 10 }) -- m
local a = math.rad(degrees)
local thickness = .02 * radius
local rate = math.sqrt(4 * 9.81 / (radius * math.sin(a)))
scene { duration = 1 }
ground { friction = 1 }
cylinder { radius = radius, length = thickness, mass = 1, friction = 1,
	at = { 0, 0, radius * math.sin(a) + thickness / 2 * math.cos(a) }, rotation = { axis = { 0, 1, 0 }, degrees = degrees },
	spin = { -rate * math.sin(a) * math.cos(a), 0, rate * math.sin(a) ^ 2 } }
