-- expect: :2: sphere.hits[2]: expected a whole number from 0 to 15, got "wall"
sphere { radius = 1, hits = { 1, "wall" } }
