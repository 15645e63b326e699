-- expect: :1: camera "main".follow: expected the name of an object, got "ball"
sphere { name = "bal" }
camera "main" { follow = "ball" }
