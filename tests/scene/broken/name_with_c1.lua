-- expect: :2: sphere.name: expected text of 1 to 47 bytes without control characters, got "a?31mb"
sphere { radius = 1, name = "a\u{9b}31mb" }
