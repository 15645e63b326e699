-- expect: case.runs: expected a whole number from 1 to 100, got 0
ground {}
case { runs = 0 }
