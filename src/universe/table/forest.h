// A union-find forest over indices, which several workers grow at the same time. Its roots are the lowest indices of their
// trees, so it ends the same in whatever order trees are joined.
//
//   parent   0  1  1  0  4        a parent is below its child: so each walk to a root ends, even after
//            ^  ^__|  |  ^        stray writes
//            |________|  |
//
// A root is given a parent by a compare-and-swap; one of several workers succeeds, and the others begin again from the
// present roots. An index that is no longer a root only gets parents further up in its own tree, so a plain store is
// enough: an older one that comes late is an ancestor, too. The gate orders all of it with later readers of the forest,
// so relaxed is enough.
#ifndef OB_TABLE_FOREST_H
#define OB_TABLE_FOREST_H

#include <stdint.h>

static inline uint32_t ob_forest_root(uint32_t *parent, uint32_t i)
{
	for (;;) {
		const uint32_t above = __atomic_load_n(&parent[i], __ATOMIC_RELAXED);
		if (above >= i)
			return i;
		const uint32_t beyond = __atomic_load_n(&parent[above], __ATOMIC_RELAXED);
		if (beyond >= above)
			return above;
		__atomic_store_n(&parent[i], beyond, __ATOMIC_RELAXED);
		i = beyond;
	}
}

static inline void ob_forest_join(uint32_t *parent, uint32_t i, uint32_t j)
{
	for (;;) {
		const uint32_t a = ob_forest_root(parent, i), b = ob_forest_root(parent, j);
		const uint32_t low = a < b ? a : b, high = a < b ? b : a;
		uint32_t seen = high;
		if (low == high ||
		    __atomic_compare_exchange_n(&parent[high], &seen, low, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
			return;
		if (seen > high) // damage: no walk would ever lead on from there
			return;
	}
}

#endif
