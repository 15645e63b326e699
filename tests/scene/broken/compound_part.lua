-- expect: compound.parts[2]: expected a table
compound { parts = { { size = { 1, 1, 1 } }, 3 } }
