-- expect: :3: sphere.material: unknown material "wod", did you mean "wood"?
material "wood" { density = 600 }
sphere { radius = 1, material = "wod" }
