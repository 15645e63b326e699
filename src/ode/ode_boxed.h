// Inside the module ode only: contacts of axis-aligned boxes.
#ifndef OB_ODE_BOXED_H
#define OB_ODE_BOXED_H

#include <ode/ode.h>

// Where the axis-aligned boxes round two geometries overlap: the four corners of the overlap across the axis along which
// it is least, with normals along that axis, from b to a. A plane stays a plane: against it, the four lowest corners of
// the other's box that are below it. Returns how many of the four there are. Normals as dCollide has them.
int ob_ode_collide_boxed(dGeomID a, dGeomID b, dContactGeom point[4]);

#endif
