#include "sim/perceive.h"

#include <float.h>

#include "sim/index.h"
#include "sim/pull.h"

static const double lasting = 2; // claimed boxes last about so many steps
static const double base_margin = .04; // m: of an object at rest ..
static const double base_share = .2; // .. but no more than this share of its radius, for heaps of small things
static const double generous = 4; // times the margin that a new box would have: too large
static const double roomy = 2; // times as long as a flight's new box: what goes on being used for it, at most
static const uint64_t review_steps = 16;
static const double far_margin = 1.5; // m: fast ones claim only what one step needs beyond this

double ob_turning_speed(ob_vec3 w, ob_shape shape, ob_vec3 size)
{
	double rate = ob_norm(w);
	return shape == OB_SHAPE_SPHERE || rate == 0 ? 0 : rate * ob_shape_radius(shape, size);
}

double ob_surface_speed(ob_vec3 v, ob_vec3 w, ob_shape shape, ob_vec3 size)
{
	return ob_norm(v) + ob_turning_speed(w, shape, size);
}

double ob_step_reach(const ob_run_settings *run, const ob_passport *p, ob_vec3 v, ob_vec3 w)
{
	double speed = ob_surface_speed(v, w, p->shape, p->size);
	return (speed + ob_norm(ob_external_acceleration(run, p)) * run->step_length) * run->step_length;
}

static bool holds(const float *box, const double *tight, double margin)
{
	for (int c = 0; c < 3; c++)
		if (tight[c] - margin < box[c] || tight[3 + c] + margin > box[3 + c])
			return false;
	return true;
}

static void claim(ob_universe *u, uint32_t id, const double *tight, double margin)
{
	ob_step_data *ex = ob_universe_step_data(u);
	for (int c = 0; c < 3; c++) {
		// Rounded outwards; a plane's box stays infinite.
		ex->bounds[id][c] = nextafterf((float)(tight[c] - margin), -FLT_MAX);
		ex->bounds[id][3 + c] = nextafterf((float)(tight[3 + c] + margin), FLT_MAX);
	}
	if (!ob_broadphase_query_pending(u, id)) {
		ex->perceived[id].count = UINT32_MAX;
		ob_requery_append(u, id);
	}
}

static double resting_margin(ob_shape shape, ob_vec3 size)
{
	return fmin(base_margin, base_share * ob_shape_radius(shape, size));
}

// What to claim for some steps: on all sides what the next one needs, in which it may be hit and thrown anywhere, and
// beyond that where it goes. Returns the margin on all sides (m); box: with the way that it goes, without the margin.
static double look_ahead(const ob_universe *u, const ob_passport *p, const ob_state *now, double reach, double *box)
{
	const double h = ob_universe_settings(u)->step_length, way[3] = { h * now->v.x, h * now->v.y, h * now->v.z };
	double once = resting_margin(p->shape, p->size) + reach;
	double more = reach > 0 ? fmax(0, fmin(lasting - 1, (far_margin - once) / reach)) : 0; // steps
	for (int c = 0; c < 3; c++) {
		box[c] += fmin(0, more * way[c]);
		box[3 + c] += fmax(0, more * way[c]);
	}
	return once + more * fmax(0, reach - h * ob_norm(now->v));
}

static bool much_larger(const float *box, const double *next, double margin)
{
	for (int c = 0; c < 3; c++)
		if ((double)box[3 + c] - box[c] > next[3 + c] - next[c] + 2 * generous * margin)
			return true;
	return false;
}

void ob_fat_aabb_update(ob_universe *u, uint32_t id, const ob_state *now, double reach)
{
	const ob_passport *p = ob_passport_of(u, id);
	const float *box = ob_universe_step_data(u)->bounds[id];
	double next[6];
	ob_shape_bounds(p->shape, p->size, now->pose, next);
	bool held = holds(box, next, reach);
	// A box claimed when the object was fast is given up when it is not; looked at now and then, not all at once.
	if (held && (ob_step_count(u) + id) % review_steps)
		return;
	double margin = look_ahead(u, p, now, reach, next);
	if (!held || much_larger(box, next, margin))
		claim(u, id, next, margin);
}

void ob_fat_aabb_renew(ob_universe *u, uint32_t id, const ob_state *now, double reach)
{
	const ob_passport *p = ob_passport_of(u, id);
	double next[6];
	ob_shape_bounds(p->shape, p->size, now->pose, next);
	double margin = look_ahead(u, p, now, reach, next);
	claim(u, id, next, margin);
}

void ob_fat_aabb_sweep(ob_universe *u, uint32_t id, const double *box, double margin)
{
	const float *old = ob_universe_step_data(u)->bounds[id];
	bool fits = holds(old, box, margin);
	for (int c = 0; c < 3; c++)
		fits &= old[3 + c] - old[c] <= roomy * (box[3 + c] - box[c] + 2 * margin);
	if (!fits)
		claim(u, id, box, margin);
}

bool ob_broadphase_query_pending(const ob_universe *u, uint32_t id)
{
	return ob_universe_step_data(u)->perceived[id].count == UINT32_MAX;
}

void ob_broadphase_query(ob_universe *u, uint32_t id, uint64_t *box_tests)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t near[256], n = ob_index_query(u, id, near, 256, box_tests);
	uint32_t offset = ob_neighbours_reserve(u, n);
	if (offset == UINT32_MAX) {
		ex->count->failure = OB_STEP_NEIGHBOURS_FULL;
		n = offset = 0;
	} else if (n <= 256) {
		for (uint32_t i = 0; i < n; i++)
			ex->perceived_id[offset + i] = near[i];
	} else {
		ob_index_query(u, id, ex->perceived_id + offset, n, box_tests);
	}
	ex->perceived[id] = (struct ob_neighbours){ offset, n };
}
