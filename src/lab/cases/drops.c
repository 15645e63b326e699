// Bodies dropped exactly flat, on a face or on an edge below the centre, rise straight up again: the points hit at
// once, and their order must not show.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/mechanics.h"
#include "world/world.h"

enum {
	PROPORTIONS = 4,
	RESTITUTIONS = 4,
	FRICTIONS = 3,
	KINDS = 2,
	ALL = KINDS * PROPORTIONS * RESTITUTIONS * FRICTIONS
};
static const ob_vec3 half[PROPORTIONS] = { { .25, .25, .25 }, { .4, .4, .1 }, { .1, .1, .4 }, { .1, .2, .4 } }; // m
static const double restitution[RESTITUTIONS] = { .2, .5, .8, 1 }, friction[FRICTIONS] = { 0, .3, 1 };
static const double height = 1; // m, of the lowest point
enum { BOUNCES = 2 }; // observed ones
enum { MEMORY_LAST, MEMORY_BOUNCES };

typedef struct drop {
	int kind, proportion; // kind: 0 on a face, 1 on an edge
	double e, mu;
} drop;

static drop drop_of(int i)
{
	return (drop){ .kind = i % KINDS,
		       .proportion = i / KINDS % PROPORTIONS,
		       .e = restitution[i / KINDS / PROPORTIONS % RESTITUTIONS],
		       .mu = friction[i / KINDS / PROPORTIONS / RESTITUTIONS] };
}

// Sets the body's friction so that the pair's is mu, with a ground of friction 1.
static void lift(ob_world_body b, int i, double lowest, ob_vec3 turn)
{
	drop d = drop_of(i);
	b.passport->friction = d.mu * d.mu;
	b.passport->restitution = d.e;
	b.state->pose.q = ob_quat_turn(ob_quat_turn(ob_quat_identity(), turn), ob_v3(0, 0, .37 * i));
	b.state->pose.p = ob_v3(4 * (i % 10), 4 * (i / 10), height + lowest);
}

// variant: true if they fall on boxes
static void build_drops(ob_world *w, uint32_t run, const double *variant)
{
	const bool box = variant[0] > 0;
	if (!box)
		ob_world_ground(w).passport->friction = 1;
	for (int i = 0; i < ALL; i++) {
		drop d = drop_of(i);
		ob_vec3 h = half[d.proportion];
		bool edge = d.kind == 1;
		lift(ob_world_box(w, 1000 * h.x * h.y * h.z, h, ob_v3(0, 0, 0)), i, edge ? hypot(h.x, h.z) : h.z,
		     ob_v3(0, edge ? atan2(h.x, h.z) : 0, 0));
	}
	for (int i = 0; box && i < ALL; i++) {
		ob_world_body b = ob_world_box(w, 0, ob_v3(1, 1.2, .3), ob_v3(4 * (i % 10), 4 * (i / 10), -.3));
		b.passport->friction = 1;
		b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, .61 * i));
	}
}

// Round shapes, instead of proportions: a cylinder on its face, the same on its side, a capsule on its side.
enum { ROUND_KINDS = 3 };

static void build_round_drops(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_ground(w).passport->friction = 1;
	for (int i = 0; i < ALL; i++) {
		int kind = drop_of(i).proportion % ROUND_KINDS;
		ob_world_body b = (kind == 2 ? ob_world_capsule : ob_world_cylinder)(w, 10, .2, .3, ob_v3(0, 0, 0));
		lift(b, i, kind ? .2 : .3, ob_v3(0, kind ? M_PI_2 : 0, 0));
	}
}

enum { SIDEWAYS, SPIN, APEX, DROP_FIGURES };

// Number of the drop of body id.
static int which(const ob_case_run_state *t, uint32_t id)
{
	return (int)id - (t->world->passport[0].flags & OB_OBJECT_STATIC ? 1 : 0);
}

// A flight's apex follows from its height and speed.
static void observe_drop(ob_case_run_state *t, uint32_t id, double *figure)
{
	drop d = drop_of(which(t, id));
	double g = ob_look_gravity(t), *memory = &t->body_memory[8 * id];
	ob_state s = ob_look_at(t, id);
	if (memory[MEMORY_LAST] < 0 && s.v.z > 0)
		memory[MEMORY_BOUNCES]++;
	memory[MEMORY_LAST] = s.v.z;
	int k = (int)memory[MEMORY_BOUNCES];
	if (k > BOUNCES || t->time > ob_reference_impact_time(height, g, d.e, BOUNCES + 1))
		return;
	ob_look_keep(&figure[SIDEWAYS], hypot(s.v.x, s.v.y));
	ob_look_keep(&figure[SPIN], ob_norm(s.w));
	double apex = height + ob_look_moved(t, id).z + s.v.z * s.v.z / (2 * g);
	if (k > 0)
		ob_look_keep(&figure[APEX], fabs(apex - ob_reference_apex(height, d.e, k)) / height);
}

static void observe_drops(ob_case_run_state *t)
{
	for (uint32_t id = 0; id < t->world->objects; id++)
		if (ob_look_moves(t, id))
			observe_drop(t, id, &t->figure[DROP_FIGURES * drop_of(which(t, id)).kind]);
}

static void observe_round_drops(ob_case_run_state *t)
{
	for (uint32_t id = 1; id < t->world->objects; id++)
		observe_drop(t, id, t->figure);
}

static void judge_drops(ob_case_run_state *t)
{
	for (uint32_t id = 0; id < t->world->objects; id++)
		if (ob_look_moves(t, id) && t->body_memory[8 * id + MEMORY_BOUNCES] < 1)
			t->failed = "never bounced";
	ob_look_fail_below(t);
}

#define STRAIGHT "none: it goes straight up again, by symmetry"
#define NEWTON "h e^(2 k) (Newton 1687)"
// clang-format off
#define DROP_FIGURE(on) \
	{ "sideways velocity, " on, "m/s", 1e-9, STRAIGHT }, { "spin, " on, "rad/s", 1e-9, STRAIGHT }, \
	{ "error of height over the drop, " on, "1", 1e-6, NEWTON }
// clang-format on
#define DROP_CASE .row = 28, .duration = 2.4

const ob_case ob_case_drops_plane = {
	.name = "drops-plane",
	.title = "Boxes dropped flat on a plane",
	.setup = "Boxes of four proportions fall 1 m on a face, or on an edge below their centre: restitution .2 to 1, "
		 "friction 0 to 1, two bounces.",
	.figures = 2 * DROP_FIGURES,
	.figure = { DROP_FIGURE("face"), DROP_FIGURE("edge") },
	.build = build_drops,
	.observe = observe_drops,
	.judge = judge_drops,
	DROP_CASE,
};

const ob_case ob_case_drops_box = {
	.name = "drops-box",
	.title = "Boxes dropped flat on boxes",
	.setup = "As before, on the upper faces of fixed boxes that are turned otherwise.",
	.figures = 2 * DROP_FIGURES,
	.figure = { DROP_FIGURE("face"), DROP_FIGURE("edge") },
	.build = build_drops,
	.variant = { true },
	.observe = observe_drops,
	.judge = judge_drops,
	DROP_CASE,
};

const ob_case ob_case_drops_round = {
	.name = "drops-round",
	.title = "Cylinders and capsules dropped flat",
	.setup = "Cylinders on a face and on their side, capsules on their side, as the boxes before, on a plane.",
	.figures = DROP_FIGURES,
	.figure = { DROP_FIGURE("face or side") },
	.build = build_round_drops,
	.observe = observe_round_drops,
	.judge = judge_drops,
	DROP_CASE,
};
