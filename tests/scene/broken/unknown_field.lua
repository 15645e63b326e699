-- expect: :3: box.friktion: unknown field, did you mean friction?
ground {}
box { size = { 1, 1, 1 }, friktion = .5 }
