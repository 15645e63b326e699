-- expect: :2: scene.duration: expected at most 4294967295 steps
scene { step = 1e-6, duration = 1e6 }
