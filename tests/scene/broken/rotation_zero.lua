-- expect: rotation: expected a vector, or four numbers that are not all 0
ground {}
rotation(0, 0, 0, 0)
