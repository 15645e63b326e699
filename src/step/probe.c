#include "step/probe.h"

#include <stdlib.h>

#include "base/allocate.h"
#include "step/flight.h"

struct ob_probe {
	ob_run_settings settings; // of the run, with other substeps
	ob_solver solver;
	ob_sim *sim;
	uint64_t work, most; // in the running island
	uint32_t next, ends_max;
	ob_state *end; // [member]: at the step's end
};

static bool spend(void *probe, uint64_t work)
{
	ob_probe *p = probe;
	p->work += work;
	return p->work > p->most;
}

static void enter_nothing(void *probe, ob_profile_section section) {}
static void attempt_nothing(void *probe) {}
static void touch_nothing(void *probe, uint32_t a, uint32_t b, double impulse, ob_vec3 point) {}
static void fail_nothing(void *probe, uint32_t object) {}
static void find_nothing(void *probe, const ob_found_contact *c) {}

static void note_motion(void *probe, const ob_island_object *object, ob_motion *m, bool free)
{
	ob_probe *p = probe;
	p->end[p->next++] = ob_motion_end(p->sim, object->id, m, free);
}

bool ob_probe_create(ob_probe **to, ob_sim *s, uint32_t substeps)
{
	enum { ODE_BODIES = 256 };
	const ob_island_calls calls = { .spend = spend,
					.enter = enter_nothing,
					.attempt = attempt_nothing,
					.touch = touch_nothing,
					.fail = fail_nothing,
					.contact = find_nothing,
					.motion = note_motion };
	ob_probe *p = *to = calloc(1, sizeof *p);
	if (!p)
		return false;
	p->sim = s;
	p->settings = *s->settings;
	p->settings.substeps = substeps;
	if (!ob_solver_create(&p->solver, &p->settings, &calls, ODE_BODIES))
		return false;
	p->solver.calls.with = p;
	return true;
}

void ob_probe_destroy(ob_probe *p)
{
	if (!p)
		return;
	ob_solver_finish(&p->solver);
	free(p->end);
	free(p);
}

bool ob_probe_solve(ob_probe *p, ob_sim *s, const ob_island_input *in, uint32_t substeps, uint64_t most)
{
	if (in->members > p->ends_max) {
		p->ends_max = in->members + in->members / 2;
		p->end = ob_reallocate(p->end, p->ends_max * sizeof *p->end);
	}
	p->work = p->next = 0;
	p->most = most;
	p->solver.budget.noted = p->solver.budget.told = p->solver.counters.pair_solves = 0;
	p->solver.budget.spent = false;
	ob_island_probe(&p->solver, in, substeps);
	return !p->solver.budget.spent;
}

// Largest distance by which a turn from a to b moves a point at this radius.
static double turned_by(ob_quat a, ob_quat b, double radius)
{
	const double c[2][4] = { { a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z },
				 { a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z } };
	double square[2] = { 0, 0 };
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < 4; i++)
			square[k] += c[k][i] * c[k][i];
	return 2 * radius * sqrt(ob_min(square[0], square[1]));
}

double ob_probe_distance(const ob_probe *p, uint32_t i, const ob_passport *passport, const ob_state *end, double *speed)
{
	const double radius = ob_shape_radius(passport->shape, passport->size);
	const ob_state *other = &p->end[i];
	*speed = ob_norm(ob_sub(end->v, other->v)) + radius * ob_norm(ob_sub(end->w, other->w));
	return ob_norm(ob_sub(end->pose.p, other->pose.p)) + turned_by(end->pose.q, other->pose.q, radius);
}
