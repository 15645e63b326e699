-- expect: :2: sphere.name: expected text without #
sphere { radius = 1, name = "box#3" }
