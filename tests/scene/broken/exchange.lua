-- expect: :2: scene.exchange: expected "coloured" or "jacobi" or "ghost" or "lagged", got "colored"
scene { exchange = "colored" }
