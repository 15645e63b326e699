// What a state is worth: energy, momentum, penetration, and the hash of its bits. Knows neither engine nor
// architecture: it looks at snapshots alone, so that every architecture is measured by the same code.
#ifndef OB_MEASURE_MEASURE_H
#define OB_MEASURE_MEASURE_H

#include <ob/motion.h>

// A copy of all motions at one step boundary.
typedef struct ob_snapshot {
	uint64_t step;
	double time;          // s
	uint32_t count;       // ids 0 .. count-1; passport[i].flags says whether i is present
	ob_passport *passport;
	ob_motion *motion;
	size_t contacts;
	ob_contact_point *contact;
	uint32_t count_max;
	size_t contacts_max;
} ob_snapshot;

// Copies the universe (which must stand still for the snapshot to be of one step) into s, growing its memory. s starts zeroed.
bool ob_snapshot_take(ob_snapshot *s, const ob_universe *u, bool with_contacts, ob_error *e);
void ob_snapshot_copy(ob_snapshot *to, const ob_snapshot *from);
void ob_snapshot_finish(ob_snapshot *s);

double ob_measure_energy(const ob_snapshot *s, ob_vec3 gravity);  // J: kinetic + potential, dynamic objects
ob_vec3 ob_measure_momentum(const ob_snapshot *s);                // kg m/s
ob_vec3 ob_measure_angular_momentum(const ob_snapshot *s);        // kg m^2/s about the origin
// 64-bit FNV-1a over (id, p, q, v, w) of all present objects
uint64_t ob_measure_hash(const ob_snapshot *s);

typedef struct ob_penetration {
	double max_m, mean_m; // over touching pairs with positive depth (mean 0 if none)
	size_t pairs;
	uint32_t worst_a, worst_b;
} ob_penetration;
// Depth by the separating axis theorem (box, sphere, plane), exact in closed form; capsules and cylinders by
// ODE-free support sampling are treated as their core segment / polygon: see the source. Sort and sweep over tight boxes.
void ob_measure_penetration(const ob_snapshot *s, ob_penetration *out);

#endif
