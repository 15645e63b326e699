#include "engine/bullet.h"

#include "engine/engines.h"

#ifdef BT_USE_DOUBLE_PRECISION // set by its own pkg-config file
static const char title[] = "Bullet, double precision";
#else
static const char title[] = "Bullet, single precision";
#endif

static ob_engine *create(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	if (s->step_length > 0 && s->substeps && s->iterations)
		return ob_bullet_create(w, s, e);
	ob_fail(e, "%u substeps of a step of %g s with %u iterations: Bullet must be told what to do", s->substeps,
		s->step_length, s->iterations);
	return NULL;
}

const ob_engine_kind ob_engine_bullet = {
	.name = "bullet",
	.title = title,
	.version = OB_BULLET_VERSION,
	.usual = { .step_length = OB_DEFAULT_STEP, .substeps = 1, .iterations = 10 },
	.iteration_choice = { 5, 10, 20, 50, 100, 200, 500 },
	.create = create,
	.step = ob_bullet_step,
	.get = ob_bullet_get,
	.destroy = ob_bullet_destroy,
	.drives = OB_WORLD_DRIVES_BODIES,
	.hulls = true,
};
