-- expect: :2: scene.passes is now called scene.iterations: expected one of them, got both
scene { passes = 4, iterations = 4 }
