-- expect: :2: scene.lag: expected with solver = "lagged" only, got "coloured"
scene { lag = 2 }
