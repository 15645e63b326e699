#include "fake_engine.h"

#include <stdlib.h>

struct ob_engine {
	const ob_world *world; // lives as long as the engine in every trial
	exact_motion motion;
	double step;
	int frame, last; // faulty from frame "last" on
};

static exact_motion in_use;

void exact_engine_use(exact_motion motion)
{
	in_use = motion;
}

static ob_state bursting(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	if (!(w->passport[id].flags & OB_OBJECT_STATIC))
		s.v.x += exp(1e3 * t);
	return s;
}

static ob_engine *create(const ob_world *w, const ob_run_settings *s, exact_motion motion, int last)
{
	ob_engine *p = malloc(sizeof *p);
	if (p)
		*p = (ob_engine){ w, motion, s->step_length, 0, last };
	return p;
}

static bool step(ob_engine *p, ob_error *e)
{
	p->frame++;
	return true;
}

static void get(const ob_engine *p, ob_state *state)
{
	for (uint32_t i = 0; i < p->world->objects; i++)
		state[i] = p->motion(p->world, i, p->frame * p->step);
}

static void destroy(ob_engine *p)
{
	free(p);
}

static bool step_until_last(ob_engine *p, ob_error *e)
{
	return ++p->frame < p->last || ob_fail(e, "the engine gave up");
}

static void get_until_last(const ob_engine *p, ob_state *state)
{
	get(p, state);
	if (p->frame >= p->last)
		state[p->world->objects - 1].v.x = NAN;
}

#define CREATE(name, motion, last) \
	static ob_engine *create_##name(const ob_world *w, const ob_run_settings *s, ob_error *e) \
	{ \
		return create(w, s, motion, last); \
	}
CREATE(exact, in_use, 0)
CREATE(frozen, exact_rest, 0)
CREATE(blind, exact_flight, 0)
CREATE(drunk, in_use, 3)
CREATE(bursting, bursting, 0)
CREATE(dying, in_use, 3)

static bool takes_joints(const ob_world *w, ob_error *e)
{
	return true;
}

#define ENGINE(kind, step_function, get_function) \
	const ob_engine_kind kind##_engine = { .name = #kind, \
					       .title = #kind, \
					       .version = "", \
					       .drives = OB_WORLD_DRIVES_SURFACES, \
					       .hulls = true, \
					       .takes_joints = takes_joints, \
					       .create = create_##kind, \
					       .step = step_function, \
					       .get = get_function, \
					       .destroy = destroy }
ENGINE(exact, step, get);
ENGINE(frozen, step, get);
ENGINE(blind, step, get);
ENGINE(bursting, step, get);
ENGINE(drunk, step, get_until_last);
ENGINE(dying, step_until_last, get);
