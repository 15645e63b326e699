-- ODE's stepper cannot turn so long a needle, and says so by an assertion.
scene { integrator = "ode", step = 1, substeps = 8 }
box { name = "needle", size = { 7e-4, 1e6, 7e-4 } }
box { size = { 1, 1e6, 2e5 }, q = { .03, 0, -.6, 1 } }
