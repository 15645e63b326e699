-- expect: :2: scene.solver: expected "coloured" or "jacobi" or "ghost" or "lagged", got "colored"
scene { solver = "colored" }
