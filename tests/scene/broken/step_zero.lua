-- expect: :2: scene.step: expected a number from 1e-09 to 10, got 0
scene { step = 0 }
