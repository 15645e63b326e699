// Air where there should be none: between objects that hold each other although their shapes do not meet.
#include "measure/depth.h"
#include "measure/measure.h"

static ob_solid solid_of(const ob_snapshot *s, uint32_t id)
{
	const ob_passport *p = &s->passport[id];
	ob_state state = ob_snapshot_state(s, id);
	return (ob_solid){ p->shape, p->size, state.pose.p, ob_quat_matrix(state.pose.q) };
}

// The points of a pair stand together. Sums up what they bear, and sets *i behind them.
static double pressed(const ob_snapshot *s, size_t *i)
{
	const ob_contact_point *first = &s->contact[*i];
	double impulse = 0;
	for (; *i < s->contacts && s->contact[*i].a == first->a && s->contact[*i].b == first->b; (*i)++)
		impulse += s->contact[*i].impulse;
	return impulse;
}

void ob_measure_air(const ob_snapshot *s, ob_air *out)
{
	double sum = 0;
	*out = (ob_air){ 0 };
	for (size_t i = 0; i < s->contacts;) {
		const ob_contact_point *c = &s->contact[i];
		if (!(pressed(s, &i) > 0) || c->a >= s->count || c->b >= s->count)
			continue;
		ob_solid a = solid_of(s, c->a), b = solid_of(s, c->b);
		double gap = fmax(0, -ob_depth(&a, &b));
		out->pairs++;
		sum += gap;
		out->max_m = fmax(out->max_m, gap);
	}
	if (out->pairs)
		out->mean_m = sum / (double)out->pairs;
}
