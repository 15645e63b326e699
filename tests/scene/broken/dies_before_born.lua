-- expect: :2: sphere.dies: expected a time after born = 3, got 2
sphere { radius = 1, born = 3, dies = 2 }
