-- expect: :2: camera "main".fov: expected a number from 1 to 170, got 180
camera "main" { fov = 180 }
