// The universe as readers see it: what exists, where it is, how it moves.
//
// A universe is one block of POSIX shared memory, made by a host process. It holds, for each object, a
// passport (what it is; changes rarely) and a motion (how it moves, valid from an instant on). A reader
// attaches read-only, copies what it needs without locks, and evaluates motions at its own time with the
// functions of <ob/motion.h>.
//
// Thread-safety: any number of threads and processes may read at once; an ob_universe handle itself is
// immutable after attach and may be shared between threads. Readers never block a writer and never write.
// Everything that is read is validated; no byte of the table can crash a reader.
// Units: SI, radians. Frame: right-handed world frame, z up.
#ifndef OB_UNIVERSE_H
#define OB_UNIVERSE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>
#include <ob/vec.h>

#define OB_NAME_MAX 48 // bytes of a universe's or object's name, with the final 0
#define OB_DEATH_MAX 248 // bytes of what is said of a simulator's death, with the final 0

#pragma GCC visibility push(default) // libobsim shows what its installed headers declare, nothing else

typedef enum ob_shape {
	OB_SHAPE_NONE,
	OB_SHAPE_SPHERE,   // size.x = radius
	OB_SHAPE_BOX,      // size = half extents along the body axes
	OB_SHAPE_PLANE,    // infinite; through the origin of its pose, solid below its +z axis; always static
	OB_SHAPE_CAPSULE,  // size.x = radius, size.y = half length of the cylinder part; axis = body z
	OB_SHAPE_CYLINDER, // size.x = radius, size.y = half length; axis = body z
	OB_SHAPE_HULL,     // of points (ob/hull.h); size = radius of the ball that holds it, half its least width, radius
			   // of the ball in it, both balls about the centre of mass
} ob_shape;

enum { // ob_passport.flags
	OB_OBJECT_PRESENT = 1 << 0, // exists now; a slot without it is free
	OB_OBJECT_STATIC = 1 << 1,  // never moves; mass and inertia are 0
	OB_OBJECT_FROZEN = 1 << 2,  // static since its simulator died
	OB_OBJECT_KINEMATIC = 1 << 3, // moves as it is told, whatever touches it; mass and inertia are 0
	OB_OBJECT_PRESCRIBED = OB_OBJECT_STATIC | OB_OBJECT_KINEMATIC, // no force moves it
	OB_OBJECT_MESH_COLOUR = 1 << 4, // its mesh's colours are shown, not its own
	OB_OBJECT_MESH_SURFACE = 1 << 5, // the same of roughness and metal
};

// What an object is. 184 bytes.
typedef struct ob_passport {
	uint32_t id;          // index of the object in the table, from 0
	uint32_t generation;  // grows each time the slot is given to another object
	uint32_t flags;       // OB_OBJECT_*
	uint8_t shape;        // ob_shape: as what it collides, and what it looks like unless it has a mesh
	uint8_t mesh;         // 1 + the number of the scene's mesh that it looks like; 0 = none. Who draws has the meshes
	uint16_t hull;        // of a hull: which of the universe's (ob_universe_get_hull)
	ob_vec3 size;         // m, see ob_shape
	double mass;          // kg; 0 = static
	ob_vec3 inertia;      // kg m^2, principal moments in the body frame; 0 = static
	double friction;      // Coulomb coefficient; a pair uses sqrt(mu_a mu_b)
	double restitution;   // 0..1; a pair uses the larger of the two
	float colour[4];      // linear RGB, alpha
	char name[OB_NAME_MAX];
	union {
		ob_vec3 force;            // N, world frame: constant, acts at the centre
		ob_vec3 surface_velocity; // m/s, body frame, of what is prescribed: at which its surface runs, as a belt's does
	};
	float roughness;      // 0..1, of its surface to the eye: 0 = polished, 1 = matt
	float metal;          // 0..1: whether it reflects as metals do, in its own colour
} ob_passport;

enum { // ob_motion.flags
	OB_MOTION_FREE = 1 << 0,   // in free flight: up to t0, what was published before holds exactly
	OB_MOTION_ASLEEP = 1 << 1, // asleep: every body of its island had been slow for long enough
	OB_MOTION_STEADY = 1 << 2, // its contacts hold it, and the solver changed nothing about it when the last step ended
	OB_MOTION_EQUILIBRIUM = 1 << 3, // in equilibrium: it is not solved again until something touches it
	OB_MOTION_RESTS = OB_MOTION_ASLEEP | OB_MOTION_EQUILIBRIUM, // either: it stays where it is
	OB_MOTION_SWINGS = 1 << 4, // the centre goes about an ellipse, or to and fro, with a frequency; kinematic objects alone
};

// How an object moves from t0 on, unless touched. 176 bytes: the payload of one slot version.
typedef struct ob_motion {
	double t0;          // s, the instant of the state below: of a flight, when it began
	double valid_until; // s, the closed form holds so long, unless another object interferes
	ob_vec3 p;          // m, centre of mass
	ob_quat q;          // body to world
	ob_vec3 v;          // m/s
	ob_vec3 w;          // rad/s, world frame
	ob_vec3 a;          // m/s^2, constant while the motion holds, unless it swings (gravity in flight, 0 when supported)
	double path;        // m, length of path of the fastest surface point since the run began
	uint32_t step;      // the step that published this
	uint32_t flags;     // OB_MOTION_*
	union {
		struct {
			float rest_time; // s, rest timer: how long it has been slower than the sleeping threshold
			uint32_t island; // lowest id of the island in which it was solved
		};
		double frequency; // rad/s, if it swings: then a is the acceleration at t0
	};
	float reach;        // m, how much of that path each step adds at most, until something else is published
	uint32_t substeps;  // that its island asks for in the next step, where a tolerance chooses; 0 = none yet
} ob_motion;

typedef enum ob_universe_state {
	OB_UNIVERSE_STARTING,
	OB_UNIVERSE_RUNNING,
	OB_UNIVERSE_FINISHED, // ended as planned; the table stays as it was at the end
	OB_UNIVERSE_FAILED,
	OB_UNIVERSE_LOST,     // another program has cut its memory short: nothing of it can be read any more
} ob_universe_state;

// Facts of a run that do not change once it has started, and its clock.
typedef struct ob_universe_info {
	char name[OB_NAME_MAX];
	char isolation[16];   // "thread" or "process"
	char arch[16];        // "obs" or "monolith"
	int32_t host_pid;
	uint32_t capacity;    // slots: ids are 0 .. capacity-1
	uint32_t objects;     // present objects, static ones included
	uint32_t workers;     // the last of a hardened run only schedules
	ob_vec3 gravity;      // m/s^2
	double step_length;   // s
	uint64_t step;        // steps completed
	double time;          // s, simulated
	ob_universe_state state;
	uint32_t awake;       // dynamic objects that are not asleep
	uint32_t pairs;       // pairs whose bounds overlap
	uint32_t islands;     // groups that were solved together in the last step
	uint32_t deaths;      // times that simulators died or stalled
	uint32_t frozen;      // objects that stay where they are since then (OB_OBJECT_FROZEN)
	char last_death[OB_DEATH_MAX]; // which it was, and of what; "" = none
	uint32_t hulls;       // hulls are numbered 0 .. hulls-1; more may come
	uint64_t created;     // ns since 1970: no other universe has the same name and instant
} ob_universe_info;

typedef struct ob_worker_info {
	int32_t pid, tid;
	int32_t cpu;         // pinned to; -1 = not pinned
	uint32_t objects;    // objects that it ran in the last step
	uint64_t cpu_ns;     // CPU time used so far, refreshed by the host about twice a second
} ob_worker_info;

// A point where two objects touch, for overlays.
typedef struct ob_contact_point {
	uint32_t a, b;       // ids, a < b
	ob_vec3 position;    // m, world
	ob_vec3 normal;      // unit, from b towards a
	double impulse;      // N s, normal, of the last substep
} ob_contact_point;

typedef struct ob_universe ob_universe;

// Attaches read-only to the running universe "name" (as `obsim top` shows it). NULL and e on failure: no such
// universe, or another layout version.
ob_universe *ob_universe_attach(const char *name, ob_error *e);
void ob_universe_detach(ob_universe *u); // NULL is allowed
// Whether the host of an attached universe, or what cleans up after it, is still there; otherwise it stays as it is.
bool ob_universe_is_hosted(const ob_universe *u);

// Names of the universes on this machine, newest first; returns how many there are (may exceed max).
size_t ob_universe_list(char names[][OB_NAME_MAX], size_t max);

// To be called at the beginning of each look at the universe: it also asks the system whether all of the universe's memory
// is still there. If not, the state is OB_UNIVERSE_LOST from now on, and all that follows returns false, or 0. Memory that
// is cut short in the middle of a look, by a program of the same user, ends the reader (SIGBUS).
void ob_universe_get_info(const ob_universe *u, ob_universe_info *out);
// false: no such worker
bool ob_universe_get_worker(const ob_universe *u, uint32_t worker, ob_worker_info *out);
// The worker in which the object's simulator lives: which solved its island last, or to which it was moved; its own, where
// each object has one. false: it has none, as what no force moves, or no worker has solved it yet.
bool ob_universe_get_home(const ob_universe *u, uint32_t id, uint32_t *worker);
// false: no object has this id now
bool ob_universe_get_passport(const ob_universe *u, uint32_t id, ob_passport *out);
// Another number after each change of the passport, so that who has read it knows when to look again; 0: there is none.
uint64_t ob_universe_get_passport_version(const ob_universe *u, uint32_t id);
// The newest published motion; never torn. false: no such object, or its bytes do not make sense.
bool ob_universe_get_motion(const ob_universe *u, uint32_t id, ob_motion *out);
// The fat AABB (m, xmin ymin zmin xmax ymax zmax) that holds the object until it publishes another; a plane's is infinite.
// Each number is whole, but while the universe runs a reader may find some numbers of a new box beside some of the old.
// false: no such object, or its numbers do not make sense.
bool ob_universe_get_bounds(const ob_universe *u, uint32_t id, float bounds[6]);
// Contact points of the last completed step; returns how many there are (may exceed max).
size_t ob_universe_get_contacts(const ob_universe *u, ob_contact_point *out, size_t max);

#pragma GCC visibility pop

#endif
