-- expect: :1: controls "go": expected an object with avatar = true, or to = "NAME"
sphere { radius = 1 }
controls { key = "w", sends = "go" }
