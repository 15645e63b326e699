-- expect: :2: attempt to call a nil value (field 'turn')
math.turn(1)
