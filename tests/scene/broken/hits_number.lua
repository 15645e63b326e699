-- expect: :2: sphere.hits: expected a list of whole numbers, each from 0 to 15, got 3
sphere { radius = 1, hits = 3 }
