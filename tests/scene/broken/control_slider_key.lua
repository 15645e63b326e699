-- expect: :2: controls.min: expected a label, and neither key, gamepad nor values, for a slider
controls { label = "w", gamepad = 3, sends = "go", min = 1, max = 2 }
sphere { radius = 1 }
