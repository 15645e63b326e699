-- expect: :2: box.varying_force: expected either script or varying_force, got both
box { size = { 1, 1, 1 }, script = [[ function on_step() end ]], varying_force = { kind = "pulse", force = { 1, 0, 0 }, to = 1 } }
