// Inside the module ode only: a geometry of ODE from our shapes.
#ifndef OB_ODE_GEOM_H
#define OB_ODE_GEOM_H

#include <ode/ode.h>

#include <ob/motion.h>

// space may be 0; NULL for OB_SHAPE_NONE and for a hull
dGeomID ob_ode_geom_create(dSpaceID space, ob_shape shape, ob_vec3 size);
// For a geometry without a body (static objects, single tests).
void ob_ode_geom_place(dGeomID g, ob_pose pose);
// Zero mass for a plane or no shape.
dMass ob_ode_mass(ob_shape shape, ob_vec3 size, double mass);

#endif
