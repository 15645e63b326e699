-- expect: :2: pattern too costly
print(("a"):rep(1000):find(("a*"):rep(30) .. "b"))
