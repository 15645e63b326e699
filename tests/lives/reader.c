#include "reader.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

#include "measure/measure.h"

enum { PAUSE_NS = 300000 };

struct reader {
	ob_universe *u;
	pthread_t thread;
	atomic_bool ends;
	ob_snapshot now;
	ob_error e; // found in its readings; "": none
};

static bool is_finite(const ob_state *s)
{
	return isfinite(s->pose.p.x + s->pose.p.y + s->pose.p.z + s->v.x + s->v.y + s->v.z + s->w.x + s->w.y + s->w.z);
}

static bool is_ended(void *context)
{
	return ((reader *)context)->ends;
}

// Motions at a time of the reader's own, ahead of the universe.
static bool read_motions(reader *r, double ahead)
{
	for (uint32_t id = 0; id < r->now.count; id++) {
		const ob_passport *p = &r->now.passport[id];
		if (!(p->flags & OB_OBJECT_PRESENT))
			continue;
		const ob_state s = ob_motion_at(&r->now.motion[id], p->inertia, r->now.time + ahead);
		if (!is_finite(&s))
			return ob_fail(&r->e, "a reader found object %u nowhere", id);
	}
	return true;
}

static void read_rest(const reader *r)
{
	enum { MOST = 64 };
	uint32_t ids[MOST], worker;
	double value, rate, own;
	ob_joint_load load;
	ob_worker_info info;
	for (uint32_t id = 0; id < r->now.count; id++) {
		ob_universe_get_inside(r->u, id, ids, MOST);
		ob_universe_get_home(r->u, id, &worker);
		ob_universe_get_own_time(r->u, id, &own);
	}
	for (uint32_t i = 0; i < ob_universe_joints(r->u); i++) {
		ob_universe_get_joint_value(r->u, i, &value, &rate);
		ob_universe_get_joint_load(r->u, i, &load);
	}
	for (uint32_t i = 0; ob_universe_get_worker(r->u, i, &info); i++)
		;
}

static void *read_on(void *context)
{
	reader *r = context;
	ob_penetration depth;
	ob_separation apart;
	for (uint64_t round = 0; !r->ends; round++) {
		ob_universe_info info;
		ob_universe_get_info(r->u, &info);
		if (!ob_snapshot_take(&r->now, r->u, OB_SNAPSHOT_CONTACTS | OB_SNAPSHOT_BOUNDS, &r->e) ||
		    !read_motions(r, (double)(round % 7) / 100))
			break;
		read_rest(r);
		if (round % 8 == 0) { // dear: depths, of the ground of triangles, too
			ob_measure_penetration_unless(&r->now, &depth, is_ended, r, &(ob_error){ "" });
			ob_measure_separation(&r->now, &apart, is_ended, r);
		}
		nanosleep(&(struct timespec){ .tv_nsec = PAUSE_NS }, NULL);
	}
	return NULL;
}

reader *reader_start(const char *universe)
{
	ob_error e;
	reader *r = calloc(1, sizeof *r);
	if (!r)
		return NULL;
	r->u = ob_universe_attach(universe, &e);
	if (r->u && pthread_create(&r->thread, NULL, read_on, r) == 0)
		return r;
	ob_universe_detach(r->u);
	free(r);
	return NULL;
}

bool reader_stop(reader *r, ob_error *e)
{
	if (!r)
		return true;
	r->ends = true;
	pthread_join(r->thread, NULL);
	const bool fine = !*r->e.text || ob_fail(e, "%s", r->e.text);
	ob_snapshot_finish(&r->now);
	ob_universe_detach(r->u);
	free(r);
	return fine;
}
