#include "sim/meeting.h"

#include "contact/swept.h"
#include "sim/look.h"
#include "sim/outcome.h"
#include "sim/perceive.h"

static const double touch_gap = 2e-4; // m: so near counts as meeting when looking ahead ..
static const double touch_share = .05; // .. and no more than this share of the thinner one
static const double unseen = .4; // of the thickness: who moves more may have passed through something

typedef struct pair {
	const ob_passport *passport[2];
	ob_placed at[2];
	double path, reach; // m, of both together
	double thin; // m
	double h; // s
} pair;

static bool moves(const ob_exchange *ex, uint32_t id)
{
	return ex->brief[id].state == OB_BRIEF_AWAKE;
}

// What each does in the coming step if nothing new touches it: who is in contact goes on as it does.
static ob_placed placed(const ob_passport *p, const ob_motion *m, double h)
{
	return (ob_placed){ p->shape, p->size, m->p, ob_quat_matrix(m->q), ob_madd(m->v, .5 * h, m->a), m->w };
}

static pair pair_of(const ob_universe *u, const ob_pair_key *k)
{
	const ob_exchange *ex = ob_universe_exchange(u);
	const ob_brief *a = &ex->brief[k->a], *b = &ex->brief[k->b];
	pair p = { .h = ob_universe_settings(u)->step_length, .path = a->path + b->path, .thin = INFINITY };
	p.reach = (a->state == OB_BRIEF_AWAKE ? a->reach : 0) + (b->state == OB_BRIEF_AWAKE ? b->reach : 0);
	for (int i = 0; i < 2; i++) {
		uint32_t id = i ? k->b : k->a;
		p.passport[i] = ob_passport_of(u, id);
		p.at[i] = placed(p.passport[i], ob_outcome_of(u, id), p.h);
		p.thin = fmin(p.thin, ob_shape_thickness(p.passport[i]->shape, p.passport[i]->size));
	}
	return p;
}

static double turning(const ob_passport *p, ob_vec3 w)
{
	bool same_all_round = p->shape == OB_SHAPE_SPHERE || p->shape == OB_SHAPE_PLANE;
	return same_all_round ? 0 : ob_norm(w) * ob_shape_radius(p->shape, p->size);
}

// First time at which the two touch within h (s), going on as they do; how far apart they are now (m).
static double first_touch(ob_sim *s, const pair *p, double h, double *apart)
{
	ob_manifold m;
	const ob_placed *a = &p->at[0], *b = &p->at[1];
	double speed = ob_norm(ob_sub(a->v, b->v)) + turning(p->passport[0], a->w) + turning(p->passport[1], b->w);
	double gap = fmin(touch_gap, touch_share * p->thin);
	double when = ob_swept_find(a, b, fmax(speed, 1e-9), h, gap, gap, ob_look_finder(s), &m);
	*apart = m.separation;
	return when;
}

// The way that both have made since the step began may have led through each other.
static bool passed(ob_sim *s, const ob_pair_key *k, const pair *end)
{
	const ob_motion *from[2] = { ob_newest_motion(s->u, k->a), ob_newest_motion(s->u, k->b) };
	double apart;
	if (end->path - from[0]->path - from[1]->path < unseen * end->thin)
		return false;
	pair start = *end;
	for (int i = 0; i < 2; i++) {
		start.at[i] = placed(start.passport[i], from[i], 0);
		start.at[i].v = ob_scale(ob_sub(end->at[i].p, from[i]->p), 1 / end->h);
	}
	return !isinf(first_touch(s, &start, end->h, &apart));
}

static bool has_met(ob_sim *s, ob_pair_key *k, const pair *end)
{
	ob_manifold m;
	ob_manifold_finder finder = ob_look_finder(s);
	finder.find(finder.with, &end->at[0], &end->at[1], fmax(touch_gap, end->reach), &m);
	if (m.separation <= 0 || passed(s, k, end))
		return true;
	k->limit = end->path + m.separation;
	return false;
}

static bool will_meet(ob_sim *s, ob_pair_key *k, const pair *now)
{
	double apart;
	if (!isinf(first_touch(s, now, now->h, &apart)))
		return true;
	k->limit = fmax(k->limit, now->path + apart);
	return false;
}

static void check(ob_sim *s, ob_pair_key *k, bool solved)
{
	const ob_exchange *ex = ob_universe_exchange(s->u);
	const ob_brief *a = &ex->brief[k->a], *b = &ex->brief[k->b];
	k->met = k->near = 0;
	if (k->active || (!moves(ex, k->a) && !moves(ex, k->b)))
		return;
	double left = k->limit - a->path - b->path;
	if (left > (moves(ex, k->a) ? a->reach : 0) + (moves(ex, k->b) ? b->reach : 0))
		return;
	pair p = pair_of(s->u, k);
	k->met = solved && !k->listed && left <= 0 && has_met(s, k, &p);
	if (!k->met && k->limit - p.path <= p.reach)
		k->near = will_meet(s, k, &p);
}

void ob_meetings_check(ob_sim *s, uint32_t first, uint32_t end, bool solved)
{
	ob_exchange *ex = ob_universe_exchange(s->u);
	for (uint32_t i = first; i < end; i++)
		check(s, &ex->pair[i], solved);
}

bool ob_meetings_any(const ob_universe *u)
{
	const ob_exchange *ex = ob_universe_exchange(u);
	for (uint32_t i = 0; i < ex->count->pairs; i++)
		if (ex->pair[i].met)
			return true;
	return false;
}
