-- expect: :3: sphere.name: expected a name of its own, got "ball" as in line 2
sphere { radius = 1, name = "ball" }
sphere { radius = 1, name = "ball" }
