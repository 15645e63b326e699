-- Thin wall: a small box is shot at a fixed wall of two centimetres, without gravity. It must not come through.
--   -D speed=100.0    m/s
--   --seed 1          another aim: place of the hit, attitude, spin
local speed = param("speed", 100.0, { min = .01, max = 100000, unit = "m/s" })

scene { title = "Thin wall", duration = 1, gravity = { 0, 0, 0 } }
camera "main" { eye = { -5.68, -6.57, 3.99 }, target = { -.8, 0, 0 }, fov = 40 }

box { name = "wall", static = true, size = { .02, 4, 4 }, at = { 0, 0, 0 }, restitution = 0, colour = "#5f7488" }

-- It flies to a point on the wall, at most a metre and a half from the middle.
local start = { -3, random(-1, 1), random(-1, 1) }
local aim = { 0, random(-1.5, 1.5), random(-1.5, 1.5) }
local way = { aim[1] - start[1], aim[2] - start[2], aim[3] - start[3] }
local length = math.sqrt(way[1] ^ 2 + way[2] ^ 2 + way[3] ^ 2)

box {
	name = "shot",
	size = { .2, .2, .2 },
	at = start,
	q = random_rotation(),
	velocity = { way[1] / length * speed, way[2] / length * speed, way[3] / length * speed },
	spin = { random(-5, 5), random(-5, 5), random(-5, 5) },
	density = 1000,
	friction = .3,
	restitution = 0,
	colour = "#e4572e",
}
