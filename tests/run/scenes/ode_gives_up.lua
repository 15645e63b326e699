-- A heavy blade that whirls through nearly weightless boxes: ODE's stepper cannot solve their contact, and fails an
-- assertion.
scene { integrator = "ode", step = 1, substeps = 1 }
box { name = "blade", size = { 9.5e4, 1.76e4, 154 }, q = { .43, -.04, .15, -.38 }, spin = { 43, -1.9e3, -1.8 } }
box { size = { .0152, 8.46e3, .0423 }, q = { .9, .69, -.25, .62 }, mass = 4.6e-12 }
