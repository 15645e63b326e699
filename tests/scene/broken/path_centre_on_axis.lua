-- expect: :2: box.path.centre: expected a point that the axis does not lead from to the object's place
box { size = { 1, 1, 1 }, kind = "kinematic", path = { kind = "circle", centre = { 0, 0, 3 }, frequency = 1 } }
