-- expect: :2: scene.max_lag: expected a number above 0, up to 1000
scene { sync = "free", max_lag = -1 }
