-- expect: :2: material: expected a name of 1 to 47 bytes, as in material "wood" { ... }
material { friction = 1 }
