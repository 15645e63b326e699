-- A small slow body without contacts: the equilibrium test has an island without contacts.
scene { step = 1.7060352351207824, substeps = 1 }
sun { towards = {0.001, -0.9036812725542089, 1e-300} }
local q = random_rotation()
sphere { radius = random(.1, .5), at = { random(), random(), 2 }, q = random_rotation() }
material 'a' { friction = 6.9765156838392315 }
ground {}
box { rotation = { axis = {0.0, -0.541045157708403, -0.8110672824456595}, degrees = 1.8942156525065297 }, friction = 0.5, spin = {-1.7736890707292812, 9, -6.725444641182955}, at = {-3.0, 0.1, 3.0}, mass = 7.609564143230866, size = {1.112172199917012, 0.5240340129028056, 1.8717313949928605} }
box { at = {0.0, -1.0, -1e-12}, size = {1.7453331811867285, 0.10891781536592901, 1.156036610078247}, static = true }
sphere { at = {-0.0, 1.0, -1.2692563198901983}, mass = 1e-09, radius = 0.21982251115262047, q = {-0.01, -1.9503489411726331, 1.3711064419761936, -0.1} }
capsule { static = true, name = ('two words'), radius = 0.6470032438360647, length = 0.45108427603744344 }
box { size = {0.06268834041856636, 1.478475216553222, 0.9374707475835408}, at = {1e-15, 0.02270565967252347, 1e-09}, material = 'a', friction = 1.2536255470571162e-05 }
