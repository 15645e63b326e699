-- expect: :2: camera "main".target: expected a point away from the eye
camera "main" { eye = { 1, 1, 1 }, target = { 1, 1, 1 } }
