// Measures of a state: energy, momentum, penetration, and the hash of its bits. Independent of engine and architecture:
// all input comes from snapshots, so that every architecture is measured by the same code. Thread-safety: one thread at
// a time per snapshot that is written; any number may measure one that is not. Sums run in the order of the ids, so
// that equal snapshots give equal bits.
#ifndef OB_MEASURE_MEASURE_H
#define OB_MEASURE_MEASURE_H

#include <ob/hull.h>
#include <ob/joint.h>
#include <ob/motion.h>

#include "terrain/terrain.h"

// Copy of all motions at one step boundary.
typedef struct ob_snapshot {
	uint64_t step;
	double time; // s
	// ids 0 .. count-1; passport[i].flags marks present objects, all else is 0 for absent ones
	uint32_t count;
	ob_passport *passport;
	ob_motion *motion;
	ob_state *state; // at the snapshot's time; NULL: found when it is asked for, as of a record
	uint32_t *home; // home worker of each simulator, UINT32_MAX: none; NULL: unknown, as of a record
	double *own_time; // s, of each simulator in a free run; NaN: none; NULL: unknown
	float (*bounds)[6]; // of each object, as ob_universe_get_bounds; NaN: none; undefined unless they were taken
	size_t contacts;
	ob_contact_point *contact;
	uint32_t joints;
	ob_joint_passport *joint; // [joints], by number; 0 where there is none (ob_snapshot_has_joint); OB_JOINT_BROKEN
	uint32_t joints_max;
	uint32_t count_max;
	size_t contacts_max;
	uint64_t created; // instant of creation of the hulls' universe
	uint32_t hulls;
	ob_hull **hull; // [hulls], those used by objects so far; others NULL
	ob_terrain_set *terrains; // NULL: there are none, or they are unknown, as of a record
} ob_snapshot;

enum { OB_SNAPSHOT_CONTACTS = 1 << 0, OB_SNAPSHOT_BOUNDS = 1 << 1 };
// Copies the universe into s, growing its memory. s starts zeroed. with: contents that few callers need, OB_SNAPSHOT_*.
// The snapshot is of one step only if the universe stands still. Returns false and e if memory runs out, or if an
// object's published state is implausible.
bool ob_snapshot_take(ob_snapshot *s, const ob_universe *u, unsigned with, ob_error *e);
// Copies a snapshot; the memory of "to" grows as needed. Returns false, with "to" unchanged, if memory runs out.
bool ob_snapshot_copy(ob_snapshot *to, const ob_snapshot *from);
void ob_snapshot_finish(ob_snapshot *s);
// NULL: not a hull.
const ob_hull *ob_snapshot_hull(const ob_snapshot *s, uint32_t id);
// Number of a compound's parts, and one of them, from 1; part 0: as ob_snapshot_hull. 0: not a compound.
uint32_t ob_snapshot_parts(const ob_snapshot *s, uint32_t id);
const ob_hull *ob_snapshot_part(const ob_snapshot *s, uint32_t id, uint32_t part);
// True if there is a joint of this number; it may have broken.
static inline bool ob_snapshot_has_joint(const ob_snapshot *s, uint32_t joint)
{
	return joint < s->joints && ob_joint_exists(&s->joint[joint]);
}
// State of a present object at the snapshot's time: its motion may be older (asleep, static, in flight).
ob_state ob_snapshot_state(const ob_snapshot *s, uint32_t id);

// Energy (J) of dynamic objects: kinetic, potential, and minus the work that their constant forces have done since they
// were at the origin. So a driving force adds no energy, and contacts can only reduce it.
double ob_measure_energy(const ob_snapshot *s, ob_vec3 gravity);
ob_vec3 ob_measure_momentum(const ob_snapshot *s); // kg m/s
ob_vec3 ob_measure_angular_momentum(const ob_snapshot *s); // kg m^2/s about the origin
// 64-bit FNV-1a over (id, p, q, v, w) of all present objects at the snapshot's time.
uint64_t ob_measure_hash(const ob_snapshot *s);

typedef struct ob_penetration {
	double max_m, mean_m; // over touching pairs with positive depth (mean 0 if none)
	size_t pairs;
	uint32_t worst_a, worst_b;
} ob_penetration;
// Penetration of objects, without pairs of two static ones, or of two that a joint or their
// groups let overlap, or with a sensor. A tree of tight boxes finds the pairs, in time proportional to n log n and to
// the pairs with overlapping boxes. Then the depth of depth.h: closed forms, except for a cylinder
// with a box, capsule or cylinder (1e-7 m, never too small). max_m and mean_m are NaN if memory runs out, or if more
// pairs overlap than some seconds allow.
void ob_measure_penetration(const ob_snapshot *s, ob_penetration *out);
// Same, but returns false and e, with the object that overlaps most others, if those are NaN. Also stops when
// stop(context), called every few milliseconds, returns true. stop: NULL = never.
bool ob_measure_penetration_unless(const ob_snapshot *s, ob_penetration *out, bool (*stop)(void *context),
				   void *context, ob_error *e);
// Same, and raises each[id] to the object's depth in its deepest pair (m), where that is more.
bool ob_measure_depths(const ob_snapshot *s, double *each, ob_penetration *out, bool (*stop)(void *context),
		       void *context, ob_error *e);

// Largest distance (m) of the two places of a joint that must be one: of all but sliders and distances.
double ob_measure_gap(const ob_snapshot *s);

typedef struct ob_separation {
	double max_m, mean_m; // over contacts with an impulse; 0 if they touch or penetrate
	size_t pairs;
} ob_separation;
// Separation of contacts that carry an impulse, in a snapshot taken with its contacts: the distance of the true shapes
// along the best of the candidate separating axes, a lower bound. max_m and mean_m are NaN if there are more contacts
// than some seconds allow, or once stop(context), called every few milliseconds, returns true. stop: NULL = never.
void ob_measure_separation(const ob_snapshot *s, ob_separation *out, bool (*stop)(void *context), void *context);

#endif
