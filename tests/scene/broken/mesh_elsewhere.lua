-- expect: box.mesh: expected a file in the folder of the scene, got "../a.glb"
ground {}
box { size = { 1, 1, 1 }, mesh = "../a.glb" }
