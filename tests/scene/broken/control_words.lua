-- expect: :2: controls.sends: expected one word, got "go on"
controls { key = "w", sends = "go on" }
sphere { radius = 1 }
