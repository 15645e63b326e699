-- expect: :2: scene.update_rate: expected a number above 0, up to 100000
scene { sync = "free", update_rate = 0 }
