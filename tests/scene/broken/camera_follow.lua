-- expect: :1: camera "main".follow: expected the name of an object, got "ball"
sphere { name = "bal", radius = 1 }
camera "main" { follow = "ball" }
