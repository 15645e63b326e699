-- expect: :2: scene.step: expected a number above 0, up to 10, got 0
scene { step = 0 }
