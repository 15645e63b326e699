// The baseline: one ODE world that holds every object, as in usual virtual environments: sweep-and-prune space, up to 4
// contact points a pair (8 with a cylinder), friction pyramid, ODE's own parameters throughout.
//
// Thread-safety: one thread at a time per world. QuickStep shuffles its rows by a seed of the whole process, which each
// step resets: every run has the same bits, as long as no other world of the process steps at the same time.
#ifndef OB_ODE_WORLD_H
#define OB_ODE_WORLD_H

#include <ob/joint.h>
#include <ob/motion.h>

typedef struct ob_ode_world ob_ode_world;
typedef struct ob_ode_world_setup {
	ob_vec3 gravity;
	uint32_t iterations; // QuickStep; 0 = dWorldStep (the big-matrix solver)
	uint32_t objects; // ids are 0 .. objects-1
	bool sleeping; // ODE's auto-disable
	bool boxed; // contacts of the objects' axis-aligned boxes
	uint32_t pairs_max; // maximum of pairs in contact in a step; 0 = limited by memory
	uint32_t load; // ob_synthetic_load, at each pair of overlapping boxes found by the space
	bool hashed; // a hash space finds the pairs, instead of sweep and prune
	double surface_layer; // m, depth to which contacts may sink; 0 = ODE's default, also below
	double softness; // constraint force mixing (kg^-1) of all constraints
	double correcting_speed; // m/s, maximum speed of penetration correction
	uint32_t joints; // their numbers are 0 .. joints-1
	bool (*may_touch)(const void *of, uint32_t a,
			  uint32_t b); // false: the two pass through each other; NULL: all may
	const void *of;
} ob_ode_world_setup;

ob_ode_world *ob_ode_world_create(const ob_ode_world_setup *s); // NULL: no memory
void ob_ode_world_destroy(ob_ode_world *w); // NULL is allowed
// Adds an object; p->id must be free.
void ob_ode_world_add(ob_ode_world *w, const ob_passport *p, const ob_state *s);
// Triangles in the frame of their object, m. The arrays stay as they are while it is in the world.
typedef struct ob_ode_triangles {
	const ob_vec3 *vertex;
	const uint32_t *corner; // three vertices of the first triangle; those of the next lie "stride" bytes on
	uint32_t vertices, triangles, stride;
} ob_ode_triangles;
// Adds a static object of triangles. false: no memory.
bool ob_ode_world_add_triangles(ob_ode_world *w, const ob_passport *p, const ob_state *s, const ob_ode_triangles *t);
// Sets the pose and velocity of a kinematic object before the next step.
void ob_ode_world_drive(ob_ode_world *w, uint32_t id, const ob_state *s);
// Sets the constant force (N) and torque (N m) of an object; it wakes if they change.
void ob_ode_world_push(ob_ode_world *w, uint32_t id, ob_vec3 force, ob_vec3 torque);
// Applies an impulse (N s) at the centre of a dynamic object, and an angular one (N m s). It wakes.
void ob_ode_world_kick(ob_ode_world *w, uint32_t id, ob_vec3 impulse, ob_vec3 twist);
// Removes an object; objects in contact with it wake. Does nothing if there is no such object.
void ob_ode_world_remove(ob_ode_world *w, uint32_t id);
// True if the world has such a joint: no distances with something along them, and one thing along an axis, beside limits.
bool ob_ode_has_joint(const ob_joint_passport *j);
// Joins objects that were added, or one and the world, as the passport has them; not OB_JOINT_APART. They never sleep.
// false: no memory.
bool ob_ode_world_join(ob_ode_world *w, uint32_t number, const ob_joint_passport *j);
void ob_ode_world_unjoin(ob_ode_world *w, uint32_t number); // does nothing if there is none
// Sets what acts along the axis of a joint before a step of h (s).
void ob_ode_world_drive_joint(ob_ode_world *w, uint32_t number, const ob_joint_axis *axis, double h);
// Action of a joint on its first object in the last step. false: there is no such joint.
bool ob_ode_world_joint_load(const ob_ode_world *w, uint32_t number, ob_joint_load *out);
// Collides and steps by h (s). Skips pairs without an awake dynamic object. Returns false if pairs do not fit, or ODE
// gave up; the world may only be destroyed then.
bool ob_ode_world_step(ob_ode_world *w, double h);
// After a failed step, the object to blame. full: the object with most contacts, as pairs did not fit; otherwise the
// one with the wildest motion, as ODE gave up.
uint32_t ob_ode_world_culprit(const ob_ode_world *w, bool *full);
// Copies the state of an object. touching: it had a contact when it was last awake.
void ob_ode_world_get(const ob_ode_world *w, uint32_t id, ob_state *s, bool *asleep, bool *touching);
// Number of overlapping pairs of boxes found by the space, at least one of each moving, in all steps.
uint64_t ob_ode_world_box_tests(const ob_ode_world *w);
// Contact points of the last step, sorted by (a, b); depth[i] (m) of each. Returns their number (may exceed max).
size_t ob_ode_world_contacts(const ob_ode_world *w, ob_contact_point *out, double *depth, size_t max);

#endif
