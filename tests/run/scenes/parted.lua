-- Boxes that overlap from the start. In its 25th step, with contacts by AABBs, two are in contact when islands are
-- solved for the first time, and no longer when they are solved again, and once more with others.
scene { gravity = { 0, 0, -9.81 }, step = 1/60, iterations = 50, solver = "jacobi", seed = 7, room = 4 }
plane { normal = { 0.0156623, 0.399139, 1 }, at = { -1, -1, -0.5 }, restitution = 0, friction = 0.3 }
box { size = { 1, 1, 1 }, at = { -0.0665824, -0.435602, 1.00046 }, density = 5000, restitution = 0, friction = 0.3 }
box { size = { 1, 0.820347, 0.53606 }, at = { 2.75614, -0.0251443, 1.06667 }, spin = { 4.26067, 0.883401, -4.58899 }, density = 1000, restitution = 0, friction = 0.3, force = { 0.152008, 4.27371, 4.94739 } }
box { size = { 0.2, 0.2, 0.196705 }, at = { 2.67563, -0.470892, 0.413461 }, density = 100, restitution = 0, friction = 0.3 }
box { size = { 1, 1, 1 }, at = { -0.0657074, 0.0409688, 0.54872 }, rotation = { axis = { 0.993438, 0.0249544, -0.111618 }, degrees = 117.74 }, spin = { 4.92745, -0.630375, 3.06281 }, density = 5000, restitution = 0, friction = 0.3 }
box { size = { 1, 1, 1 }, at = { -0.126709, -0.367351, 0.573713 }, spin = { -4.20104, 3.61084, 1.18665 }, density = 100, restitution = 0, friction = 0.3 }
box { size = { 1, 1, 1 }, at = { 2.54937, -0.42915, 0.314722 }, rotation = { axis = { -0.65507, -0.249331, -0.713244 }, degrees = 108.78 }, density = 100, restitution = 0, friction = 0.3 }
box { size = { 0.925617, 1, 1 }, at = { 3.07394, -0.299823, 0.690459 }, density = 1000, restitution = 0, friction = 0.3 }
box { size = { 1, 1, 1.06177 }, at = { 0.0628498, -0.175079, 0.879721 }, spin = { -0.250346, -2.51244, -1.60713 }, density = 100, restitution = 0, friction = 0.3 }
sphere { radius = 0.5, at = { -0.399306, 0.0680944, 0.691388 }, kind = "kinematic", spin = { 0, 0, 0.417503 }, restitution = 0, friction = 0.3 }
