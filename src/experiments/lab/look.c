#include "lab/look.h"

#include "shape/shape.h"

ob_state ob_look_at(const ob_case_run_state *t, uint32_t id)
{
	const ob_motion *m = &t->now.motion[id];
	return (ob_state){ { m->p, m->q }, m->v, m->w };
}

ob_vec3 ob_look_moved(const ob_case_run_state *t, uint32_t id)
{
	return ob_sub(t->now.motion[id].p, t->world->state[id].pose.p);
}

bool ob_look_moves(const ob_case_run_state *t, uint32_t id)
{
	return !(t->world->passport[id].flags & OB_OBJECT_PRESCRIBED);
}

double ob_look_energy(const ob_case_run_state *t)
{
	return ob_measure_energy(&t->now, t->world->gravity);
}

double ob_look_farthest(const ob_case_run_state *t)
{
	double most = 0;
	for (uint32_t id = 0; id < t->world->objects; id++)
		if (ob_look_moves(t, id))
			most = fmax(most, ob_norm(ob_look_moved(t, id)));
	return most;
}

ob_penetration ob_look_penetration(const ob_case_run_state *t, double *worst)
{
	ob_penetration p;
	ob_measure_penetration(&t->now, &p);
	ob_look_keep(worst, 1e3 * p.max_m);
	return p;
}

bool ob_look_fail_below(ob_case_run_state *t)
{
	double ground = INFINITY, lowest = INFINITY;
	for (uint32_t id = 0; id < t->world->objects; id++) {
		if (ob_shape_is(t->world->passport[id].shape, OB_UNBOUNDED))
			ground = t->world->state[id].pose.p.z;
		else if (ob_look_moves(t, id))
			lowest = fmin(lowest, t->now.motion[id].p.z);
	}
	const bool fell = isfinite(ground) && lowest < ground - 1;
	if (fell)
		t->failed = "fell through the ground";
	return fell;
}

void ob_look_fail_still(ob_case_run_state *t)
{
	if (ob_look_farthest(t) == 0)
		t->failed = "nothing moved";
}

double ob_look_parted(const ob_case_run_state *t)
{
	return ob_measure_gap(&t->now);
}

double ob_look_gravity(const ob_case_run_state *t)
{
	return ob_norm(t->world->gravity);
}

void ob_look_keep(double *figure, double value)
{
	if (!(value <= *figure) && !isnan(*figure))
		*figure = value;
}

void ob_look_keep_all(double *figure, const double *value)
{
	for (int i = 0; i < OB_FIGURES; i++)
		ob_look_keep(&figure[i], value[i]);
}
