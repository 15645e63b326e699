-- expect: :2: capsule.length: expected a number from 1e-06 to 1000000
capsule { radius = 1, length = -1 }
