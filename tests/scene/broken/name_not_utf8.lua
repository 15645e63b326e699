-- expect: :2: sphere.name: expected text of 1 to 47 bytes without control characters
sphere { radius = 1, name = "\xff\xfe" }
