// Engines whose libraries are loaded when one of them is created.
#include <stdlib.h>

#include "engine/engines.h"
#include "engine/part.h"

#define BULLET "libbullet3.24"
#define MUJOCO "libmujoco2.2.2"

struct ob_engine {
	const ob_engine_part *part;
	ob_engine *inner; // of the part
};

static ob_engine *create(const char *name, const char *package, const ob_world *w, const ob_run_settings *s,
			 ob_error *e)
{
	const ob_engine_part *part = ob_part_load(name, sizeof *part, false, package, e);
	if (!part)
		return NULL;
	ob_engine *p = malloc(sizeof *p);
	if (!p) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	*p = (ob_engine){ part, part->create(w, s, e) };
	if (p->inner)
		return p;
	free(p);
	return NULL;
}

static bool step(ob_engine *p, ob_error *e)
{
	return p->part->step(p->inner, e);
}

static void get(const ob_engine *p, ob_state *state)
{
	p->part->get(p->inner, state);
}

static void destroy(ob_engine *p)
{
	if (p)
		p->part->destroy(p->inner);
	free(p);
}

#ifdef OB_BULLET_VERSION
static ob_engine *create_bullet(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	if (s->step_length > 0 && s->substeps && s->iterations)
		return create("bullet", BULLET, w, s, e);
	ob_fail(e, "%u substeps of a step of %g s with %u iterations: Bullet must be told what to do", s->substeps,
		s->step_length, s->iterations);
	return NULL;
}

static bool check_bullet(ob_error *e)
{
	return ob_part_check("bullet", BULLET, e);
}

const ob_engine_kind ob_engine_bullet = {
	.name = "bullet",
	.title = "Bullet, " OB_BULLET_PRECISION " precision",
	.version = OB_BULLET_VERSION,
	.usual = { .step_length = OB_DEFAULT_STEP, .substeps = 1, .iterations = 10 },
	.iteration_choice = { 5, 10, 20, 50, 100, 200, 500 },
	.check = check_bullet,
	.create = create_bullet,
	.step = step,
	.get = get,
	.destroy = destroy,
	.drives = OB_WORLD_DRIVES_BODIES,
	.hulls = true,
};
#endif

#ifdef OB_MUJOCO_VERSION
static ob_engine *create_mujoco(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create("mujoco", MUJOCO, w, s, e);
}

static bool check_mujoco(ob_error *e)
{
	return ob_part_check("mujoco", MUJOCO, e);
}

const ob_engine_kind ob_engine_mujoco = {
	.name = "mujoco",
	.title = "MuJoCo",
	.version = OB_MUJOCO_VERSION,
	.usual = { .step_length = 1. / 60, .substeps = 8, .iterations = 100 }, // its defaults: about 2 ms, at most 100
	.iteration_choice = { 1, 2, 5, 10, 20, 50, 100 },
	.check = check_mujoco,
	.create = create_mujoco,
	.step = step,
	.get = get,
	.destroy = destroy,
};
#endif
