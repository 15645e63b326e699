-- expect: :2: mesh.file: cannot read
mesh { file = "pin.glb" }
