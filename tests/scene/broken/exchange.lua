-- expect: :2: scene.exchange: expected "coloured" or "jacobi", got "colored"
scene { exchange = "colored" }
