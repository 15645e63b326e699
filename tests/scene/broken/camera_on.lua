-- expect: :3: camera "main".on: expected eye and target in the object's axes, and not follow, too
sphere { name = "ball" }
camera "main" { on = "ball" }
