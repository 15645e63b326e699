// Where the command line is silent, the scene decides.
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/spelling.h"
#include "cli/request.h"

uint64_t ob_request_steps(double duration, double step)
{
	// 10 s at 1/60 s are 600 steps, though the quotient of the doubles may be a little off
	double n = ceil(duration / step * (1 - 1e-12) - 1e-9);
	return n < 1 ? 1 : n < 1e18 ? (uint64_t)n : (uint64_t)1e18;
}

static bool check_camera(const char *name, const ob_scene *s, ob_error *e)
{
	ob_spelling near = ob_spelling_start(name);
	char all[512] = "";
	for (uint32_t i = 0; i < s->cameras; i++) {
		if (strcmp(s->camera[i].name, name) == 0)
			return true;
		ob_spelling_offer(&near, s->camera[i].name);
		size_t n = strlen(all);
		snprintf(all + n, sizeof all - n, "%s%s", i ? ", " : "", s->camera[i].name);
	}
	if (near.best)
		return ob_fail(e, "--camera %s: the scene has none of this name: did you mean %s?", name, near.best);
	return ob_fail(e, "--camera %s: the scene has none of this name, only: %s", name, all);
}

bool ob_request_settle(ob_run_request *r, const ob_scene *s, ob_error *e)
{
	r->duration = r->duration > 0 ? r->duration : s->duration;
	r->run = s->run;
	if (!ob_run_settings_resolve(&r->run, &r->asked, e))
		return false;
	if (r->run.monolith && r->explain)
		return ob_fail(e, "--explain means nothing to --arch monolith");
	r->run.timed = r->explain || r->measure == OB_MEASURE_PROFILE;
	uint64_t steps = ob_request_steps(r->duration, r->run.step_length);
	// a motion carries its step as 32 bits
	if (steps > UINT32_MAX - 2)
		return ob_fail(e, "%g s in steps of %g s are too many steps (at most %" PRIu32 "): shorten --duration",
			       r->duration, r->run.step_length, UINT32_MAX - 2);
	return !r->frames.camera || check_camera(r->frames.camera, s, e);
}
