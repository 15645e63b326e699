// Cases are measuring instruments: each must read nearly zero for the exact motion, and must not be content with an
// engine that stands still, sees no contacts, or goes mad.
#include <string.h>

#include "check.h"
#include "fake_engine.h"
#include "lab/case.h"
#include "lab/look.h"
#include "reference/ballistics.h"
#include "reference/impact.h"

static void test_metadata(const ob_case *c)
{
	CHECK(c->row >= 1 && c->row <= 24);
	CHECK(c->name && *c->name && c->name[strspn(c->name, "abcdefghijklmnopqrstuvwxyz0123456789-")] == 0);
	CHECK(ob_case_find(c->name) == c);
	CHECK(strlen(c->title) > 4 && strlen(c->title) < 40);
	CHECK(strlen(c->setup) > 20 && strlen(c->peers) > 5);
	CHECK(c->duration > 0 && c->step == 1. / 60 && c->runs >= 1);
	CHECK(c->figures >= 1 && c->figures <= OB_FIGURES);
	CHECK(c->build && c->judge);
	int promised = 0;
	for (uint32_t i = 0; i < c->figures; i++) {
		const ob_figure_def *f = &c->figure[i];
		CHECK(f->name && *f->name && f->unit && *f->unit && f->reference && *f->reference);
		CHECK(f->target >= 0 || isnan(f->target));
		promised += !isnan(f->target);
	}
	CHECK(promised >= 1);
	for (const ob_case *const *other = ob_cases; *other != c; other++) {
		CHECK(strcmp((*other)->name, c->name) && strcmp((*other)->title, c->title));
		CHECK((*other)->row <= c->row);
	}
}

static ob_outcome outcome(const ob_case *c, const ob_peer_kind *kind)
{
	ob_outcome out;
	ob_error e = { "" };
	ob_peer_settings s = { .step = c->step, .substeps = 1, .iterations = 1 };
	CHECK(ob_case_run(c, kind, &s, &out, &e));
	return out;
}

// All promised figures within their targets.
static bool met(const ob_case *c, const ob_outcome *out)
{
	for (uint32_t i = 0; i < c->figures; i++)
		if (!isnan(c->figure[i].target) && !(out->figure[i] <= c->figure[i].target))
			return false;
	return !*out->failed;
}

static void print(const ob_case *c, const ob_peer_kind *kind, const ob_outcome *out)
{
	fprintf(stderr, "%s, %s:", c->name, kind->name);
	for (uint32_t i = 0; i < c->figures; i++)
		fprintf(stderr, " %.3g %s,", out->figure[i], c->figure[i].unit);
	fprintf(stderr, " %s\n", *out->failed ? out->failed : "did not fail");
}

// ---- exact motions

static ob_state bouncing(const ob_peer_world *w, uint32_t id, double t)
{
	if (w->passport[id].flags & OB_OBJECT_STATIC)
		return w->state[id];
	ob_state s = w->state[id];
	double g = -w->gravity.z, e = w->passport[id].restitution, radius = w->passport[id].size.x, from = 0,
	       to = INFINITY;
	double height = s.pose.p.z - radius, begin = 0;
	int k = 0;
	while ((to = ob_reference_impact_time(height, g, e, k + 1)) < t)
		from = to, k++;
	double v = k ? sqrt(2 * g * ob_reference_apex(height, e, k)) : 0;
	begin = k ? from : 0;
	s.v.z = v - g * (t - begin);
	s.pose.p.z = radius + (k ? 0 : height) + v * (t - begin) - .5 * g * (t - begin) * (t - begin);
	return s;
}

// Head-on pairs along x, in the order of their ids.
static ob_state meeting(const ob_peer_world *w, uint32_t id, double t)
{
	uint32_t first = id & ~1u;
	const ob_passport *a = &w->passport[first], *b = a + 1;
	const ob_state *sa = &w->state[first], *sb = sa + 1;
	ob_reference_pair before = { sa->v.x, sb->v.x };
	ob_reference_pair after = ob_reference_impact(a->mass, b->mass, before, a->restitution);
	double meets = (sb->pose.p.x - sa->pose.p.x - a->size.x - b->size.x) / (before.a - before.b);
	ob_state s = w->state[id];
	s.pose.p.x += s.v.x * fmin(t, meets);
	if (t > meets) {
		s.v.x = id == first ? after.a : after.b;
		s.pose.p.x += s.v.x * (t - meets);
	}
	return s;
}

static ob_state cradle(const ob_peer_world *w, uint32_t id, double t)
{
	double v[5];
	int incoming = 0;
	while (w->state[incoming].v.x > 0)
		incoming++;
	ob_reference_cradle(5, incoming, 1, v);
	ob_state s = w->state[id];
	double meets = w->state[incoming].pose.p.x - w->state[incoming - 1].pose.p.x - 1;
	s.pose.p.x += s.v.x * fmin(t, meets) + v[id] * fmax(t - meets, 0);
	if (t > meets)
		s.v.x = v[id];
	return s;
}

// What each case is fed: its exact motion, and which of the broken engines are right there.
typedef struct expectation {
	const char *name;
	exact_motion motion; // NULL: not known in closed form
	enum { ALL_WRONG, FROZEN_IS_RIGHT, BLIND_IS_RIGHT } broken;
} expectation;

static const expectation expected[] = {
	{ "projectile", exact_flight, BLIND_IS_RIGHT },
	{ "head-on", meeting, ALL_WRONG },
	{ "cradle-1", cradle, ALL_WRONG },
	{ "cradle-2", cradle, ALL_WRONG },
	{ "bounce", bouncing, ALL_WRONG },
	{ "apexes", bouncing, ALL_WRONG },
	{ "bouncing-49", bouncing, ALL_WRONG },
};

static void test_exact(const ob_case *c, const expectation *x)
{
	ob_outcome out = outcome(c, &exact_engine);
	if (x->motion && !met(c, &out))
		print(c, &exact_engine, &out);
	CHECK(!x->motion || met(c, &out));
	CHECK(out.body_seconds >= c->duration * .99 && out.cpu_s >= 0 && out.wall_s >= 0);
}

static void test_broken(const ob_case *c, const ob_peer_kind *kind, bool is_right)
{
	ob_outcome out = outcome(c, kind);
	if (met(c, &out) != is_right)
		print(c, kind, &out);
	CHECK(met(c, &out) == is_right);
}

// What an engine itself breaks is said, and no figure looks good.
static void test_mad(const ob_case *c, const ob_peer_kind *kind, const char *why)
{
	ob_outcome out = outcome(c, kind);
	CHECK(!strncmp(out.failed, why, strlen(why)));
	for (uint32_t i = 0; i < c->figures; i++)
		CHECK(isinf(out.figure[i]));
	CHECK(out.body_seconds > 0);
}

int main(void)
{
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const expectation *x = NULL;
		for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
			if (!strcmp(expected[i].name, (*c)->name))
				x = &expected[i];
		CHECK(x);
		test_metadata(*c);
		if (!x)
			continue;
		exact_engine_use(x->motion ? x->motion : exact_rest);
		test_exact(*c, x);
		test_broken(*c, &frozen_engine, x->broken == FROZEN_IS_RIGHT);
		test_broken(*c, &blind_engine, x->broken == BLIND_IS_RIGHT);
		test_mad(*c, &drunk_engine, "became not a number");
		test_mad(*c, &bursting_engine, "exploded");
		test_mad(*c, &dying_engine, "the engine gave up");
	}
	CHECK(!ob_case_find("no-such-case"));
	return check_end();
}
