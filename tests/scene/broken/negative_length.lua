-- expect: :2: capsule.length: expected a number above 0
capsule { radius = 1, length = -1 }
