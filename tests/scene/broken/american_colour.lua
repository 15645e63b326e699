-- expect: :2: sphere.color: unknown field, did you mean colour?
sphere { radius = 1, color = { 1, 0, 0 } }
