-- expect: :2: sphere.zzzzz: unknown field, expected one of radius, name
sphere { radius = 1, zzzzz = 1 }
