-- expect: :2: box.varying_force.kind: expected
box { size = { 1, 1, 1 }, varying_force = { kind = "square", force = { 1, 0, 0 } } }
