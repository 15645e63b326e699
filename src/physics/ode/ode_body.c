#include "ode/ode_body.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/allocate.h"
#include "base/log.h"

// ---- ODE's state per process: initialisation and message handlers

static pthread_once_t once = PTHREAD_ONCE_INIT;

// ODE repeats a message thousands of times a second ("LCP internal error, s <= 0"): only the first is reported.
static void on_message(int number, const char *format, va_list args)
{
	static atomic_flag told = ATOMIC_FLAG_INIT;
	if (atomic_flag_test_and_set(&told))
		return;
	char text[256];
	vsnprintf(text, sizeof text, format, args);
	ob_log_warn("ODE: %s (%d); further messages of ODE are left out", text, number);
}

static _Thread_local jmp_buf *way_out; // NULL: ODE must not fail here
static void *_Atomic abandoned; // the last one; each points to the one before

void ob_ode_abandon(void **thing)
{
	*thing = atomic_exchange(&abandoned, thing);
}

bool ob_ode_try(void (*step)(void *context), void *context)
{
	jmp_buf here;
	way_out = &here;
	if (_setjmp(here)) {
		way_out = NULL;
		return false;
	}
	step(context);
	way_out = NULL;
	return true;
}

void ob_ode_give_up(void)
{
	longjmp(*way_out, 1);
}

// ODE's contract: handlers of errors must not return.
static void on_error(int number, const char *format, va_list args)
{
	char text[256];
	if (way_out)
		ob_ode_give_up();
	vsnprintf(text, sizeof text, format, args);
	ob_log_warn("ODE failed: %s (%d)", text, number);
	abort();
}

// ODE does not check its allocations: this one does not return without memory.
static void *reallocate(void *old, dsizeint old_bytes, dsizeint bytes)
{
	(void)old_bytes;
	return ob_reallocate(old, bytes);
}

static void init_ode(void)
{
	dSetAllocHandler(ob_allocate);
	dSetReallocHandler(reallocate);
	dSetMessageHandler(on_message);
	dSetErrorHandler(on_error);
	dSetDebugHandler(on_error);
	if (!dInitODE2(dInitFlagManualThreadCleanup)) {
		ob_log_warn("ODE does not start: no memory");
		abort();
	}
}

// A child of fork inherits both the flag and the state that it stands for.
void ob_ode_init(void)
{
	pthread_once(&once, init_ode);
}

void ob_ode_thread_init(void)
{
	ob_ode_init();
	dAllocateODEDataForThread(dAllocateMaskAll);
}

void ob_ode_thread_finish(void)
{
	dCleanupODEAllDataForThread();
}

#ifdef __SANITIZE_THREAD__
// ODE passes unused memory of a geometry (destroyed, or attached to a body now) to the next one, of any thread, by a
// locked exchange. Debian's library is not built for ThreadSanitizer, which sees the transfer but not the lock.
const char *__tsan_default_suppressions(void);
__attribute__((visibility("default"))) const char *__tsan_default_suppressions(void)
{
	return "race:dxGeom::~dxGeom\nrace:dGeomSetBody\n";
}
#endif

// ---- bodies

struct ob_ode_stepper {
	void *abandoned; // first
	bool gave_up;
	dWorldID world; // empty: its working memory is used by all the others
	dThreadingImplementationID threading;
};

struct ob_ode_body {
	ob_ode_stepper *stepper;
	dWorldID world; // NULL for static objects, as is body
	dBodyID body;
	dGeomID geom; // follows the body; NULL for objects without a shape
	ob_passport made_of;
};

// Creates shared working memory. Without it each world would use the process's own, with an unlocked job list: worlds
// of different threads would corrupt it. Each world would also reserve 128 kB for its first step, where a free body
// needs 1.
ob_ode_stepper *ob_ode_stepper_create(void)
{
	ob_ode_stepper *s = ob_allocate_zeroed(sizeof *s);
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
	if (s->gave_up) {
		ob_ode_abandon(&s->abandoned);
		return;
	}
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

ob_ode_body *ob_ode_body_create(const ob_passport *p, ob_vec3 gravity, ob_ode_stepper *s)
{
	ob_ode_body *b = ob_allocate_zeroed(sizeof *b);
	ob_ode_init();
	b->made_of = *p;
	b->geom = ob_ode_geom_create(0, p->shape, p->size);
	if (p->flags & OB_OBJECT_STATIC || !(p->mass > 0))
		return b;
	b->stepper = s;
	make_world(b, gravity, s);
	b->body = dBodyCreate(b->world);
	dMass m;
	dMassSetParameters(&m, p->mass, 0, 0, 0, p->inertia.x, p->inertia.y, p->inertia.z, 0, 0, 0);
	dBodySetMass(b->body, &m);
	if (b->geom)
		dGeomSetBody(b->geom, b->body);
	return b;
}

bool ob_ode_body_serves(const ob_ode_body *b, const ob_passport *p)
{
	const ob_passport *own = &b->made_of;
	return own->shape == p->shape && !((own->flags ^ p->flags) & OB_OBJECT_STATIC) && own->mass == p->mass &&
	       ob_equal(own->size, p->size) && ob_equal(own->inertia, p->inertia);
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

typedef struct body_step {
	ob_ode_body *body;
	const ob_state *from;
	double h; // s
	ob_vec3 force, torque;
} body_step;

static void step_body(void *context)
{
	const body_step *x = context;
	ob_ode_body_set(x->body, x->from);
	dBodySetForce(x->body->body, x->force.x, x->force.y, x->force.z);
	dBodySetTorque(x->body->body, x->torque.x, x->torque.y, x->torque.z);
	dWorldStep(x->body->world, x->h);
}

bool ob_ode_body_step(ob_ode_body *b, ob_state *s, ob_vec3 j, ob_vec3 l, double h)
{
	body_step x = { b, s, h, ob_v3(j.x / h, j.y / h, j.z / h), ob_v3(l.x / h, l.y / h, l.z / h) };
	if (!b->body) {
		ob_ode_body_set(b, s);
		return true;
	}
	if (!ob_ode_try(step_body, &x)) {
		b->stepper->gave_up = true;
		return false;
	}
	const dReal *p = dBodyGetPosition(b->body), *q = dBodyGetQuaternion(b->body);
	const dReal *v = dBodyGetLinearVel(b->body), *w = dBodyGetAngularVel(b->body);
	s->pose.p = ob_v3(p[0], p[1], p[2]);
	s->pose.q = (ob_quat){ q[0], q[1], q[2], q[3] };
	s->v = ob_v3(v[0], v[1], v[2]);
	s->w = ob_v3(w[0], w[1], w[2]);
	return true;
}

// ---- ode geom

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
