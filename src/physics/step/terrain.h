// Pairs with a terrain: one for each of its regions whose triangles are near the other object.
#ifndef OB_STEP_TERRAIN_H
#define OB_STEP_TERRAIN_H

#include "table/table.h"

// A region of a terrain as a pair sees it. As far as the other object's fat AABB reaches it may be all there is: then it is
// a plane to its solver, with a plane's bits.
typedef struct ob_terrain_view {
	const ob_terrain *terrain;
	uint32_t region; // from 0
	bool flat;
	ob_pose plane; // if it is: of that plane
} ob_terrain_view;

// Finds the view of a pair with a region. false: there is no such region, and the step has failed.
bool ob_terrain_see(const ob_universe *u, const ob_pair_key *k, ob_terrain_view *out);

// Finds the regions near an object's fat AABB, ascending. Writes up to max; returns their number.
uint32_t ob_terrain_near(const ob_universe *u, uint32_t terrain, uint32_t other, uint32_t *out, uint32_t max);

// Box of a pair's region in the world; returns false if it has none.
bool ob_terrain_region_bounds(const ob_universe *u, const ob_pair_key *k, double bounds[6]);

// The one of a pair that is the terrain, and the other.
static inline bool ob_terrain_is_first(const ob_universe *u, const ob_pair_key *k)
{
	return ob_terrain_of(u, ob_passport_of(u, k->a)) != NULL;
}

#endif
