-- expect: :2: scene.tolerance: expected a share above 0%, up to 100%, as ".1%", or a number from 1e-06 to 1, got "0%"
scene { tolerance = '0%' }
