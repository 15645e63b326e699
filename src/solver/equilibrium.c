#include "solver/equilibrium.h"

#include "solver/relative_speed.h"

static const double steady_speed = 1e-3; // m/s: relative speed of any point of a steady body and the bodies it touches
static const double residual_threshold = 1e-7; // m/s: largest change of velocity by the first iteration in equilibrium
static const double min_rest_time = .1; // s; shorter in a coarse run

bool ob_equilibrium_likely(const ob_solver *s, const ob_island_input *in)
{
	const ob_run_settings *run = s->settings;
	if (in->joints || run->substeps == 1 || s->island.substeps > run->substeps ||
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

bool ob_equilibrium_reached(const ob_island_work *w)
{
	if (!ob_equilibrium_confirmed(w))
		return false;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_body *body = &w->body[i];
		if (body->contacts == 0 || body->speed > residual_threshold * w->unit.speed ||
		    body->rest_time < min_rest_time * ob_coarse_time(w))
			return false;
	}
	return true;
}

bool ob_equilibrium_body_steady(const ob_island_work *w, uint32_t row)
{
	const ob_body *body = &w->body[row];
	double speed = 0; // relative to the touching bodies: a structure may travel as a whole
	for (uint32_t k = 0; k < body->adjacent; k++) {
		const ob_contact *contact = &w->contact[w->adjacency[body->first_adjacent + k]];
		if (contact->lane != OB_NO_LANE)
			speed = ob_max(speed, ob_contact_speed(w, contact));
	}
	return body->contacts > 0 && speed <= steady_speed * w->unit.speed;
}
