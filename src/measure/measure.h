// What a state is worth: energy, momentum, penetration, and the hash of its bits. Knows neither engine nor
// architecture: it looks at snapshots alone, so that every architecture is measured by the same code.
// Thread-safety: one thread at a time per snapshot that is written; any number may measure one that is not.
// Sums run in the order of the ids, so that equal snapshots give equal bits.
#ifndef OB_MEASURE_MEASURE_H
#define OB_MEASURE_MEASURE_H

#include <ob/hull.h>
#include <ob/motion.h>

// A copy of all motions at one step boundary.
typedef struct ob_snapshot {
	uint64_t step;
	double time;          // s
	uint32_t count;       // ids 0 .. count-1; passport[i].flags says whether i is present, all else is 0 if it is not
	ob_passport *passport;
	ob_motion *motion;
	size_t contacts;
	ob_contact_point *contact;
	uint32_t count_max;
	size_t contacts_max;
	uint64_t created;     // of the universe that the hulls are those of
	uint32_t hulls;
	ob_hull **hull;       // [hulls], those that objects have had so far; else NULL
} ob_snapshot;

// Copies the universe (which must stand still for the snapshot to be of one step) into s, growing its memory. s starts
// zeroed. false and e: no memory, or an object's published state does not make sense.
bool ob_snapshot_take(ob_snapshot *s, const ob_universe *u, bool with_contacts, ob_error *e);
// The memory of "to" grows as needed; false (and "to" as it was) when there is none.
bool ob_snapshot_copy(ob_snapshot *to, const ob_snapshot *from);
void ob_snapshot_finish(ob_snapshot *s);
// NULL: it is no hull.
const ob_hull *ob_snapshot_hull(const ob_snapshot *s, uint32_t id);
// State of a present object at the snapshot's time: its motion may be older (asleep, static, in flight).
ob_state ob_snapshot_state(const ob_snapshot *s, uint32_t id);

// J, of dynamic objects: kinetic, potential, and minus the work that their constant forces have done since they were at
// the origin. So a force that drives something adds no energy, and contacts can only take it away.
double ob_measure_energy(const ob_snapshot *s, ob_vec3 gravity);
ob_vec3 ob_measure_momentum(const ob_snapshot *s);                // kg m/s
ob_vec3 ob_measure_angular_momentum(const ob_snapshot *s);        // kg m^2/s about the origin
// 64-bit FNV-1a over (id, p, q, v, w) of all present objects at the snapshot's time
uint64_t ob_measure_hash(const ob_snapshot *s);

typedef struct ob_penetration {
	double max_m, mean_m; // over touching pairs with positive depth (mean 0 if none)
	size_t pairs;
	uint32_t worst_a, worst_b;
} ob_penetration;
// How deep objects are in each other; pairs of two static objects do not count. A tree of tight boxes finds the pairs,
// in time proportional to n log n and to the pairs whose boxes overlap; then the depth of depth.h: closed forms, but for a
// cylinder with a box, capsule or cylinder (1e-7 m, never too small). max_m and mean_m are NaN when there is no memory,
// or more pairs overlap than can be looked at in some seconds.
void ob_measure_penetration(const ob_snapshot *s, ob_penetration *out);
// The same, but false and e, with the object that overlaps most others, where those are NaN; also once stop(context), which
// is asked every few milliseconds, says so. stop: NULL = never.
bool ob_measure_penetration_unless(const ob_snapshot *s, ob_penetration *out, bool (*stop)(void *context), void *context,
				   ob_error *e);

typedef struct ob_separation {
	double max_m, mean_m; // over contacts that carry an impulse; 0 where they touch or penetrate
	size_t pairs;
} ob_separation;
// Separation of contacts that carry an impulse, in a snapshot taken with its contacts: the distance of the true shapes
// along the best of the axes that could part them, never more than it is. max_m and mean_m are NaN when there are more
// contacts than can be looked at in some seconds, or once stop(context) says so, which is asked every few milliseconds.
// stop: NULL = never.
void ob_measure_separation(const ob_snapshot *s, ob_separation *out, bool (*stop)(void *context), void *context);

#endif
