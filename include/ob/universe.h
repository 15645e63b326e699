// The universe for readers: existence, poses and motions of objects.
//
// A universe is one block of POSIX shared memory, made by a host process. For each object it holds body properties
// (ob_passport; they rarely change) and a motion (valid from an instant on). A reader attaches read-only, copies
// records without locks, and evaluates motions at its own time with the functions of <ob/motion.h>.
//
// Thread-safety: any number of threads and processes may read at once; an ob_universe handle itself is immutable after
// attach and may be shared between threads. Readers never block a writer and never write. All data read is validated;
// no byte of the table can crash a reader. Units: SI, radians. Frame: right-handed world frame, z up.
#ifndef OB_UNIVERSE_H
#define OB_UNIVERSE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>
#include <ob/vec.h>

#define OB_NAME_MAX 48 // bytes of a universe's or object's name, with the final 0
#define OB_DEATH_MAX 248 // bytes of the description of a simulator's death, with the final 0

#pragma GCC visibility push(default) // libobsim exports the declarations of its installed headers alone

typedef enum ob_shape {
	OB_SHAPE_NONE,
	OB_SHAPE_SPHERE, // size.x = radius
	OB_SHAPE_BOX, // size = half extents along the body axes
	OB_SHAPE_PLANE, // infinite; through the origin of its pose, solid below its +z axis; always static
	OB_SHAPE_CAPSULE, // size.x = radius, size.y = half length of the cylinder part; axis = body z
	OB_SHAPE_CYLINDER, // size.x = radius, size.y = half length; axis = body z
	// of points (ob/hull.h); size = radius of the bounding ball, half the least width, radius of the inscribed
	// ball, both balls about the centre of mass
	OB_SHAPE_HULL,
	// surface of triangles; size = half extents of a box about the origin that holds it; always static
	OB_SHAPE_TERRAIN,
} ob_shape;

enum { // ob_passport.flags
	OB_OBJECT_PRESENT = 1 << 0, // exists now; a slot without it is free
	OB_OBJECT_STATIC = 1 << 1, // never moves; mass and inertia are 0
	OB_OBJECT_FROZEN = 1 << 2, // static since its simulator died
	OB_OBJECT_KINEMATIC = 1 << 3, // follows a prescribed motion, unaffected by contacts; mass and inertia are 0
	OB_OBJECT_PRESCRIBED = OB_OBJECT_STATIC | OB_OBJECT_KINEMATIC, // unaffected by forces
	OB_OBJECT_MESH_COLOUR = 1 << 4, // shown with its mesh's colours, not its own
	OB_OBJECT_MESH_SURFACE = 1 << 5, // shown with its mesh's roughness and metal
	OB_OBJECT_SENSOR = 1 << 6, // no obstacle: nothing touches it; ob_universe_get_inside lists the objects in it
	OB_OBJECT_HIDDEN = 1 << 7, // not drawn
};

// Pattern of a surface, in metres of the object's own frame; boxes and planes alone.
typedef enum ob_pattern {
	OB_PATTERN_PLAIN,
	OB_PATTERN_TILES,
	OB_PATTERN_SLABS,
	OB_PATTERN_BRICKS,
	OB_PATTERN_PLANKS,
	OB_PATTERN_CHECKER,
	OB_PATTERNS,
} ob_pattern;
enum { // in ob_passport.flags
	OB_OBJECT_PATTERN = 8, // shift: ob_pattern
	OB_OBJECT_PATTERN_BITS = 7,
};

enum { // collision groups, in the other half of ob_passport.flags
	OB_GROUPS = 16, // from 0
	OB_OBJECT_GROUP = 12, // shift: the object's group, four bits
	OB_OBJECT_PASSES = 16, // shift: bit g, it passes through objects of group g
};

// Body properties of an object. 184 bytes.
typedef struct ob_passport {
	uint32_t id; // index of the object in the table, from 0
	uint32_t generation; // grows each time the slot is reused for another object
	uint32_t flags; // OB_OBJECT_*; pattern, collision group, and those that it passes, from their bits on
	uint8_t shape; // ob_shape: collision shape; also drawn unless it has a mesh
	// 1 + the number of the scene's mesh that is drawn instead; 0 = none. Viewers load the meshes
	uint8_t mesh;
	uint16_t hull; // OB_SHAPE_HULL: number of the universe's hull (ob_universe_get_hull)
	ob_vec3 size; // m, see ob_shape
	double mass; // kg; 0 = static
	ob_vec3 inertia; // kg m^2, principal moments in the body frame; 0 = static
	double friction; // Coulomb coefficient; a pair uses sqrt(mu_a mu_b)
	double restitution; // 0..1; a pair uses the larger of the two
	float colour[4]; // linear RGB, alpha: 1
	char name[OB_NAME_MAX];
	union {
		ob_vec3 force; // N, world frame: constant, acts at the centre
		ob_vec3 surface_velocity; // m/s, body frame, prescribed objects: speed of the surface, as of a belt
	};
	float roughness; // 0..1, of its surface when drawn: 0 = polished, 1 = matt
	float metal; // 0..1: 1 = reflects as metals do, in its own colour
} ob_passport;

static inline ob_pattern ob_passport_pattern(const ob_passport *p)
{
	const uint32_t pattern = p->flags >> OB_OBJECT_PATTERN & OB_OBJECT_PATTERN_BITS;
	return pattern < OB_PATTERNS ? (ob_pattern)pattern : OB_PATTERN_PLAIN;
}

static inline uint32_t ob_passport_group(const ob_passport *p)
{
	return p->flags >> OB_OBJECT_GROUP & (OB_GROUPS - 1);
}

// True if neither of the two passes through the other's group.
static inline bool ob_passport_hits(const ob_passport *a, const ob_passport *b)
{
	const uint32_t a_passes = a->flags >> OB_OBJECT_PASSES, b_passes = b->flags >> OB_OBJECT_PASSES;
	return !((a_passes >> ob_passport_group(b) | b_passes >> ob_passport_group(a)) & 1);
}

// True if the two are obstacles to each other: they may have contacts. A joint may still let them overlap.
static inline bool ob_passport_collides(const ob_passport *a, const ob_passport *b)
{
	return !((a->flags | b->flags) & OB_OBJECT_SENSOR) && ob_passport_hits(a, b);
}

enum { // ob_motion.flags
	OB_MOTION_FREE = 1 << 0, // in free flight: up to t0, the previous motion holds exactly
	OB_MOTION_ASLEEP = 1 << 1, // asleep: all bodies of its island have been slow for long enough
	// held by its contacts; the solver changed nothing about it at the end of the last step
	OB_MOTION_STEADY = 1 << 2,
	OB_MOTION_EQUILIBRIUM = 1 << 3, // in equilibrium: skipped by the solver until something touches it
	OB_MOTION_RESTS = OB_MOTION_ASLEEP | OB_MOTION_EQUILIBRIUM, // either: it stays where it is
	// the centre moves along an ellipse, or to and fro, with a frequency; kinematic objects alone
	OB_MOTION_SWINGS = 1 << 4,
	OB_MOTION_DOUBTED = 1 << 5, // alone, with contacts that go on: its errors exceed the tolerance, by estimate,
	OB_MOTION_REFINED = 1 << 6, // so its substeps were refined,
	OB_MOTION_UNREFINED = 1 << 7, // or that does not help
	OB_MOTION_REFINEMENT = OB_MOTION_DOUBTED | OB_MOTION_REFINED | OB_MOTION_UNREFINED,
};

// Motion of an object from t0 on, unless a contact changes it. 176 bytes: the payload of one slot version.
typedef struct ob_motion {
	double t0; // s, the instant of the state below; start of a flight
	double valid_until; // s, end of validity of the closed form, unless another object interferes
	ob_vec3 p; // m, centre of mass
	ob_quat q; // body to world
	ob_vec3 v; // m/s
	ob_vec3 w; // rad/s, world frame
	ob_vec3 a; // m/s^2, constant while the motion holds, unless it swings (gravity in flight, 0 when supported)
	double path; // m, length of path of the fastest surface point since the run began
	uint32_t step; // the step that published this
	uint16_t flags; // OB_MOTION_*
	uint16_t deviation_rate; // m/s by which the deviation grows after that step, coded alike
	union {
		struct {
			float rest_time; // s, rest timer: time below the sleeping threshold
			uint32_t island; // lowest id in the island that solved it
		};
		double frequency; // rad/s, if it swings: then a is the acceleration at t0
	};
	float reach; // m, most that each step adds to that path, until the next publication
	uint16_t substeps; // requested by its island for the next step, if a tolerance chooses; 0 = none yet
	uint16_t deviation; // bound of the errors since the second began: 2^(deviation / 1024 - 48) m; 0 = none
} ob_motion;

typedef enum ob_universe_state {
	OB_UNIVERSE_STARTING,
	OB_UNIVERSE_RUNNING,
	OB_UNIVERSE_FINISHED, // ended as planned: no step follows
	OB_UNIVERSE_FAILED,
	OB_UNIVERSE_LOST, // another program has truncated its memory: nothing of it can be read any more
} ob_universe_state;

// Facts of a run that are constant once it has started, and its clock.
typedef struct ob_universe_info {
	char name[OB_NAME_MAX];
	char isolation[16]; // "thread" or "process"
	char arch[16]; // "obs" or "monolith"
	int32_t host_pid;
	uint32_t capacity; // slots: ids are 0 .. capacity-1
	uint32_t objects; // present objects, static ones included
	uint32_t workers; // the last of a hardened run only schedules
	ob_vec3 gravity; // m/s^2
	double step_length; // s
	uint64_t step; // steps completed
	double time; // s, simulated
	ob_universe_state state;
	uint32_t awake; // dynamic objects that are not asleep
	uint32_t pairs; // pairs whose bounds overlap
	uint32_t islands; // groups solved together in the last step
	uint32_t deaths; // times that simulators died or stalled
	uint32_t frozen; // objects frozen by them (OB_OBJECT_FROZEN)
	char last_death[OB_DEATH_MAX]; // the simulator and its cause of death; "" = none
	uint32_t hulls; // hulls are numbered 0 .. hulls-1; more may come
	uint64_t created; // ns since 1970: no other universe has the same name and instant
} ob_universe_info;

typedef struct ob_worker_info {
	int32_t pid, tid;
	int32_t cpu; // pinned to; -1 = not pinned
	uint32_t objects; // objects that it ran in the last step
	uint64_t cpu_ns; // CPU time used so far, refreshed by the host about twice a second
} ob_worker_info;

// Contact point of two objects, for overlays.
typedef struct ob_contact_point {
	uint32_t a, b; // ids, a < b
	ob_vec3 position; // m, world
	ob_vec3 normal; // unit, from b towards a
	double impulse; // N s, normal, of the last substep
} ob_contact_point;

typedef struct ob_universe ob_universe;

// Attaches read-only to the running universe "name" (as `obsim top` shows it). NULL and e on failure: no such
// universe, or another layout version.
ob_universe *ob_universe_attach(const char *name, ob_error *e);
void ob_universe_detach(ob_universe *u); // NULL is allowed
// True while the host of an attached universe, or the process that cleans up after it, exists. Otherwise the universe
// no longer changes.
bool ob_universe_is_hosted(const ob_universe *u);

// Names of the universes on this machine, newest first. Returns their number (may exceed max).
size_t ob_universe_list(char names[][OB_NAME_MAX], size_t max);

// Call at the beginning of each read of the universe: it also checks with the system that all of the universe's memory
// exists. If not, the state is OB_UNIVERSE_LOST from now on, and all functions below return false, or 0. If a program
// of the same user truncates the memory during a read, the reader ends (SIGBUS).
void ob_universe_get_info(const ob_universe *u, ob_universe_info *out);
// Waits until so many steps are complete, without polling where the universe pauses there. false: not within timeout (s),
// or no further step will come.
bool ob_universe_wait(const ob_universe *u, uint64_t step, double timeout);
// Returns false if there is no such worker.
bool ob_universe_get_worker(const ob_universe *u, uint32_t worker, ob_worker_info *out);
// Home worker of the object's simulator: the one that solved its island last, or to which it was moved; its own, if
// each object has one. Returns false without one: objects unaffected by forces, or not yet solved.
bool ob_universe_get_home(const ob_universe *u, uint32_t id, uint32_t *worker);
// Own time (s) of the object's simulator in a free run: at or after the universe's, which all have passed. Returns false
// in lockstep, or without a simulator.
bool ob_universe_get_own_time(const ob_universe *u, uint32_t id, double *time);
// Returns false if no object has this id now.
bool ob_universe_get_passport(const ob_universe *u, uint32_t id, ob_passport *out);
// Version of the body properties: changes with them, so a reader can tell that its copy is outdated; 0: no such object.
uint64_t ob_universe_get_passport_version(const ob_universe *u, uint32_t id);
// Newest published motion; never torn. Returns false if there is no such object, or its bytes are implausible.
bool ob_universe_get_motion(const ob_universe *u, uint32_t id, ob_motion *out);
// States of all objects at one instant, as arrays of the caller; NULL leaves one out. Row i of each is an object's; ids
// ascend. Positions are those of the centres of mass.
typedef struct ob_state_arrays {
	uint32_t *id, *generation; // [max]
	double *position; // [max][3], m
	double *attitude; // [max][4], w x y z, body to world
	double *velocity, *angular_velocity; // [max][3], m/s; rad/s; world frame
} ob_state_arrays;
// Evaluates all objects at the universe's clock, and writes the first max; returns their number (may exceed max). The
// states are of one instant while the universe stands at a step boundary; while it runs, some may be a step newer.
size_t ob_universe_get_states(const ob_universe *u, const ob_state_arrays *out, size_t max);
// Fat AABB (m, xmin ymin zmin xmax ymax zmax) that contains the object until it publishes another; a plane's is
// infinite. Each number is whole, but while the universe runs a reader may get some numbers of a new box beside some of
// the old. Returns false if there is no such object, or its numbers are implausible.
bool ob_universe_get_bounds(const ob_universe *u, uint32_t id, float bounds[6]);
// Contact points of the last completed step; returns their number (may exceed max).
size_t ob_universe_get_contacts(const ob_universe *u, ob_contact_point *out, size_t max);

// Objects that move and whose shapes overlap that of a sensor, among those that it and they hit by their groups, at the
// universe's clock; ids ascend. Returns their number (may exceed max); 0 without such a sensor. An object that passes it
// between two step boundaries is not found. While the universe runs, some motions may be a step newer.
size_t ob_universe_get_inside(const ob_universe *u, uint32_t sensor, uint32_t *ids, size_t max);

// Copies the terrains of a universe in obsim's own format, which differs between versions. Returns their bytes, of which
// at most room are copied; 0: there are none.
size_t ob_universe_get_terrains(const ob_universe *u, void *to, size_t room);

#pragma GCC visibility pop

#endif
