-- expect: :3: camera "main".on: expected eye and target in the object's axes, and not follow, too
sphere { name = "ball", radius = 1 }
camera "main" { on = "ball" }
