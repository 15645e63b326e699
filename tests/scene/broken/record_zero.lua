-- expect: :2: record.every: expected a whole number from 1 to 1000000, got 0
record { every = 0 }
