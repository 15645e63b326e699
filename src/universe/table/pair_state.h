// State of a pair of objects that touch, kept from step to step: the solver's warm start.
#ifndef OB_TABLE_PAIR_STATE_H
#define OB_TABLE_PAIR_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include <ob/vec.h>

enum { OB_PAIR_POINTS = 4, OB_PAIR_ROWS = 7 };

// State of a pair of touching objects, kept from step to step: contact points, and the impulses that warm-start the
// solver. 256 bytes. a < b are ids; the normal points from b to a. Lever arms run from the centres to the contact
// point, world frame, as of the last collision test. All values have full precision: rounding in world axes would make
// a turned or moved scene evolve differently.
typedef struct ob_pair_state {
	ob_vec3 normal;
	ob_vec3 between; // m, from a's centre to b's: an arm of b is that of a less this
	double impulse[OB_PAIR_ROWS]; // N s of the last substep: 4 normal, 2 friction (along the tangents), N m s twist
	double substep; // s, length of that substep
	double disc_radius; // m, as ob_manifold.disc_radius
	ob_vec3 arm_a[OB_PAIR_POINTS]; // m
	double gap[OB_PAIR_POINTS]; // m, separation now; < 0 is penetration
	uint16_t points; // 0 .. 4; 0 = not touching
	uint16_t of_now; // 1: its geometry was found for the bodies' poses when the version holds
	float creep; // m, slip of the last second while friction should have held
} ob_pair_state;

// True if its normal impulses were above 0. p may be NULL: they have never touched.
static inline bool ob_pair_carried_load(const ob_pair_state *p)
{
	double sum = 0;
	for (uint32_t j = 0; p && j < p->points; j++)
		sum += p->impulse[j];
	return sum > 0;
}

#endif
