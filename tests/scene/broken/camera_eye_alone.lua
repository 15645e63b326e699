-- expect: :2: camera "main".target: expected eye and target together, got nothing
camera "main" { eye = { 1, 1, 1 } }
