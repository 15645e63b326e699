#include "solver/equilibrium.h"

#include "solver/relative_speed.h"

static const double steady_speed = 1e-3; // m/s: relative speed of any point of a steady body and the bodies it touches
static const double residual_threshold = 1e-7; // m/s: largest change of velocity by the first iteration in equilibrium
static const double min_rest_time = .1; // s; shorter in a coarse run

bool ob_equilibrium_likely(const ob_solver *s, const ob_island_input *in)
{
	const ob_run_settings *run = s->settings;
	if (!in->pairs || run->substeps == 1 || s->island.substeps > run->substeps ||
	    run->solver != OB_SOLVER_COLOURED || !s->methods.exact)
		return false;
	for (uint32_t i = 0; i < in->members; i++)
		if (!(in->object[i].motion->flags & OB_MOTION_STEADY))
			return false;
	return true;
}

bool ob_equilibrium_confirmed(const ob_island_work *w)
{
	return w->residual <= residual_threshold * w->unit.speed && !w->projected;
}

bool ob_equilibrium_expected(const ob_island_work *w)
{
	const bool alone = w->bodies == 1 && w->surfaces.count == 0;
	return (alone ? w->last_residual : w->residual) <= residual_threshold * w->unit.speed && !w->projected;
}

// True if forces on a body that joints hold balance: contacts show by their residual that nothing changes, joints do not, and
// a pendulum stands for an instant where it turns back.
static bool is_balanced(const ob_solver *s, uint32_t row)
{
	const ob_island_work *w = &s->island;
	const ob_body *body = &w->body[row];
	const ob_motion *m = s->in->object[row - 1].motion;
	const ob_vec3 v = ob_sub(ob_row_linear(w->v[row]), m->v), turn = ob_sub(ob_row_angular(w->v[row]), m->w);
	return body->joints == 0 ||
	       ob_norm(v) + body->radius * ob_norm(turn) <= ob_balanced_change(w, s->settings->step_length);
}

bool ob_equilibrium_reached(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	if (!ob_equilibrium_confirmed(w))
		return false;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_body *body = &w->body[i];
		if (body->contacts + body->joints == 0 || body->speed > residual_threshold * w->unit.speed ||
		    body->rest_time < min_rest_time * ob_coarse_time(w) || !is_balanced(s, i))
			return false;
	}
	return true;
}

bool ob_equilibrium_body_steady(const ob_island_work *w, uint32_t row)
{
	const ob_body *body = &w->body[row];
	// Relative to the touching bodies: a structure may travel as a whole. Joints are not solved in such a frame.
	double speed = body->joints ? body->speed : 0;
	for (uint32_t k = 0; k < body->adjacent; k++) {
		const ob_contact *contact = &w->contact[w->adjacency[body->first_adjacent + k]];
		if (contact->lane != OB_NO_LANE)
			speed = ob_max(speed, ob_contact_speed(w, contact));
	}
	return body->contacts + body->joints > 0 && speed <= steady_speed * w->unit.speed;
}
