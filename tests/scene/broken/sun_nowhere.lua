-- expect: :2: sun.towards: expected a direction {x, y, z} that is not {0, 0, 0}
sun { towards = { 0, 0, 0 } }
