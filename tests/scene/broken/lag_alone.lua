-- expect: :2: scene.lag: expected with exchange = "lagged" only, got "coloured"
scene { lag = 2 }
