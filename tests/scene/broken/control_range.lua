-- expect: :2: controls.max: expected min and max of a slider, the smaller one first
controls { label = "w", sends = "go", min = 2, max = 1 }
sphere { radius = 1 }
