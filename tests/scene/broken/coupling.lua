-- expect: :2: scene.coupling: expected
scene { sync = "free", coupling = "none" }
