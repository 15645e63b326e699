#include "world/builders.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "elementary/elementary.h"
#include "hull/hull.h"
#include "shape/shape.h"

static void *grown(void *old, uint32_t count, size_t size)
{
	void *more = realloc(old, count * size);
	if (!more) {
		fprintf(stderr, "no memory for a world of %u bodies\n", count);
		abort();
	}
	return more;
}

ob_world_body ob_world_add(ob_world *w, ob_shape shape, ob_vec3 size, double mass, ob_vec3 p)
{
	if (w->objects == w->objects_max) {
		w->objects_max = w->objects_max ? 2 * w->objects_max : 16;
		w->passport = grown(w->passport, w->objects_max, sizeof *w->passport);
		w->state = grown(w->state, w->objects_max, sizeof *w->state);
	}
	uint32_t id = w->objects++;
	w->passport[id] = (ob_passport){ .id = id, .generation = 1, .shape = shape, .size = size, .mass = mass };
	w->passport[id].flags = OB_OBJECT_PRESENT | (mass > 0 ? 0 : OB_OBJECT_STATIC);
	w->passport[id].inertia = ob_shape_inertia(shape, size, NULL, mass);
	w->passport[id].friction = .5;
	w->state[id] = (ob_state){ .pose = { p, ob_quat_identity() } };
	return (ob_world_body){ &w->passport[id], &w->state[id] };
}

ob_world_body ob_world_box(ob_world *w, double mass, ob_vec3 half, ob_vec3 p)
{
	return ob_world_add(w, OB_SHAPE_BOX, half, mass, p);
}

ob_world_body ob_world_sphere(ob_world *w, double mass, double radius, ob_vec3 p)
{
	return ob_world_add(w, OB_SHAPE_SPHERE, ob_v3(radius, 0, 0), mass, p);
}

ob_world_body ob_world_cylinder(ob_world *w, double mass, double radius, double half, ob_vec3 p)
{
	return ob_world_add(w, OB_SHAPE_CYLINDER, ob_v3(radius, half, 0), mass, p);
}

ob_world_body ob_world_capsule(ob_world *w, double mass, double radius, double half, ob_vec3 p)
{
	return ob_world_add(w, OB_SHAPE_CAPSULE, ob_v3(radius, half, 0), mass, p);
}

ob_joint_passport *ob_world_join(ob_world *w, ob_joint_kind kind, uint32_t a, uint32_t b, ob_pose frame)
{
	w->joint = grown(w->joint, w->joints + 1, sizeof *w->joint);
	ob_joint_passport *j = &w->joint[w->joints];
	*j = (ob_joint_passport){ .object = { a, b },
				  .kind = kind,
				  .axis = { .low = -INFINITY, .high = INFINITY },
				  .second = { .low = -INFINITY, .high = INFINITY },
				  .breaks_force = INFINITY,
				  .breaks_torque = INFINITY };
	snprintf(j->name, sizeof j->name, "%s#%u", ob_joint_kind_name(kind), w->joints++);
	for (int side = 0; side < 2; side++) {
		if (j->object[side] == OB_JOINT_WORLD) {
			j->frame[side] = frame;
			continue;
		}
		const ob_pose *body = &w->state[j->object[side]].pose;
		const ob_mat3 r = ob_quat_matrix(body->q);
		j->generation[side] = w->passport[j->object[side]].generation;
		j->frame[side].p = ob_rotate_back(&r, ob_sub(frame.p, body->p));
		j->frame[side].q = ob_quat_mul(ob_quat_conjugate(body->q), frame.q);
	}
	return j;
}

// ---- a ragdoll

static const ob_quat ragdoll_z = { 1, 0, 0, 0 },
		     ragdoll_y = { M_SQRT1_2, -M_SQRT1_2, 0, 0 }; // a joint's z axis along z, y

static void add_limb(ob_world *w, ob_vec3 from, ob_vec3 to, double radius)
{
	const double density = 1000, half = .5 * ob_norm(ob_sub(to, from));
	const double mass = density * M_PI * radius * radius * (2 * half + 4. / 3 * radius);
	const ob_vec3 n = ob_scale(ob_sub(to, from), .5 / half);
	ob_world_body b = ob_world_capsule(w, mass, radius, half, ob_scale(ob_add(from, to), .5));
	b.state->pose.q = ob_quat_normalize((ob_quat){ 1 + n.z, -n.y, n.x, 0 });
}

// Lets an axis turn so far, with dry friction (N m).
static void stiffen(ob_joint_passport *j, ob_joint_axis *a, double low, double high, double friction)
{
	const double damping = .1; // N m s
	j->flags |= OB_JOINT_DRIVEN;
	a->low = low, a->high = high, a->friction = friction, a->damping = damping;
}

// Shoulder, elbow, hip and knee of a side.
static void add_limbs(ob_world *w, uint32_t trunk, int side)
{
	enum { JOINTS = 4 };
	const ob_vec3 at[JOINTS] = {
		{ 0, .17 * side, 1.4 }, { .05, .475 * side, 1.29 }, { 0, .1 * side, .93 }, { .05, .12 * side, .5 }
	};
	const uint32_t first = w->objects;
	add_limb(w, ob_v3(0, .24 * side, 1.375), ob_v3(.045, .41 * side, 1.31), .05);
	add_limb(w, ob_v3(.06, .53 * side, 1.275), ob_v3(.2, .66 * side, 1.2), .045);
	add_limb(w, ob_v3(0, .11 * side, .8), ob_v3(.04, .12 * side, .58), .075);
	add_limb(w, ob_v3(.045, .12 * side, .43), ob_v3(0, .13 * side, .1), .06);
	for (uint32_t k = 0; k < JOINTS; k++) {
		const bool hinge = k % 2;
		ob_joint_passport *j = ob_world_join(w, hinge ? OB_JOINT_HINGE : OB_JOINT_UNIVERSAL, first + k,
						     hinge ? first + k - 1 : trunk,
						     (ob_pose){ at[k], k == 3 ? ragdoll_y : ragdoll_z });
		stiffen(j, &j->axis, hinge ? -.1 : -1.2, hinge ? 2 : 1.2, .4);
		if (!hinge)
			stiffen(j, &j->second, -1.3, 1.3, .4);
	}
}

void ob_world_ragdoll(ob_world *w, ob_vec3 p, double lean)
{
	const uint32_t trunk = w->objects;
	const ob_quat q = { ob_cos(.5 * lean), .6 * ob_sin(.5 * lean), .8 * ob_sin(.5 * lean), 0 };
	const ob_mat3 r = ob_quat_matrix(q);
	add_limb(w, ob_v3(0, 0, 1), ob_v3(0, 0, 1.4), .13);
	ob_world_sphere(w, 5, .11, ob_v3(0, 0, 1.68));
	ob_joint_passport *neck =
		ob_world_join(w, OB_JOINT_UNIVERSAL, trunk + 1, trunk, (ob_pose){ { 0, 0, 1.55 }, ragdoll_z });
	stiffen(neck, &neck->axis, -.5, .5, .3);
	stiffen(neck, &neck->second, -.6, .6, .3);
	add_limbs(w, trunk, -1);
	add_limbs(w, trunk, 1);
	for (uint32_t id = trunk; id < w->objects; id++) {
		ob_pose *pose = &w->state[id].pose;
		pose->p = ob_add(ob_rotate(&r, pose->p), p);
		pose->q = ob_quat_mul(q, pose->q);
		w->passport[id].friction = .8;
	}
}

ob_world_body ob_world_ground(ob_world *w)
{
	return ob_world_add(w, OB_SHAPE_PLANE, ob_v3(0, 0, 0), 0, ob_v3(0, 0, 0));
}

void ob_world_material(ob_world *w, double friction, double restitution)
{
	for (uint32_t i = 0; i < w->objects; i++) {
		w->passport[i].friction = friction;
		w->passport[i].restitution = restitution;
	}
}

void ob_world_kinematic(ob_world_body b)
{
	b.passport->flags = OB_OBJECT_PRESENT | OB_OBJECT_KINEMATIC;
	b.passport->mass = 0;
	b.passport->inertia = ob_v3(0, 0, 0);
}

void ob_world_swing(ob_world *w, ob_world_body b, ob_vec3 amplitude, double frequency, double phase)
{
	ob_world_kinematic(b);
	w->path = grown(w->path, w->paths + 1, sizeof *w->path);
	w->path[w->paths++] =
		(struct ob_world_path){ b.passport->id, ob_path_sine(b.state, amplitude, frequency, phase) };
}

// Number of the hull, which its parts follow; several bodies may share one.
static uint32_t add_hull(ob_world *w, const ob_hull *h)
{
	const uint32_t all = 1 + h->parts, number = w->hulls;
	for (uint32_t i = 0; i + all <= w->hulls; i++)
		if (!memcmp(&w->hull[i], h, all * sizeof *h))
			return i;
	w->hull = grown(w->hull, w->hulls + all, sizeof *w->hull);
	memcpy(w->hull + number, h, all * sizeof *h);
	w->hulls += all;
	return number;
}

static ob_world_body add_hulled(ob_world *w, double mass, const ob_hull *h, ob_vec3 p)
{
	ob_world_body b = ob_world_add(w, OB_SHAPE_HULL, ob_hull_size(h), mass, ob_add(p, h->centre));
	b.passport->hull = (uint16_t)add_hull(w, h);
	b.passport->inertia = ob_scale(h->inertia, mass);
	b.state->pose.q = h->frame;
	return b;
}

ob_world_body ob_world_hull(ob_world *w, double mass, const ob_vec3 *point, uint32_t points, ob_vec3 p)
{
	ob_hull h;
	ob_error e;
	if (!ob_hull_build(point, points, &h, &e)) {
		fprintf(stderr, "hull: %s\n", e.text);
		abort();
	}
	return add_hulled(w, mass, &h, p);
}

ob_world_body ob_world_compound(ob_world *w, double mass, const ob_hull_part *part, uint32_t parts, ob_vec3 p)
{
	ob_hull *h = grown(NULL, 1 + parts, sizeof *h);
	uint32_t failed;
	ob_error e;
	if (!ob_hull_build_compound(part, parts, ob_v3(NAN, NAN, NAN), h, &failed, &e)) {
		fprintf(stderr, "compound: %s\n", e.text);
		abort();
	}
	const ob_world_body b = add_hulled(w, mass, h, p);
	free(h);
	return b;
}

ob_world_body ob_world_terrain(ob_world *w, ob_terrain *t, ob_vec3 p)
{
	const uint32_t number = w->terrains ? (uint32_t)w->terrains->count : 0;
	ob_error e = { "there is none" };
	if (!t || !ob_terrain_set_add(&w->terrains, t, &e)) {
		fprintf(stderr, "terrain: %s\n", e.text);
		abort();
	}
	const ob_world_body b = ob_world_add(w, OB_SHAPE_TERRAIN, ob_terrain_size(t), 0, p);
	b.passport->hull = (uint16_t)number;
	free(t);
	return b;
}

ob_world_body ob_world_slope(ob_world *w, double angle)
{
	ob_world_body b = ob_world_ground(w);
	b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, angle, 0));
	return b;
}

void ob_world_stack(ob_world *w, int n, ob_vec3 foot, uint64_t seed)
{
	for (int i = 0; i < n; i++) {
		double x = ob_splitmix_within(&seed, -.01, .01), y = ob_splitmix_within(&seed, -.01, .01);
		ob_world_box(w, 1000, ob_v3(.5, .5, .5), ob_add(foot, ob_v3(x, y, .5 + i)));
	}
}

// Size with the volume of a box of these half extents: a cylinder of the same height, or a capsule twice as long as
// thick.
static ob_vec3 size_of_volume(ob_shape shape, ob_vec3 half)
{
	const double radius = ob_pow(8 * half.x * half.y * half.z / (10. / 3 * M_PI), 1. / 3);
	if (shape == OB_SHAPE_CYLINDER)
		return ob_v3(sqrt(4 * half.x * half.y / M_PI), half.z, 0);
	return shape == OB_SHAPE_CAPSULE ? ob_v3(radius, radius, 0) : half;
}

static ob_world_body solid_of_any_size(ob_world *w, ob_shape shape, ob_vec3 p, uint64_t *seed)
{
	ob_vec3 half = ob_add(ob_v3(.3, .3, .3), ob_splitmix_vector(seed, .2));
	ob_world_body b = ob_world_add(w, shape, size_of_volume(shape, half), 8000 * half.x * half.y * half.z, p);
	b.state->pose.q = ob_world_random_attitude(seed);
	return b;
}

// Side of the square that holds n bodies.
static uint32_t side_of(uint32_t n)
{
	return (uint32_t)ceil(sqrt(n));
}

void ob_world_falling(ob_world *w, uint32_t n, uint64_t seed)
{
	ob_world_falling_solids(w, OB_SHAPE_BOX, n, seed);
}

void ob_world_falling_solids(ob_world *w, ob_shape shape, uint32_t n, uint64_t seed)
{
	enum { LEVELS = 4 };
	uint32_t side = side_of((n + LEVELS - 1) / LEVELS);
	double z = 0;
	ob_world_ground(w);
	for (uint32_t i = 0; i < n; i++) {
		uint32_t column = i / LEVELS;
		z = (i % LEVELS ? z : 1) + 1.8 + ob_splitmix_real(&seed);
		solid_of_any_size(w, shape, ob_v3(1.8 * (column % side), 1.8 * (column / side), z), &seed);
	}
}

void ob_world_sparse(ob_world *w, uint32_t n, uint64_t seed)
{
	uint32_t side = side_of(n);
	ob_world_ground(w);
	for (uint32_t i = 0; i < n; i++) {
		ob_vec3 p = ob_v3(4. * (i % side), 4. * (i / side), ob_splitmix_within(&seed, 2, 10));
		ob_world_body b = solid_of_any_size(w, OB_SHAPE_BOX, p, &seed);
		b.state->v = ob_splitmix_vector(&seed, 1);
		b.state->v.z = ob_splitmix_within(&seed, 0, 4);
		b.state->w = ob_splitmix_vector(&seed, 1);
	}
	ob_world_material(w, .5, .8);
}

void ob_world_balls(ob_world *w, uint32_t n)
{
	uint32_t side = side_of(n);
	ob_world_ground(w);
	for (uint32_t i = 0; i < n; i++)
		ob_world_sphere(w, 10, .1, ob_v3(2. * (i % side), 2. * (i / side), 5));
	ob_world_material(w, 0, 1);
}

ob_quat ob_world_random_attitude(uint64_t *seed)
{
	double w = ob_splitmix_within(seed, -1, 1);
	ob_vec3 v = ob_splitmix_vector(seed, 1);
	return ob_quat_normalize((ob_quat){ w, v.x, v.y, v.z });
}
