-- expect: :2: box: expected a table of fields, as in box { ... }, got "big"
box "big"
