-- expect: :3: universal.across: expected a direction across axis
box { name = "bob", size = { 1, .1, 2 }, at = { .5, 0, 2 } }
universal { "bob", at = { 0, 0, 2 }, axis = { 0, 0, 1 }, across = { 0, 0, 2 } }
