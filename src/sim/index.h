// The spatial index of the universe: a hierarchical hash grid (Ericson 2005, ch. 7.2) in the exchange area.
//
// Each object lies in the one cell of its size class that holds the centre of its bounds; a cell's side is the
// smallest power of two that is not below the bounds' longest side. Whoever asks for the neighbours of a box looks
// through the cells around it at every class in use. One writer (the arranger), then any number of readers.
#ifndef OB_SIM_INDEX_H
#define OB_SIM_INDEX_H

#include "table/table.h"

// Puts the object where its bounds are now (new or moved). Planes go to the list of planes.
void ob_index_put(ob_universe *u, uint32_t id);
void ob_index_remove(ob_universe *u, uint32_t id);
// All other objects whose bounds overlap those of id, in no particular order. Writes up to max ids, returns how many
// there are. tests grows by the boxes that were compared.
uint32_t ob_index_query(const ob_universe *u, uint32_t id, uint32_t *out, uint32_t max, uint64_t *tests);

#endif
