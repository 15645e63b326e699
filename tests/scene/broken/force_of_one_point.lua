-- expect: :2: box.varying_force.points: expected 2 to 
box { size = { 1, 1, 1 }, varying_force = { kind = "linear", points = { { 0, 1, 0, 0 } } } }
