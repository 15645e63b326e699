-- expect: :2: sphere.friction: expected a number from 0 to 1000, got -0.5
sphere { radius = 1, friction = -.5 }
