// Strip on frames (--overlay simulators): a row for each worker, and the own times of a free run. The page has the same
// (src/front/serve/page/workers.js). One thread.
#ifndef OB_CLI_STRIP_H
#define OB_CLI_STRIP_H

#include "measure/colouring.h"

typedef struct ob_worker_strip ob_worker_strip;

ob_worker_strip *ob_worker_strip_create(const ob_universe *u, ob_error *e); // the universe must outlive it
// Paints workers as they are, and own times as the snapshot has them.
bool ob_worker_strip_paint(ob_worker_strip *s, const ob_snapshot *now, uint8_t *rgba, int width, int height,
			   ob_error *e);
void ob_worker_strip_destroy(ob_worker_strip *s); // NULL is allowed

#endif
