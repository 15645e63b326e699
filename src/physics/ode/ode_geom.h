// ODE geometries of our shapes. Internal to the module.
#ifndef OB_ODE_GEOM_H
#define OB_ODE_GEOM_H

#include <ode/ode.h>

#include <ob/motion.h>

// Creates a geometry. space may be 0; returns NULL for a shape that is none of ODE's.
dGeomID ob_ode_geom_create(dSpaceID space, ob_shape shape, ob_vec3 size);
// Places a geometry without a body (static objects, single tests).
void ob_ode_geom_place(dGeomID g, ob_pose pose);

#endif
