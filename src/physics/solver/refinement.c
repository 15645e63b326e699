#include "solver/refinement.h"

#include "solver/joints.h"
#include "solver/probe.h"

bool ob_refinement_is_doubted(const ob_solver *s)
{
	return s->island.bodies == 1 && s->in->object[0].motion->flags & OB_MOTION_DOUBTED;
}

// Error (m) of a second of the coarse one of two solutions, at most: their distance is half of it at first order.
static double error_of(const ob_solver *s, ob_probe *coarse, ob_probe *fine)
{
	double speed;
	ob_probe_compare(coarse, ob_probe_island(fine));
	const double error = ob_probe_distance(coarse, ob_probe_island(fine), 1, &speed);
	return 2 * ob_error_of_run(s, error, speed);
}

// Returns the number of substeps, more than now, from which on the errors of a second fall faster than with their power of
// 1.5; 0: none. error: m, of a second, now.
static uint32_t find_substeps(ob_solver *s, double error)
{
	enum { LEAST = 4, MOST = 8 }; // by the run's substeps
	ob_probe *coarse = s->estimate.probe, *fine = s->estimate.finer;
	const uint32_t now = s->island.substeps, usual = s->settings->substeps, most = MOST * usual;
	const uint32_t first = 2 * now > LEAST * usual ? 2 * now : LEAST * usual;
	if (2 * most > OB_MAX_SUBSTEPS || first > most)
		return 0;
	ob_probe_solve(coarse, s, first, first);
	for (uint32_t n = first; n <= most; n *= 2) {
		ob_probe_solve(fine, s, 2 * n, 2 * n);
		const double ratio = (double)n / s->island.partial;
		if (error_of(s, coarse, fine) * ratio * sqrt(ratio) <= error)
			return n;
		ob_probe *next = fine;
		fine = coarse, coarse = next;
	}
	return 0;
}

// Lets an island that only joints hold have twice as many flights while its second would exceed the tolerance.
static void refine_flights(ob_solver *s, bool estimated, double error)
{
	enum { OFTEN = 256 }; // half as many flights have 64 times the error at most, and keep the tolerance
	ob_island_work *w = &s->island;
	const double tolerance = s->settings->tolerance;
	uint32_t n = ob_is_refined(&s->in->object[0]) ? s->in->object[0].motion->substeps : 0;
	if (estimated && !n && error > tolerance)
		n = ob_joints_finer(s, w->substeps);
	else if (estimated && OFTEN * error <= tolerance)
		n = 0;
	for (uint32_t row = 1; n && row <= w->bodies; row++) {
		w->body[row].next_substeps = n;
		w->body[row].refinement = OB_MOTION_REFINED;
	}
}

void ob_refinement_update(ob_solver *s, bool estimated, double error)
{
	ob_body *body = &s->island.body[1];
	const ob_motion *last = s->in->object[0].motion;
	const bool refined = ob_is_refined(&s->in->object[0]), exceeds = estimated && error > s->settings->tolerance;
	uint32_t n = refined ? last->substeps : 0, stage = last->flags & OB_MOTION_REFINEMENT;
	if (ob_flies_with_joints(s->in))
		refine_flights(s, estimated, error);
	if (s->island.bodies > 1 || s->island.joints.count || ob_contacts_changed(&s->island))
		return;
	if (exceeds && (stage & OB_MOTION_DOUBTED || refined)) {
		const uint32_t found = find_substeps(s, error);
		n = found ? found : n;
		stage = n ? OB_MOTION_REFINED : OB_MOTION_UNREFINED;
	} else if (exceeds && !stage) {
		stage = OB_MOTION_DOUBTED;
	}
	body->next_substeps = n > body->next_substeps ? n : body->next_substeps;
	body->refinement = stage;
}
