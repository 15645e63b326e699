// Bodies that a step involves, and the union-find forest (table/forest.h) whose trees are their islands. The step finds
// bodies and joins them (step/island_builder.h). Of several ranks, each does so with its own bodies, and trees move
// between ranks before their members are listed (cluster/rank_islands.h).
//
// Thread-safety: the scheduling worker. Several workers may call ob_involve at the same time where each object is a root
// (ob_step_counts.rooted).
#ifndef OB_SCHEDULE_INVOLVED_H
#define OB_SCHEDULE_INVOLVED_H

#include "table/table.h"

// No array that is as long as there are objects, or pairs, is cleared each step. But where many objects move, so that
// several workers find links, each object is made a root before.
typedef struct ob_involved {
	ob_universe *u;
	ob_step_data *data;
	uint32_t ids;
	// [bodies], ascending when all are found; while several workers look for them, ob_object_involve alone counts
	// them
	uint32_t *body;
	uint32_t bodies;
	uint32_t *place; // [id], when islands are merged: index in body[], valid where body[] has the id there
	uint32_t *parent; // [id], for bodies (table/forest.h)
	uint32_t *island_of; // [root]
	bool merges; // islands that were solved apart are merged; else those of a new step are built
	bool alone; // there is but this rank, so all bodies are its own
	uint64_t step; // step for which the islands are built
} ob_involved;

// Returns the view of a new step's bodies, or (merges) of those whose islands are merged, before any is involved.
ob_involved ob_involved_begin(ob_universe *u, bool merges);
// Returns the view when all bodies are involved.
ob_involved ob_involved_all(ob_universe *u);

// Involves a body in a new step. true: it was in no island before. If each object is a root, several workers may call
// it, and another may have joined it to a tree since; else it becomes a root.
static inline bool ob_involve(const ob_involved *p, uint32_t id)
{
	if (!ob_object_involve(p->u, id))
		return false;
	if (!p->data->count->rooted)
		p->parent[id] = id;
	return true;
}

// Involves a body when islands are merged.
void ob_involve_again(ob_involved *p, uint32_t id);
// Involves both, then, and joins their trees.
void ob_involve_joined(ob_involved *p, uint32_t a, uint32_t b);
// Finds the root of each body. Returns the number of roots.
uint32_t ob_involved_roots(const ob_involved *p);

// ---- several ranks: before members are listed

// Adds a body of this rank's, due or not, before linked bodies are found.
void ob_involve_due(ob_universe *u, uint32_t id);
// Lists the bodies, in no order; returns their number. root: [object], for these, the body that names its island. Both
// hold until islands are dropped or joined.
uint32_t ob_involved_bodies(ob_universe *u, const uint32_t **body, const uint32_t **root);
// Drops the islands that another rank solves. leaves: [object], not 0 = the island of this root
void ob_involved_drop(ob_universe *u, const uint8_t *leaves);
// Joins the islands of two bodies of this rank's; a == b: adds the body.
void ob_involved_join(ob_universe *u, uint32_t a, uint32_t b);

#endif
