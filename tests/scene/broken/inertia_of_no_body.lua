-- expect: :2: box.inertia: expected no moment above the sum of the others, got {1, 1, 3}
box { size = { 1, 1, 1 }, mass = 1, inertia = { 1, 1, 3 } }
