-- expect: :2: mesh: unknown name: obsim has no shapes of meshes: hull { points = ... } collides, and an object's field mesh is drawn
mesh { file = "pin.glb" }
