-- expect: case.variants[2]: expected a table with a name of 1 to 31 bytes
ground {}
case { variants = { { name = "a" }, { title = "b" } } }
