#include "ode/ode_world.h"

#include <stdlib.h>

#include "base/allocate.h"
#include "base/cpu.h"
#include "ode/ode_body.h"
#include "ode/ode_joint.h"

// ---- contacts of axis-aligned boxes

static void set_contact(dContactGeom *c, dGeomID a, dGeomID b, const double *at, const double *normal, double depth)
{
	*c = (dContactGeom){ .depth = depth, .g1 = a, .g2 = b, .side1 = -1, .side2 = -1 };
	for (int k = 0; k < 3; k++) {
		c->pos[k] = at[k];
		c->normal[k] = normal[k];
	}
}

// Corner of a box (ODE's order: least and most along each axis); bit k of "which" selects the end of axis k.
static void corner(const double *box, unsigned which, double *at)
{
	for (int k = 0; k < 3; k++)
		at[k] = box[2 * k + (which >> k & 1)];
}

// sign: 1 if the box belongs to the pair's a.
static int box_plane(dGeomID a, dGeomID b, const double *box, dGeomID plane, double sign, dContactGeom *point)
{
	dVector4 face; // n . x = d
	dGeomPlaneGetParams(plane, face);
	double normal[3] = { sign * face[0], sign * face[1], sign * face[2] }, depth[8], at[8][3];
	bool used[8] = { false };
	for (unsigned i = 0; i < 8; i++) {
		corner(box, i, at[i]);
		depth[i] = face[3] - (face[0] * at[i][0] + face[1] * at[i][1] + face[2] * at[i][2]);
	}
	int n = 0;
	for (; n < 4; n++) {
		int deepest = -1;
		for (int i = 0; i < 8; i++)
			if (!used[i] && depth[i] >= 0 && (deepest < 0 || depth[i] > depth[deepest]))
				deepest = i;
		if (deepest < 0)
			break;
		used[deepest] = true;
		set_contact(&point[n], a, b, at[deepest], normal, depth[deepest]);
	}
	return n;
}

// Contacts of the axis-aligned boxes of two geometries: the four corners of the overlap across the axis along which it
// is least. A plane stays a plane: against it, the four lowest corners of the other's box, as far as they are below it.
// Returns the number of points, four at most. Normals from b to a, as dCollide has them.
static int collide_aabbs(dGeomID a, dGeomID b, dContactGeom point[4])
{
	dReal box_a[6], box_b[6];
	double overlap[6], normal[3] = { 0, 0, 0 }, depth = dInfinity;
	int axis = 0;
	dGeomGetAABB(a, box_a);
	dGeomGetAABB(b, box_b);
	if (dGeomGetClass(b) == dPlaneClass)
		return box_plane(a, b, box_a, b, 1, point);
	if (dGeomGetClass(a) == dPlaneClass)
		return box_plane(a, b, box_b, a, -1, point);
	for (int k = 0; k < 3; k++) {
		overlap[2 * k] = box_a[2 * k] > box_b[2 * k] ? box_a[2 * k] : box_b[2 * k];
		overlap[2 * k + 1] = box_a[2 * k + 1] < box_b[2 * k + 1] ? box_a[2 * k + 1] : box_b[2 * k + 1];
		if (overlap[2 * k + 1] < overlap[2 * k])
			return 0;
		// separation of a along this axis: upwards or downwards
		double up = box_b[2 * k + 1] - box_a[2 * k], down = box_a[2 * k + 1] - box_b[2 * k];
		if ((up < down ? up : down) < depth) {
			depth = up < down ? up : down;
			axis = k;
			normal[0] = normal[1] = normal[2] = 0;
			normal[k] = up < down ? 1 : -1;
		}
	}
	double middle = .5 * (overlap[2 * axis] + overlap[2 * axis + 1]);
	overlap[2 * axis] = overlap[2 * axis + 1] = middle;
	for (unsigned i = 0, n = 0; i < 8; i++) {
		double at[3];
		if (i >> axis & 1)
			continue;
		corner(overlap, i, at);
		set_contact(&point[n++], a, b, at, normal, depth);
	}
	return 4;
}

// ---- the world

// On a cap, ODE lists 8 points around its rim: the first 4 lie on one side. On triangles it lists those of each in turn.
enum { PAIR_POINTS = 4, CAP_POINTS = 8 };

struct object {
	dBodyID body; // NULL: static, or no such object
	dGeomID geom; // its data points to this object; NULL: no shape, or no such object
	dTriMeshDataID triangles; // of that geometry; NULL: it has none
	uint32_t id;
	bool touching;
	double friction, restitution;
	bool kinematic;
	ob_vec3 force, torque; // N, N m, act in every step
	ob_vec3 surface_velocity; // m/s, frame of the object
	ob_state placed; // of static objects
};

// Two objects in contact, the lower id first, and their points as found by ODE.
struct contact_pair {
	struct object *a, *b;
	int points;
	dContactGeom point[CAP_POINTS]; // normals from b to a
	dJointFeedback force[CAP_POINTS];
};

struct ob_ode_world {
	void *abandoned; // first
	dThreadingImplementationID threading;
	dWorldID world;
	dSpaceID space;
	dJointGroupID joints;
	ob_ode_world_setup setup;
	uint64_t steps, box_tests;
	double substep; // s, of the last step
	struct object *object;
	ob_ode_joint **joint; // [setup.joints]; NULL: none
	struct contact_pair *pair;
	struct contact_pair **order; // pairs by their ids: they are too big to be moved about
	size_t pairs, pairs_max;
	bool full, gave_up; // last step: pairs did not fit; it was not completed
};

ob_ode_world *ob_ode_world_create(const ob_ode_world_setup *s)
{
	ob_ode_world *w = calloc(1, sizeof *w);
	struct object *object = calloc(s->objects ? s->objects : 1, sizeof *object);
	ob_ode_joint **joint = calloc(s->joints ? s->joints : 1, sizeof *joint);
	if (!w || !object || !joint) {
		free(w);
		free(object);
		free(joint);
		return NULL;
	}
	ob_ode_init();
	w->setup = *s;
	w->object = object;
	w->joint = joint;
	w->world = dWorldCreate();
	w->threading = dThreadingAllocateSelfThreadedImplementation();
	w->space = s->hashed ? dHashSpaceCreate(0) : dSweepAndPruneSpaceCreate(0, dSAP_AXES_XYZ);
	w->joints = dJointGroupCreate(0);
	dSpaceSetManualCleanup(w->space, 1);
	dSpaceSetCleanup(w->space, 0); // objects own their geometries
	dWorldSetStepThreadingImplementation(w->world, dThreadingImplementationGetFunctions(w->threading),
					     w->threading);
	dWorldSetGravity(w->world, s->gravity.x, s->gravity.y, s->gravity.z);
	dWorldSetAutoDisableFlag(w->world, s->sleeping);
	if (s->iterations)
		dWorldSetQuickStepNumIterations(w->world, (int)s->iterations);
	if (s->surface_layer > 0)
		dWorldSetContactSurfaceLayer(w->world, s->surface_layer);
	if (s->softness > 0)
		dWorldSetCFM(w->world, s->softness);
	if (s->correcting_speed > 0)
		dWorldSetContactMaxCorrectingVel(w->world, s->correcting_speed);
	return w;
}

static void clear_object(struct object *m)
{
	if (m->geom)
		dGeomDestroy(m->geom);
	if (m->triangles)
		dGeomTriMeshDataDestroy(m->triangles);
	if (m->body)
		dBodyDestroy(m->body);
	*m = (struct object){ 0 };
}

void ob_ode_world_destroy(ob_ode_world *w)
{
	if (!w)
		return;
	if (w->gave_up) {
		ob_ode_abandon(&w->abandoned);
		return;
	}
	for (uint32_t i = 0; i < w->setup.joints; i++)
		ob_ode_joint_destroy(w->joint[i]);
	for (uint32_t id = 0; id < w->setup.objects; id++)
		clear_object(&w->object[id]);
	dJointGroupDestroy(w->joints);
	dSpaceDestroy(w->space);
	dWorldDestroy(w->world);
	dThreadingFreeImplementation(w->threading);
	free(w->object);
	free(w->joint);
	free(w->pair);
	free(w->order);
	free(w);
}

static void place_body(struct object *m, const ob_state *s)
{
	dBodySetPosition(m->body, s->pose.p.x, s->pose.p.y, s->pose.p.z);
	dBodySetQuaternion(m->body, (dQuaternion){ s->pose.q.w, s->pose.q.x, s->pose.q.y, s->pose.q.z });
	dBodySetLinearVel(m->body, s->v.x, s->v.y, s->v.z);
	dBodySetAngularVel(m->body, s->w.x, s->w.y, s->w.z);
}

static void add_body(ob_ode_world *w, struct object *m, const ob_passport *p, const ob_state *s)
{
	dMass mass;
	m->body = dBodyCreate(w->world);
	if (m->kinematic) {
		dBodySetKinematic(m->body);
		dBodySetAutoDisableFlag(m->body, 0);
	} else {
		dMassSetParameters(&mass, p->mass, 0, 0, 0, p->inertia.x, p->inertia.y, p->inertia.z, 0, 0, 0);
		dBodySetMass(m->body, &mass);
	}
	place_body(m, s);
}

void ob_ode_world_drive(ob_ode_world *w, uint32_t id, const ob_state *s)
{
	place_body(&w->object[id], s);
}

void ob_ode_world_push(ob_ode_world *w, uint32_t id, ob_vec3 force, ob_vec3 torque)
{
	struct object *m = &w->object[id];
	if (!m->body || m->kinematic ||
	    (ob_norm2(ob_sub(force, m->force)) == 0 && ob_norm2(ob_sub(torque, m->torque)) == 0))
		return;
	m->force = force;
	m->torque = torque;
	dBodyEnable(m->body);
}

void ob_ode_world_kick(ob_ode_world *w, uint32_t id, ob_vec3 impulse, ob_vec3 twist)
{
	struct object *m = &w->object[id];
	dMass mass;
	if (!m->body || m->kinematic)
		return;
	dBodyGetMass(m->body, &mass);
	const dReal *q = dBodyGetQuaternion(m->body), *v = dBodyGetLinearVel(m->body), *o = dBodyGetAngularVel(m->body);
	const ob_mat3 r = ob_quat_matrix((ob_quat){ q[0], q[1], q[2], q[3] });
	const ob_vec3 l = ob_rotate_back(&r, twist);
	const ob_vec3 turn = ob_rotate(&r, ob_v3(l.x / mass.I[0], l.y / mass.I[5], l.z / mass.I[10])); // principal axes
	dBodySetLinearVel(m->body, v[0] + impulse.x / mass.mass, v[1] + impulse.y / mass.mass,
			  v[2] + impulse.z / mass.mass);
	dBodySetAngularVel(m->body, o[0] + turn.x, o[1] + turn.y, o[2] + turn.z);
	dBodyEnable(m->body);
}

static void set_geometry(struct object *m, dGeomID geom, const ob_passport *p)
{
	m->geom = geom;
	dGeomSetData(geom, m);
	dGeomSetCategoryBits(geom, 1ul << ob_passport_group(p));
	dGeomSetCollideBits(geom, ~(unsigned long)(p->flags >> OB_OBJECT_PASSES));
}

void ob_ode_world_add(ob_ode_world *w, const ob_passport *p, const ob_state *s)
{
	const dGeomID geom = p->flags & OB_OBJECT_SENSOR ? NULL : ob_ode_geom_create(w->space, p->shape, p->size);
	struct object *m = &w->object[p->id];
	*m = (struct object){
		.id = p->id,
		.friction = p->friction,
		.restitution = p->restitution,
		.kinematic = p->flags & OB_OBJECT_KINEMATIC,
		.force = p->flags & OB_OBJECT_PRESCRIBED ? ob_v3(0, 0, 0) : p->force,
		.surface_velocity = p->flags & OB_OBJECT_PRESCRIBED ? p->surface_velocity : ob_v3(0, 0, 0),
		.placed = *s,
	};
	if (geom)
		set_geometry(m, geom, p);
	if (m->kinematic || (!(p->flags & OB_OBJECT_STATIC) && p->mass > 0)) {
		add_body(w, m, p, s);
		if (m->geom)
			dGeomSetBody(m->geom, m->body);
	} else if (m->geom) {
		ob_ode_geom_place(m->geom, s->pose);
	}
}

bool ob_ode_world_add_triangles(ob_ode_world *w, const ob_passport *p, const ob_state *s, const ob_ode_triangles *t)
{
	struct object *m = &w->object[p->id];
	const dTriMeshDataID triangles = dGeomTriMeshDataCreate();
	if (!triangles)
		return false;
	dGeomTriMeshDataBuildDouble(triangles, t->vertex, sizeof *t->vertex, (int)t->vertices, t->corner,
				    3 * (int)t->triangles, (int)t->stride);
	ob_ode_world_add(w, p, s);
	m->triangles = triangles;
	set_geometry(m, dCreateTriMesh(w->space, triangles, NULL, NULL, NULL), p);
	ob_ode_geom_place(m->geom, s->pose);
	return true;
}

// Wakes sleepers that lean on the object: their boxes overlap.
static void wake_both(void *data, dGeomID a, dGeomID b)
{
	(void)data;
	struct object *one = dGeomGetData(a), *other = dGeomGetData(b);
	if (one->body)
		dBodyEnable(one->body);
	if (other->body)
		dBodyEnable(other->body);
}

void ob_ode_world_remove(ob_ode_world *w, uint32_t id)
{
	struct object *m = &w->object[id];
	if (m->geom)
		dSpaceCollide2(m->geom, (dGeomID)w->space, NULL, wake_both);
	clear_object(m);
	w->pairs = 0; // the last contacts may refer to it
}

bool ob_ode_has_joint(const ob_joint_passport *p)
{
	const ob_joint_axis *a = &p->axis;
	if (!(p->flags & OB_JOINT_DRIVEN))
		return true;
	return (p->kind == OB_JOINT_HINGE || p->kind == OB_JOINT_SLIDER) && !(a->armature > 0) &&
	       (a->friction > 0) + (a->stiffness > 0 || a->damping > 0) + (a->motor != OB_MOTOR_NONE) <= 1;
}

bool ob_ode_world_join(ob_ode_world *w, uint32_t number, const ob_joint_passport *j)
{
	ob_ode_end end[2];
	for (int side = 0; side < 2; side++) {
		const struct object *m = j->object[side] == OB_JOINT_WORLD ? NULL : &w->object[j->object[side]];
		const ob_pose world = { .q = ob_quat_identity() };
		end[side] = (ob_ode_end){ m ? m->body : NULL, m ? m->placed.pose : world };
	}
	w->joint[number] = ob_ode_joint_create(w->world, j, end);
	return w->joint[number];
}

void ob_ode_world_unjoin(ob_ode_world *w, uint32_t number)
{
	ob_ode_joint_destroy(w->joint[number]);
	w->joint[number] = NULL;
}

void ob_ode_world_drive_joint(ob_ode_world *w, uint32_t number, const ob_joint_axis *axis, double h)
{
	if (w->joint[number])
		ob_ode_joint_drive(w->joint[number], axis, h);
}

bool ob_ode_world_joint_load(const ob_ode_world *w, uint32_t number, ob_joint_load *out)
{
	if (w->joint[number])
		ob_ode_joint_load(w->joint[number], out);
	return w->joint[number];
}

// Ends the step if there is no room: any number of pairs may follow.
static struct contact_pair *next_pair(ob_ode_world *w)
{
	if (w->pairs == w->pairs_max) {
		size_t more = w->pairs_max ? 2 * w->pairs_max : 256;
		bool allowed = w->setup.pairs_max == 0 || w->pairs < w->setup.pairs_max;
		if (!allowed || !OB_GROW(w->pair, more) || !OB_GROW(w->order, more)) {
			w->full = true;
			ob_ode_give_up();
		}
		w->pairs_max = more;
	}
	return &w->pair[w->pairs++];
}

static bool is_awake(const struct object *m)
{
	return m->body && dBodyIsEnabled(m->body);
}

static bool is_dynamic(const struct object *m)
{
	return m->body && !m->kinematic;
}

// ODE asks that one of the two hits the other.
static bool hit_each_other(dGeomID one, dGeomID other)
{
	return dGeomGetCategoryBits(one) & dGeomGetCollideBits(other) &&
	       dGeomGetCategoryBits(other) & dGeomGetCollideBits(one);
}

static void collide_pair(void *data, dGeomID one, dGeomID other)
{
	ob_ode_world *w = data;
	struct object *a = dGeomGetData(one), *b = dGeomGetData(other);
	if ((!is_awake(a) && !is_awake(b)) || (!is_dynamic(a) && !is_dynamic(b)) || !hit_each_other(one, other) ||
	    (w->setup.may_touch && !w->setup.may_touch(w->setup.of, a->id, b->id)))
		return;
	if (a->id > b->id) {
		struct object *lower = b;
		b = a;
		a = lower;
	}
	w->box_tests++;
	ob_synthetic_load(w->setup.load);
	dContactGeom point[CAP_POINTS];
	bool cap = dGeomGetClass(a->geom) == dCylinderClass || dGeomGetClass(b->geom) == dCylinderClass ||
		   a->triangles || b->triangles;
	int n = w->setup.boxed ? collide_aabbs(a->geom, b->geom, point)
			       : dCollide(a->geom, b->geom, cap ? CAP_POINTS : PAIR_POINTS, point, sizeof *point);
	struct contact_pair *p = n > 0 ? next_pair(w) : NULL;
	if (!p)
		return;
	p->a = a;
	p->b = b;
	p->points = n;
	for (int i = 0; i < n; i++)
		p->point[i] = point[i];
}

// Orders joints by ids, independent of the space's lists: a run repeats bit by bit.
static int by_ids(const void *x, const void *y)
{
	const struct contact_pair *p = *(struct contact_pair *const *)x, *q = *(struct contact_pair *const *)y;
	if (p->a->id != q->a->id)
		return p->a->id < q->a->id ? -1 : 1;
	return (p->b->id > q->b->id) - (p->b->id < q->b->id);
}

// Surface velocity (m/s, world frame).
static ob_vec3 surface_velocity(const struct object *m)
{
	const dReal *q = m->body ? dBodyGetQuaternion(m->body) : NULL;
	ob_mat3 r = ob_quat_matrix(q ? (ob_quat){ q[0], q[1], q[2], q[3] } : m->placed.pose.q);
	return ob_rotate(&r, m->surface_velocity);
}

// Carries the first body along at a velocity (m/s), as far as that lies in the plane of the contact.
static void run_surface(dContact *c, ob_vec3 velocity)
{
	const ob_vec3 n = ob_v3(c->geom.normal[0], c->geom.normal[1], c->geom.normal[2]);
	const ob_vec3 along = ob_madd(velocity, -ob_dot(velocity, n), n);
	const double speed = ob_norm(along);
	if (!(speed > 1e-12))
		return;
	c->surface.mode |= dContactMotion1 | dContactFDir1;
	c->surface.motion1 = speed;
	c->fdir1[0] = along.x / speed, c->fdir1[1] = along.y / speed, c->fdir1[2] = along.z / speed;
}

// ODE's first body must be a dynamic one, and its normals point into the first body.
static void create_contact_joints(ob_ode_world *w, struct contact_pair *p, double bounce_speed)
{
	dContact c = { .surface = {
			       .mode = dContactApprox1 | dContactBounce,
			       .mu = sqrt(p->a->friction * p->b->friction),
			       .bounce = fmax(p->a->restitution, p->b->restitution),
			       .bounce_vel = bounce_speed,
		       } };
	bool turned = !p->a->body;
	const ob_vec3 belt = ob_sub(surface_velocity(p->b), surface_velocity(p->a));
	for (int i = 0; i < p->points; i++) {
		c.geom = p->point[i];
		for (int k = 0; turned && k < 3; k++)
			c.geom.normal[k] = -c.geom.normal[k];
		run_surface(&c, turned ? ob_scale(belt, -1) : belt);
		dJointID joint = dJointCreateContact(w->world, w->joints, &c);
		dJointAttach(joint, turned ? p->b->body : p->a->body, turned ? NULL : p->b->body);
		dJointSetFeedback(joint, &p->force[i]);
	}
	p->a->touching = p->b->touching = true;
}

// One ODE step, with all operations that may fail.
typedef struct world_step {
	ob_ode_world *world;
	double h; // s
} world_step;

static void collide_and_step(void *context)
{
	const world_step *x = context;
	ob_ode_world *w = x->world;
	dSpaceCollide(w->space, w, collide_pair);
	for (size_t i = 0; i < w->pairs; i++)
		w->order[i] = &w->pair[i];
	if (w->pairs)
		qsort(w->order, w->pairs, sizeof *w->order, by_ids);
	for (uint32_t id = 0; id < w->setup.objects; id++) {
		struct object *m = &w->object[id];
		if (!is_awake(m))
			continue; // ODE would accumulate forces on a sleeper until it wakes
		m->touching = false;
		dBodySetForce(m->body, m->force.x, m->force.y, m->force.z);
		dBodySetTorque(m->body, m->torque.x, m->torque.y, m->torque.z);
	}
	// Slower than two steps of gravity counts as rest, not as an impact.
	double bounce_speed = 2 * x->h * ob_norm(w->setup.gravity);
	for (size_t i = 0; i < w->pairs; i++)
		create_contact_joints(w, w->order[i], bounce_speed);
	dRandSetSeed((unsigned long)(uint32_t)(w->steps++ * 2654435761u + 1));
	if (w->setup.iterations)
		dWorldQuickStep(w->world, x->h);
	else
		dWorldStep(w->world, x->h);
	dJointGroupEmpty(w->joints);
}

bool ob_ode_world_step(ob_ode_world *w, double h)
{
	w->pairs = 0;
	w->gave_up = !ob_ode_try(collide_and_step, &(world_step){ w, h });
	w->substep = h;
	return !w->gave_up;
}

// Measure of wildness; infinite if a number is NaN.
static double wildness(dBodyID body)
{
	const dReal *p = dBodyGetPosition(body), *v = dBodyGetLinearVel(body), *o = dBodyGetAngularVel(body);
	const dReal *q = dBodyGetQuaternion(body);
	double most = 0, sum = q[0] + q[1] + q[2] + q[3];
	for (int k = 0; k < 3; k++) {
		sum += p[k] + v[k] + o[k];
		most = fmax(most, fmax(fabs(p[k]), fmax(fabs(v[k]), fabs(o[k]))));
	}
	return isfinite(sum) ? most : INFINITY;
}

uint32_t ob_ode_world_culprit(const ob_ode_world *w, bool *full)
{
	uint32_t found = 0;
	double most = -1;
	double *contacts = calloc(w->setup.objects, sizeof *contacts);
	for (size_t i = 0; i < w->pairs && contacts; i++)
		contacts[w->pair[i].a->id]++, contacts[w->pair[i].b->id]++;
	for (uint32_t id = 0; id < w->setup.objects; id++) {
		double blame = w->full              ? contacts ? contacts[id] : 0
			       : w->object[id].body ? wildness(w->object[id].body)
						    : -1;
		if (blame > most)
			most = blame, found = id;
	}
	free(contacts);
	*full = w->full;
	return found;
}

void ob_ode_world_get(const ob_ode_world *w, uint32_t id, ob_state *s, bool *asleep, bool *touching)
{
	const struct object *m = &w->object[id];
	*touching = m->touching;
	*asleep = m->body && !dBodyIsEnabled(m->body);
	*s = m->placed;
	if (!m->body)
		return;
	const dReal *p = dBodyGetPosition(m->body), *q = dBodyGetQuaternion(m->body);
	const dReal *v = dBodyGetLinearVel(m->body), *o = dBodyGetAngularVel(m->body);
	s->pose.p = ob_v3(p[0], p[1], p[2]);
	s->pose.q = (ob_quat){ q[0], q[1], q[2], q[3] };
	s->v = *asleep ? ob_v3(0, 0, 0) : ob_v3(v[0], v[1], v[2]);
	s->w = *asleep ? ob_v3(0, 0, 0) : ob_v3(o[0], o[1], o[2]);
}

uint64_t ob_ode_world_box_tests(const ob_ode_world *w)
{
	return w->box_tests;
}

size_t ob_ode_world_contacts(const ob_ode_world *w, ob_contact_point *out, double *depth, size_t max)
{
	size_t n = 0;
	for (size_t i = 0; i < w->pairs; i++) {
		const struct contact_pair *p = w->order[i];
		for (int k = 0; k < p->points; k++, n++) {
			if (n >= max)
				continue;
			const dReal *x = p->point[k].pos, *f = p->force[k].f1;
			ob_vec3 normal = ob_v3(p->point[k].normal[0], p->point[k].normal[1], p->point[k].normal[2]);
			double push = w->substep * ob_dot(ob_v3(f[0], f[1], f[2]), normal);
			out[n] = (ob_contact_point){ p->a->id, p->b->id, ob_v3(x[0], x[1], x[2]), normal,
						     p->a->body ? push : -push };
			depth[n] = p->point[k].depth;
		}
	}
	return n;
}
