-- expect: :2: sphere.avatar: expected a name, a script and kind = "dynamic" with it, and not born or dies
sphere { radius = 1, name = "a", avatar = true }
