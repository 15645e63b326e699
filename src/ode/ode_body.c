#include "ode/ode_body.h"

#include <stdlib.h>

#include "ode/ode_geom.h"

struct ob_ode_stepper {
	dWorldID world; // empty: the working memory of all the others is its
	dThreadingImplementationID threading;
};

struct ob_ode_body {
	dWorldID world; // NULL for static objects, as is body
	dBodyID body;
	dGeomID geom; // follows the body; NULL for objects without a shape
};

ob_vec3 ob_ode_inertia(ob_shape shape, ob_vec3 size, double mass)
{
	if (!(mass > 0))
		return ob_v3(0, 0, 0);
	dMass m = ob_ode_mass(shape, size, mass);
	return ob_v3(m.I[0], m.I[5], m.I[10]);
}

double ob_ode_volume(ob_shape shape, ob_vec3 size)
{
	dMass m;
	switch (shape) {
	case OB_SHAPE_SPHERE:
		dMassSetSphere(&m, 1, size.x);
		return m.mass;
	case OB_SHAPE_BOX:
		dMassSetBox(&m, 1, 2 * size.x, 2 * size.y, 2 * size.z);
		return m.mass;
	case OB_SHAPE_CAPSULE:
		dMassSetCapsule(&m, 1, 3, size.x, 2 * size.y);
		return m.mass;
	case OB_SHAPE_CYLINDER:
		dMassSetCylinder(&m, 1, 3, size.x, 2 * size.y);
		return m.mass;
	case OB_SHAPE_PLANE:
	case OB_SHAPE_NONE:
		break;
	}
	return 0;
}

// Without this each world would use the process's own, whose job list is not locked: worlds of different threads then
// corrupt it. And each world would reserve 128 kB for its first step, where a free body needs 1.
ob_ode_stepper *ob_ode_stepper_create(void)
{
	ob_ode_stepper *s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	ob_ode_init();
	s->threading = dThreadingAllocateSelfThreadedImplementation();
	s->world = dWorldCreate();
	dWorldStepReserveInfo lean = { sizeof lean, 1.2f, 512 };
	dWorldSetStepMemoryReservationPolicy(s->world, &lean);
	return s;
}

void ob_ode_stepper_destroy(ob_ode_stepper *s)
{
	if (!s)
		return;
	dWorldDestroy(s->world);
	dThreadingFreeImplementation(s->threading);
	free(s);
}

static void make_world(ob_ode_body *b, ob_vec3 gravity, const ob_ode_stepper *s)
{
	b->world = dWorldCreate();
	dWorldSetStepThreadingImplementation(b->world, dThreadingImplementationGetFunctions(s->threading),
					     s->threading);
	dWorldUseSharedWorkingMemory(b->world, s->world);
	dWorldSetGravity(b->world, gravity.x, gravity.y, gravity.z);
}

ob_ode_body *ob_ode_body_create(const ob_passport *p, ob_vec3 gravity, const ob_ode_stepper *s)
{
	ob_ode_body *b = calloc(1, sizeof *b);
	if (!b)
		return NULL;
	ob_ode_init();
	b->geom = ob_ode_geom_create(0, p->shape, p->size);
	if (p->flags & OB_OBJECT_STATIC || !(p->mass > 0))
		return b;
	make_world(b, gravity, s);
	b->body = dBodyCreate(b->world);
	dMass m;
	dMassSetParameters(&m, p->mass, 0, 0, 0, p->inertia.x, p->inertia.y, p->inertia.z, 0, 0, 0);
	dBodySetMass(b->body, &m);
	if (b->geom)
		dGeomSetBody(b->geom, b->body);
	return b;
}

void ob_ode_body_destroy(ob_ode_body *b)
{
	if (!b)
		return;
	if (b->geom)
		dGeomDestroy(b->geom);
	if (b->world)
		dWorldDestroy(b->world);
	free(b);
}

void ob_ode_body_set(ob_ode_body *b, const ob_state *s)
{
	if (!b->body) {
		if (b->geom)
			ob_ode_geom_place(b->geom, s->pose);
		return;
	}
	dBodySetPosition(b->body, s->pose.p.x, s->pose.p.y, s->pose.p.z);
	dBodySetQuaternion(b->body, (dQuaternion){ s->pose.q.w, s->pose.q.x, s->pose.q.y, s->pose.q.z });
	dBodySetLinearVel(b->body, s->v.x, s->v.y, s->v.z);
	dBodySetAngularVel(b->body, s->w.x, s->w.y, s->w.z);
}

void ob_ode_body_step(ob_ode_body *b, ob_state *s, ob_vec3 j, ob_vec3 l, double h)
{
	ob_ode_body_set(b, s);
	if (!b->body)
		return;
	dBodySetForce(b->body, j.x / h, j.y / h, j.z / h);
	dBodySetTorque(b->body, l.x / h, l.y / h, l.z / h);
	dWorldStep(b->world, h);
	const dReal *p = dBodyGetPosition(b->body), *q = dBodyGetQuaternion(b->body);
	const dReal *v = dBodyGetLinearVel(b->body), *w = dBodyGetAngularVel(b->body);
	s->pose.p = ob_v3(p[0], p[1], p[2]);
	s->pose.q = (ob_quat){ q[0], q[1], q[2], q[3] };
	s->v = ob_v3(v[0], v[1], v[2]);
	s->w = ob_v3(w[0], w[1], w[2]);
}
