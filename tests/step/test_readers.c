// A reader that looks at an object while it is placed anew, again and again, always finds it, with a motion.
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "measure/measure.h"
#include "step/sim.h"

enum { PLACEMENTS = 20000, READINGS_A_SNAPSHOT = 200 };

typedef struct reading {
	const ob_universe *u;
	atomic_bool ends;
	unsigned readings, missing, failed;
} reading;

static void *read_on(void *context)
{
	reading *r = context;
	ob_snapshot s = { 0 };
	ob_passport p;
	ob_motion m;
	while (!r->ends) {
		r->missing += !ob_universe_get_passport(r->u, 0, &p) || !ob_universe_get_motion(r->u, 0, &m);
		if (r->readings++ % READINGS_A_SNAPSHOT)
			continue;
		ob_error e = { "" };
		r->failed += !ob_snapshot_take(&s, r->u, 0, &e) || !(s.passport[0].flags & OB_OBJECT_PRESENT);
	}
	ob_snapshot_finish(&s);
	return NULL;
}

int main(void)
{
	little_scene *s = little_scene_new();
	ob_world_sphere(&s->world, 500, .5, ob_v3(0, 0, 9));
	little_universe l;
	little_open(&l, s);
	reading r = { .u = l.u };
	pthread_t reader;
	CHECK(pthread_create(&reader, NULL, read_on, &r) == 0);
	for (unsigned i = 0; i < PLACEMENTS; i++)
		ob_sim_place_anew(
			l.u, 0,
			&(ob_state){ { ob_v3(i % 7, 0, 9), ob_quat_identity() }, ob_v3(0, 0, 0), ob_v3(0, 0, 0) });
	r.ends = true;
	pthread_join(reader, NULL);
	printf("%u readings\n", r.readings);
	CHECK(r.missing == 0);
	CHECK(r.failed == 0);
	little_close(&l);
	free(s);
	return check_end();
}
