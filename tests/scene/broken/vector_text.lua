-- expect: vector: expected a number, got a string
ground {}
vector("1", 2, 3)
