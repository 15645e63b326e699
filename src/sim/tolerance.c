#include "sim/tolerance.h"

#include "sim/touch.h"

static const uint32_t most_substeps = 1u << (OB_SUBSTEP_CHOICES - 1);
static const uint32_t most_for_creep = 64; // more of them do not help friction to hold
static const double memory = 1; // s, for which slip is remembered
static const double sticking = .999; // of its bound: friction that is smaller holds
static const double gain = 8; // fewer substeps are tried when they may multiply the error by so much

uint32_t ob_error_control_substeps(const ob_sim *s, const ob_island *is)
{
	const ob_run_settings *run = ob_universe_settings(s->u);
	const uint32_t *id = ob_universe_step_data(s->u)->member + is->first_member;
	uint32_t most = run->substeps;
	if (!(run->tolerance > 0))
		return most;
	for (uint32_t i = 0; i < is->members; i++) {
		uint32_t asked = ob_newest_motion(s->u, id[i])->substeps;
		most = asked > most && asked <= most_substeps ? asked : most;
	}
	return most;
}

static bool is_set(const ob_sim *s)
{
	return ob_universe_settings(s->u)->tolerance > 0;
}

// ---- notes

static double depth_of(const ob_island_work *w, const ob_contact *t)
{
	const ob_batch *b = &w->batch[t->lane / OB_LANES];
	const uint32_t l = t->lane % OB_LANES;
	const double *da = w->d[t->a], *db = w->d[t->b];
	double deepest = 0;
	for (uint32_t j = 0; j < t->points; j++) {
		double gap = b->gap[j][l];
		for (int c = 0; c < 3; c++)
			gap += b->n[c][l] * (da[c] - db[c]) + b->ja[j][c][l] * da[3 + c] - b->jb[j][c][l] * db[3 + c];
		deepest = fmax(deepest, -gap);
	}
	return deepest;
}

void ob_error_control_note_depth(ob_sim *s, bool at_start)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; is_set(s) && i < w->touches; i++) {
		ob_contact *t = &w->touch[i];
		if (t->lane == OB_NO_LANE)
			continue;
		double depth = depth_of(w, t);
		if (at_start)
			t->depth_given = depth;
		else if (depth > t->depth_given) {
			w->error_new = fmax(w->error_new, depth);
			t->growth = fmax(t->growth, depth - t->depth_given);
		}
		w->error = fmax(w->error, depth);
	}
}

// m/s, at the contact's centroid, if friction holds it
static double slip_of(const ob_island_work *w, const ob_contact *t)
{
	const ob_batch *b = &w->batch[t->lane / OB_LANES];
	const uint32_t l = t->lane % OB_LANES;
	const double *va = w->v[t->a], *vb = w->v[t->b];
	double sum = 0, rate[2] = { 0, 0 };
	for (uint32_t j = 0; j < t->points; j++)
		sum += b->impulse[j][l];
	double bound = sticking * t->mu * sum;
	if (!(b->impulse[4][l] * b->impulse[4][l] + b->impulse[5][l] * b->impulse[5][l] < bound * bound))
		return 0;
	for (int c = 0; c < 3; c++) {
		rate[0] += b->t1[c][l] * (va[c] - vb[c]) + b->fa1[c][l] * va[3 + c] - b->fb1[c][l] * vb[3 + c];
		rate[1] += b->t2[c][l] * (va[c] - vb[c]) + b->fa2[c][l] * va[3 + c] - b->fb2[c][l] * vb[3 + c];
	}
	return hypot(rate[0], rate[1]);
}

void ob_error_control_note_slip(ob_sim *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; is_set(s) && i < w->touches; i++) {
		ob_contact *t = &w->touch[i];
		if (t->lane != OB_NO_LANE && t->mu > 0)
			t->slip += w->h * slip_of(w, t);
	}
}

void ob_error_control_note_bounce(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const double tolerance = ob_universe_settings(s->u)->tolerance;
	const ob_impact_rows at = { w->v, w->drift, w->d };
	double lost = 0;
	for (uint32_t i = 0; is_set(s) && w->elastic && w->pull > 0 && i < w->touches; i++) {
		const ob_contact *t = &w->touch[i];
		if (t->lane == OB_NO_LANE || !(t->e > 0))
			continue;
		// m/s, approaches that would rebound to the tolerance, and those that are resolved at all
		double tolerable = sqrt(2 * w->pull * tolerance) / t->e, resolved = 4 * w->pull * w->substep;
		ob_impact slow = { w->h, w->h, t->e, tolerable, 1, 1 };
		if (resolved > tolerable &&
		    ob_impact_time(&w->batch[t->lane / OB_LANES], t->lane % OB_LANES, &slow, &at) <= slow.h)
			lost = fmax(lost, t->e * t->e * resolved * resolved / (2 * w->pull));
	}
	w->error = fmax(w->error, lost);
	w->error_new = fmax(w->error_new, lost);
}

// ---- the verdict

// What slipped fades over the memory.
static void note_creep(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = ob_universe_settings(s->u);
	const double tolerance = run->tolerance, fading = fmin(1, run->step_length / memory);
	for (uint32_t i = 0; i < w->touches; i++) {
		ob_contact *t = &w->touch[i];
		t->creep = t->creep * (1 - fading) + t->slip;
		w->error = fmax(w->error, t->creep);
		bool goes_on = t->slip > fading * tolerance && w->substeps < most_for_creep;
		if (t->creep > tolerance && (goes_on || t->slip > .5 * tolerance))
			w->error_new = fmax(w->error_new, t->creep);
	}
}

// More before the error is too large, so that little is solved twice; fewer where that has room.
static uint32_t wanted(const ob_island_work *w, const ob_contact *t, const ob_run_settings *run)
{
	const double tolerance = run->tolerance, fading = fmin(1, run->step_length / memory);
	double depth = t->depth_given + t->growth, creep = t->slip / fading; // which slipping on like this adds up to
	double change = fmax(depth, t->creep) > .5 * tolerance ? fmax(t->growth, creep) : t->growth;
	uint32_t n = w->substeps;
	if (t->creep > .75 * tolerance && creep > tolerance && n < most_for_creep)
		n *= 2;
	for (; n >= 2 * run->substeps && change * gain <= tolerance; change *= gain)
		n /= 2;
	return n;
}

// Each member asks for what its own contacts need.
static void ask(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = ob_universe_settings(s->u);
	for (uint32_t i = 0; i < w->rows; i++)
		w->member[i].substeps = run->substeps;
	for (uint32_t i = 0; i < w->touches; i++) {
		const ob_contact *t = &w->touch[i];
		uint32_t n = wanted(w, t, run);
		for (int side = 0; side < 2; side++) {
			ob_body *m = &w->member[side ? t->b : t->a];
			m->substeps = n > m->substeps ? n : m->substeps;
		}
	}
}

bool ob_error_control_accept(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const double tolerance = ob_universe_settings(s->u)->tolerance;
	if (!is_set(s))
		return true;
	ob_contacts_update(s, 0);
	ob_error_control_note_depth(s, false);
	note_creep(s);
	if (w->error_new > tolerance && w->substeps < most_substeps) {
		w->substeps *= w->error_new > 16 * tolerance ? 4 : 2;
		w->substeps = w->substeps < most_substeps ? w->substeps : most_substeps;
		return false;
	}
	ask(s);
	s->counters.islands_over += w->error > tolerance;
	s->counters.error = fmax(s->counters.error, w->error);
	s->counters.chosen[31 - __builtin_clz(w->substeps)]++;
	return true;
}
