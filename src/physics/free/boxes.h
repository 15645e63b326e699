// A worker's copy of all published fat AABBs, in a hierarchical hash grid of its own (as step/broadphase.h has one for all), and
// of the counters by which it learns of changes. A worker of few simulators has the counters alone, and tests all boxes.
#ifndef OB_FREE_BOXES_H
#define OB_FREE_BOXES_H

#include "table/free.h"

typedef struct ob_free_boxes {
	uint32_t ids; // capacity
	uint32_t *looked; // [groups] counters of changes at the last look
	float (*box)[6]; // [ids] as of then; NULL: there is no grid
	int32_t (*place)[4]; // [ids] level and cell; level 0: it is not in the grid
	uint32_t *next, *head; // [ids], [buckets] links: 1 + id; 0 = end
	uint32_t in_level[64]; // objects in each level
	uint32_t *found; // [ids] result of a query
} ob_free_boxes;

// grid: there is to be one. false: no memory.
bool ob_free_boxes_begin(ob_free_boxes *b, const ob_universe *u, bool grid);
void ob_free_boxes_finish(ob_free_boxes *b);
// True if no box has changed since the last look.
bool ob_free_boxes_are_current(const ob_free_boxes *b, const ob_universe *u);
// Takes over the changes of a group of OB_FREE_GROUP objects, and returns how many: id[OB_FREE_GROUP] have changed.
uint32_t ob_free_boxes_look(ob_free_boxes *b, const ob_universe *u, uint32_t group, uint32_t *id);
// Returns the number of objects whose boxes overlap this one, in b->found, in no order. With a grid.
uint32_t ob_free_boxes_query(ob_free_boxes *b, const float box[6]);

#endif
