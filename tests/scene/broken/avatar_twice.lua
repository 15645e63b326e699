-- expect: :3: sphere.avatar: expected one object with it, got a second
sphere { radius = 1, name = "a", avatar = true, script = "function on_start() end" }
sphere { radius = 1, name = "b", avatar = true, script = "function on_start() end" }
