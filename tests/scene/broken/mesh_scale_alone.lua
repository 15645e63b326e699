-- expect: sphere.mesh_scale: expected mesh = "FILE.glb" with it
ground {}
sphere { radius = 1, mesh_scale = 2 }
