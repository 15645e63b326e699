-- expect: :3: scene.seed: expected before the first random number
local x = random()
scene { seed = 7 }
