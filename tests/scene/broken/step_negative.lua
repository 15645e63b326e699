-- expect: :2: scene.step: expected a number above 0, up to 10, got -0.1
scene { step = -.1 }
