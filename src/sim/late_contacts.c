#include "sim/late_contacts.h"

#include "contact/manifold.h"
#include "sim/broadphase.h"
#include "sim/prefetch.h"
#include "sim/flight.h"
#include "sim/narrowphase.h"
#include "sim/publish.h"

static const double touch_gap = 2e-4; // m: so near counts as meeting when looking ahead ..
static const double touch_share = .05; // .. and no more than this share of the thinner one
static const double unseen = .4; // of the thickness: who moves more may have passed through something

typedef struct pair {
	ob_placed at[2];
	double path, reach; // m, of both together
	double thin; // m
	double h; // s
} pair;

// What each does in the coming step if nothing new touches it: who is in contact goes on as it does.
static ob_placed placed(ob_sim *s, uint32_t id, const ob_motion *m, uint64_t steps)
{
	const ob_passport *p = ob_passport_of(s->u, id);
	const double h = ob_universe_settings(s->u)->step_length;
	ob_state now = ob_ballistic_state(s, id, m, (double)steps * h);
	return (ob_placed){ p->shape, p->size, now.pose.p, ob_quat_matrix(now.pose.q), ob_madd(now.v, .5 * h, m->a),
			    now.w };
}

static pair pair_of(ob_sim *s, const ob_pair_key *k, uint64_t steps)
{
	const ob_universe *u = s->u;
	const ob_step_data *ex = ob_universe_step_data(u);
	const ob_schedule *a = &ex->schedule[k->a], *b = &ex->schedule[k->b];
	pair p = { .h = ob_universe_settings(u)->step_length, .thin = INFINITY };
	p.path = ob_schedule_path(a, steps) + ob_schedule_path(b, steps);
	p.reach = a->reach + b->reach;
	for (int i = 0; i < 2; i++) {
		uint32_t id = i ? k->b : k->a;
		p.at[i] = placed(s, id, ob_result_of(u, id), steps);
		p.thin = fmin(p.thin, ob_shape_thickness(p.at[i].shape, p.at[i].size));
	}
	return p;
}

// First time at which the two touch within h (s), going on as they do; how far apart they are now (m).
static double first_touch(ob_sim *s, const pair *p, double h, double *apart)
{
	ob_manifold m;
	const ob_placed *a = &p->at[0], *b = &p->at[1];
	double speed = ob_norm(ob_sub(a->v, b->v)) + ob_turning_speed(a->w, a->shape, a->size) +
		       ob_turning_speed(b->w, b->shape, b->size);
	double gap = fmin(touch_gap, touch_share * p->thin);
	double when = ob_time_of_impact(a, b, fmax(speed, 1e-9), h, gap, gap, ob_narrowphase_finder(s), &m);
	*apart = m.separation;
	return when;
}

// The way that both have made since the step began may have led through each other.
static bool passed(ob_sim *s, const ob_pair_key *k, const pair *end)
{
	const uint32_t id[2] = { k->a, k->b };
	const uint64_t step = ob_step_count(s->u);
	pair start = *end;
	double way = end->path, apart;
	for (int i = 0; i < 2; i++)
		way -= ob_path_now(ob_newest_motion(s->u, id[i]), step);
	if (way < unseen * end->thin)
		return false;
	for (int i = 0; i < 2; i++) {
		start.at[i] = placed(s, id[i], ob_newest_motion(s->u, id[i]), step);
		start.at[i].v = ob_scale(ob_sub(end->at[i].p, start.at[i].p), 1 / end->h);
	}
	return !isinf(first_touch(s, &start, end->h, &apart));
}

static bool has_met(ob_sim *s, ob_pair_key *k, const pair *end)
{
	ob_manifold m;
	ob_manifold_finder finder = ob_narrowphase_finder(s);
	finder.find(finder.with, &end->at[0], &end->at[1], fmax(touch_gap, end->reach), &m);
	if (m.separation <= 0 || passed(s, k, end))
		return true;
	k->limit = end->path + m.separation;
	return false;
}

// How the spheres round two bodies lie and move, which is had without attitudes.
typedef struct spheres {
	ob_vec3 apart, v; // m, m/s, of the first from the second
	double gap; // m
	bool straight; // to each other they go straight on, for the same pulls at them
} spheres;

static spheres spheres_of(const ob_universe *u, const ob_pair_key *k, uint64_t steps)
{
	const ob_motion *a = ob_result_of(u, k->a), *b = ob_result_of(u, k->b);
	const ob_passport *pa = ob_passport_of(u, k->a), *pb = ob_passport_of(u, k->b);
	const double time = (double)steps * ob_universe_settings(u)->step_length;
	spheres out = { .straight = a->a.x == b->a.x && a->a.y == b->a.y && a->a.z == b->a.z };
	out.apart = ob_sub(ob_centre_now(u, k->a, a, steps), ob_centre_now(u, k->b, b, steps));
	out.v = ob_sub(ob_madd(a->v, time - a->t0, a->a), ob_madd(b->v, time - b->t0, b->a));
	out.gap = ob_norm(out.apart) - ob_shape_radius(pa->shape, pa->size) - ob_shape_radius(pb->shape, pb->size);
	return out;
}

// For how long they stay apart if they go straight on (s).
static double apart_for(const spheres *s)
{
	double far = s->gap - touch_gap, radii = ob_norm(s->apart) - far, closing = -ob_dot(s->apart, s->v);
	double square = far * (far + 2 * radii), d = closing * closing - ob_norm2(s->v) * square;
	if (far <= 0)
		return 0;
	return closing > 0 && d > 0 ? square / (closing + sqrt(d)) : INFINITY;
}

// Sets until when two that nobody visits stay clear of each other; false: not beyond the coming step.
static bool stay_clear(const ob_universe *u, ob_pair_key *k, const spheres *round, uint64_t steps)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	const ob_schedule *a = &ex->schedule[k->a], *b = &ex->schedule[k->b];
	double until = fmin(a->due, b->due);
	if (a->state != OB_SCHEDULE_AWAKE || b->state != OB_SCHEDULE_AWAKE || until <= (double)steps + 1 || !round->straight)
		return false;
	until = fmin(until, (double)steps + floor(apart_for(round) / ob_universe_settings(u)->step_length));
	k->clear_until = (uint32_t)until;
	k->clear_as_of = (uint32_t)steps;
	return k->clear_until > steps;
}

static bool is_clear(const ob_step_data *ex, const ob_pair_key *k, uint64_t steps)
{
	return k->clear_until > steps && ex->schedule[k->a].since <= k->clear_as_of && ex->schedule[k->b].since <= k->clear_as_of;
}

static bool will_meet(ob_sim *s, ob_pair_key *k, const pair *now)
{
	double apart;
	if (!isinf(first_touch(s, now, now->h, &apart)))
		return true;
	k->limit = fmax(k->limit, now->path + apart);
	return false;
}

// Who flies past a plane meets it when it is due, and not before.
static bool foreseen(const ob_schedule *a, const ob_schedule *b, uint64_t steps)
{
	return (a->state == OB_SCHEDULE_PLANE && b->due > steps) || (b->state == OB_SCHEDULE_PLANE && a->due > steps);
}

// What is in a flight that began before is on no plane until that ends.
static bool flies_over(const ob_universe *u, uint32_t id, uint64_t steps)
{
	const ob_motion *m = ob_result_of(u, id);
	const double time = (double)steps * ob_universe_settings(u)->step_length;
	return m->t0 < time && m->valid_until >= time;
}

// m, of both together in the step that was solved, or none was.
static double way_made(const ob_universe *u, const ob_pair_key *k, double paths, bool solved)
{
	const uint64_t step = ob_step_count(u);
	return solved ? paths - ob_path_now(ob_newest_motion(u, k->a), step) -
				ob_path_now(ob_newest_motion(u, k->b), step)
		      : 0;
}

// Spheres that are too far from each other for anything to have happened, or to happen in the coming step, settle it.
static bool far_apart(const ob_universe *u, ob_pair_key *k, double paths, double reach, bool solved, uint64_t steps)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	const ob_schedule *a = &ex->schedule[k->a], *b = &ex->schedule[k->b];
	if (a->state == OB_SCHEDULE_PLANE || b->state == OB_SCHEDULE_PLANE)
		return flies_over(u, a->state == OB_SCHEDULE_PLANE ? k->b : k->a, steps);
	if (ob_universe_settings(u)->narrow_phase == OB_NARROW_AABB)
		return false;
	spheres round = spheres_of(u, k, steps);
	if (round.gap <= touch_gap || (paths >= k->limit && way_made(u, k, paths, solved) >= round.gap))
		return false;
	k->limit = fmax(k->limit, paths + round.gap);
	return k->limit - paths > reach || stay_clear(u, k, &round, steps);
}

// Will the two touch in the coming step, or have they in this? left: m, of the distance through which they may get.
static void look_closely(ob_sim *s, ob_pair_key *k, double left, bool solved, uint64_t steps)
{
	const ob_step_data *ex = ob_universe_step_data(s->u);
	pair p = pair_of(s, k, steps);
	k->late = solved && !k->in_island && left <= 0 && has_met(s, k, &p);
	bool on_plane = ex->schedule[k->a].state == OB_SCHEDULE_PLANE || ex->schedule[k->b].state == OB_SCHEDULE_PLANE;
	if (!k->late && !on_plane && k->limit - p.path <= p.reach)
		k->expected = will_meet(s, k, &p);
}

// The first step that begins with so little left of the distance that the two might get through it: they go by
// themselves until then.
static double used_up(const ob_pair_key *k, double paths, double reach, uint64_t steps)
{
	return reach > 0 ? (double)steps + fmax(1, floor((k->limit - paths) / reach) - 1) : INFINITY;
}

// steps: that are complete, or solved. Returns the step (from 0) that the pair must be checked for next, as far as the
// briefs say; < 0: they do not.
static double due_by_briefs(const ob_step_data *ex, ob_pair_key *k, uint64_t steps)
{
	const ob_schedule *a = &ex->schedule[k->a], *b = &ex->schedule[k->b];
	if (k->late | k->expected) // most pairs are left as they are: their memory stays with every worker that has read it
		k->late = k->expected = 0;
	if ((a->state != OB_SCHEDULE_AWAKE && b->state != OB_SCHEDULE_AWAKE) || foreseen(a, b, steps))
		return INFINITY;
	if (k->active)
		return (double)steps;
	if (is_clear(ex, k, steps))
		return k->clear_until;
	double paths = ob_schedule_path(a, steps) + ob_schedule_path(b, steps), reach = (double)a->reach + (double)b->reach;
	return k->limit - paths > reach ? used_up(k, paths, reach, steps) : -1;
}

// Same, by what has been published.
static double due_by_motions(ob_sim *s, ob_pair_key *k, bool solved, uint64_t steps)
{
	const ob_step_data *ex = ob_universe_step_data(s->u);
	const ob_schedule *a = &ex->schedule[k->a], *b = &ex->schedule[k->b];
	solved &= steps == 0 || !is_clear(ex, k, steps - 1); // then they cannot have met in it
	double paths = ob_schedule_path(a, steps) + ob_schedule_path(b, steps), reach = (double)a->reach + (double)b->reach;
	const double left = k->limit - paths;
	if (!far_apart(s->u, k, paths, reach, solved, steps))
		look_closely(s, k, left, solved, steps);
	if (k->expected)
		return (double)steps;
	return is_clear(ex, k, steps) ? k->clear_until : used_up(k, paths, reach, steps);
}

void ob_late_contacts_begin(ob_universe *u, bool solved)
{
	ob_late_contacts_reset(u);
	ob_universe_step_data(u)->count->checked = (uint32_t)ob_step_count(u) + solved;
}

// What the motions of these say is on its way from memory while those before them are looked at.
static void look_at_motions(ob_sim *s, const uint32_t *pairs, uint32_t n, bool solved, bool *met, double *next)
{
	enum { AHEAD = 4 };
	const uint64_t steps = ob_step_count(s->u) + solved;
	ob_pair_key *all = ob_universe_step_data(s->u)->pair;
	for (uint32_t i = 0; i < n + AHEAD; i++) {
		if (i < n)
			ob_prefetch_pair(s, &all[pairs[i]]);
		if (i < AHEAD)
			continue;
		ob_pair_key *k = &all[pairs[i - AHEAD]];
		*next = fmin(*next, due_by_motions(s, k, solved, steps));
		*met |= k->late;
	}
}

void ob_late_contacts_check(ob_sim *s, uint32_t first, uint32_t end, bool solved)
{
	ob_step_data *ex = ob_universe_step_data(s->u);
	const uint64_t steps = ob_step_count(s->u) + solved;
	double next = UINT32_MAX;
	bool met = false;
	while (first < end) {
		uint32_t closer[OB_LATE_CONTACTS_BATCH], n = 0;
		for (uint32_t i = 0; i < OB_LATE_CONTACTS_BATCH && first < end; i++, first++) {
			double due = due_by_briefs(ex, &ex->pair[first], steps);
			if (due < 0)
				closer[n++] = first;
			else
				next = due < next ? due : next;
		}
		look_at_motions(s, closer, n, solved, &met, &next);
	}
	ob_late_contacts_note(s->u, met, (uint32_t)next);
}
