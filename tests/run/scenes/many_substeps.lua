-- With steps of a second ODE's stepper would need more substeps than there may be to keep a tolerance.
scene { solver = "ghost", integrator = "ode", step = 1, substeps = 1 }
ground {}
box { size = { 1, 1e-3, 1 } }
