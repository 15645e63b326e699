-- expect: :2: sphere.name: expected text of 1 to 47 bytes without control characters, got "nnnn
sphere { radius = 1, name = ("n"):rep(48) }
