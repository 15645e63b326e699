-- expect: :2: box.kind: expected either static or kind, got both
box { size = { 1, 1, 1 }, kind = "kinematic", static = true }
