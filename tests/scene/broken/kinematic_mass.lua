-- expect: :2: box.mass: expected none for a kinematic object, got 3
box { size = { 1, 1, 1 }, kind = "kinematic", mass = 3 }
