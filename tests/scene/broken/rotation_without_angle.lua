-- expect: :2: box.rotation.degrees: expected a number from -36000 to 36000, got nothing
box { size = { 1, 1, 1 }, rotation = { axis = { 0, 0, 1 } } }
