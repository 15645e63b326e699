-- expect: :2: hinge: expected a table, as in hinge { "door", "frame", ... }
hinge("door")
