// Sum of the normal forces of an object's contacts. Pairs lie in no order, so forces are added as whole numbers, whose sum is
// the same in any order.
#include "sensor/sensor.h"

static const double units = 0x1p30; // of a newton: a sum may reach 2^33 N

// True if its contacts stay as they are: its island is not solved.
static bool stands(const ob_universe *u, uint32_t id)
{
	return ob_passport_of(u, id)->flags & OB_OBJECT_STATIC || ob_newest_motion(u, id)->flags & OB_MOTION_RESTS;
}

// Normal force (N) of a pair when the running step ends.
static double force_of(const ob_universe *u, const ob_step_data *data, const ob_pair_key *k)
{
	const ob_pair_record *r = &data->record[k->record];
	const uint64_t steps = ob_step_count(u) + 1;
	const int newest = ob_pair_newest(r, steps);
	if (newest < 0 || (r->stamp[newest] != steps + 1 && !(stands(u, k->a) && stands(u, k->b))))
		return 0;
	const ob_pair_state *p = &r->version[newest];
	double sum = 0;
	for (uint32_t i = 0; i < p->points && i < OB_PAIR_POINTS; i++)
		sum += p->impulse[i];
	return p->substep > 0 ? sum / p->substep : 0;
}

bool ob_sample_touch(const ob_sampled *x, double *value)
{
	const ob_step_data *data = ob_universe_step_data(x->u);
	int64_t sum = 0;
	for (uint32_t i = 0; i < ob_pairs_end(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		if (k->a != k->b && (k->a == x->sensor->object || k->b == x->sensor->object) && k->active &&
		    k->record != OB_NO_RECORD)
			sum += (int64_t)nearbyint(ob_min(force_of(x->u, data, k), 1e9) * units);
	}
	value[0] = (double)sum / units;
	return true;
}
