-- expect: :2: scene.duration: expected a number above 0, up to 1000000000, got nan
scene { duration = -(0 / 0) }
