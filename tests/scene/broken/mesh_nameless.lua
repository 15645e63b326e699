-- expect: mesh.file: expected
mesh { at = { 0, 0, 1 } }
