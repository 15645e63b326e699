// Inside the module ode only: one contact of two solids of which ODE knows too little (cylinders with boxes and
// cylinders, where their caps do not lie flat).
#ifndef OB_ODE_AXIS_H
#define OB_ODE_AXIS_H

#include "ode/ode_collide.h"
#include "ode/ode_solid.h"

// The direction in which the solids overlap least, found from "hint" and from their axes by pattern search (Hooke and
// Jeeves 1961), and a point between them. Gap to about 1e-4 of their size, never too wide. Pure.
ob_ode_point ob_ode_axis_contact(const ob_ode_solid *a, const ob_ode_solid *b, ob_vec3 hint);

#endif
