-- expect: case: expected at most one call
ground {}
case { runs = 2 }
case { runs = 2 }
