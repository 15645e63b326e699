-- expect: :2: scene.sync: expected
scene { sync = "loose" }
