-- expect: :2: controls.values: expected 1 to 4 numbers from -1e9 to 1e9, as { 1, 0 }
controls { key = "w", sends = "go", values = { 1, "a" } }
sphere { radius = 1 }
