-- expect: :2: controls.value: expected a number from min to max of a slider
controls { label = "w", sends = "go", min = 1, max = 2, value = 3 }
sphere { radius = 1 }
