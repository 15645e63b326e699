#include "ode/ode_geom.h"

dGeomID ob_ode_geom_create(dSpaceID space, ob_shape shape, ob_vec3 size)
{
	switch (shape) {
	case OB_SHAPE_SPHERE:
		return dCreateSphere(space, size.x);
	case OB_SHAPE_BOX:
		return dCreateBox(space, 2 * size.x, 2 * size.y, 2 * size.z);
	case OB_SHAPE_PLANE:
		return dCreatePlane(space, 0, 0, 1, 0);
	case OB_SHAPE_CAPSULE:
		return dCreateCapsule(space, size.x, 2 * size.y);
	case OB_SHAPE_CYLINDER:
		return dCreateCylinder(space, size.x, 2 * size.y);
	default: // no collisions: worlds with hulls are rejected, and a separate body needs no geometry
		return NULL;
	}
}

void ob_ode_geom_place(dGeomID g, ob_pose pose)
{
	if (dGeomGetClass(g) == dPlaneClass) { // ODE's planes have no pose, only n . x = d
		ob_mat3 r = ob_quat_matrix(pose.q);
		ob_vec3 n = ob_column(&r, 2);
		dGeomPlaneSetParams(g, n.x, n.y, n.z, ob_dot(n, pose.p));
		return;
	}
	dGeomSetPosition(g, pose.p.x, pose.p.y, pose.p.z);
	dGeomSetQuaternion(g, (dQuaternion){ pose.q.w, pose.q.x, pose.q.y, pose.q.z });
}
