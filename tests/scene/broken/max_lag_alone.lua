-- expect: :2: scene.max_lag: expected with sync = "free" only
scene { max_lag = .1 }
