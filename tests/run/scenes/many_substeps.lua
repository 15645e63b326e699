-- With steps of a second, ODE's stepper needs more substeps than allowed to keep a tolerance.
scene { solver = "ghost", integrator = "ode", step = 1, substeps = 1 }
ground {}
box { size = { 1, 1e-3, 1 } }
