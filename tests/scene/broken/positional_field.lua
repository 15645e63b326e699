-- expect: :2: sphere: expected named fields (name = value), got a value without a name at 1
sphere { 1, radius = 1 }
