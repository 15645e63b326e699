// A life that runs: shared by the files of its ways.
#ifndef OB_TESTS_LIVES_RUN_H
#define OB_TESTS_LIVES_RUN_H

#include "host/host_state.h"
#include "way.h"

typedef struct run {
	const life *l;
	way way;
	ob_scene *scene;
	ob_host_config config;
	ob_free_settings free; // of a free run
	ob_host *h;
	struct reader *reader; // NULL: none
	ob_error e;
	bool broken; // a promise was broken; e says which
	uint32_t deaths;
} run;

static inline const ob_universe *universe(const run *r)
{
	return ob_host_universe(r->h);
}

// An object that exists, any of them. false: none does.
bool draw_object(const run *r, uint64_t *seed, ob_passport *p);
// Lets the run go on to a step, and waits there.
bool stand_at(run *r, uint64_t step);

#endif
