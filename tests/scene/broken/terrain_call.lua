-- expect: :2: terrain: unknown name: terrain is a heightfield { ... }, or a mesh { ... }
terrain {}
