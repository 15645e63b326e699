-- expect: :2: controls.min: expected a label, and neither key nor values, for a slider
controls { label = "w", key = "w", sends = "go", min = 1, max = 2 }
sphere { radius = 1 }
