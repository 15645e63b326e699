// Cylinders and capsules: standing, lying, stacked, rolling down a slope, in a pile with boxes and spheres.
#include "base/random.h"
#include "lab/cases/cases.h"
#include "lab/cases/stand.h"
#include "lab/heap.h"
#include "lab/look.h"
#include "reference/mechanics.h"
#include "world/world.h"

static const ob_vec3 onto_side = { M_PI_2, 0, 0 }; // turns the axis from z to y

// ---- at rest

static void build_resting(ob_world *w, uint32_t run, const double *variant)
{
	static const struct {
		ob_world_body (*add)(ob_world *w, double mass, double radius, double half, ob_vec3 p);
		double radius, half;
		bool lies;
	} body[] = { { ob_world_cylinder, .5, .5, false },
		     { ob_world_cylinder, .1, .5, false },
		     { ob_world_cylinder, .5, .05, false },
		     { ob_world_cylinder, .2, .5, true },
		     { ob_world_capsule, .2, .4, true } };
	ob_world_ground(w);
	for (int i = 0; i < 10; i++) {
		int k = i / 2;
		double lift = body[k].lies ? body[k].radius : body[k].half;
		bool on_box = i % 2;
		if (on_box)
			ob_world_box(w, 0, ob_v3(1, 1, .25), ob_v3(3 * k, 3, .25));
		ob_world_body b =
			body[k].add(w, 100, body[k].radius, body[k].half, ob_v3(3 * k, 3 * on_box, .5 * on_box + lift));
		if (body[k].lies)
			b.state->pose.q = ob_quat_turn(ob_quat_identity(), onto_side);
	}
}

const ob_case ob_case_round_rest = {
	.row = 37,
	.name = "round-rest",
	.title = "Cylinders and capsules at rest",
	.setup = "Cylinders of three proportions stand, a cylinder and a capsule lie on their sides, on a plane and on "
		 "boxes; "
		 "friction .5; 20 s, awake.",
	.figure = OB_STAND_FIGURE(.1, .1),
	.build = build_resting,
	OB_STAND_CASE,
};

static void build_stack(ob_world *w, uint32_t run, const double *variant)
{
	uint64_t seed = 37 + run;
	ob_world_ground(w);
	for (int i = 0; i < 10; i++) {
		double x = ob_splitmix_within(&seed, -.01, .01), y = ob_splitmix_within(&seed, -.01, .01);
		ob_world_cylinder(w, 785, .5, .5, ob_v3(x, y, .5 + i));
	}
}

const ob_case ob_case_cylinder_stack = {
	.row = 37,
	.name = "cylinder-stack",
	.title = "Stack of 10 cylinders",
	.setup = "Ten cylinders of 1 m and 785 kg, each up to 10 mm off the axis, friction .5, stand for 20 s, awake; "
		 "the "
		 "worst of three such.",
	.figure = OB_STAND_FIGURE(.5, 1),
	.build = build_stack,
	.runs = 3,
	OB_STAND_CASE,
};

// ---- rolling

static const double slope = 20 * M_PI / 180; // rad
enum { CYLINDER = 1, CAPSULE, ROLLERS }; // ids on the plane; the same on the box

static void build_rolling(ob_world *w, uint32_t run, const double *variant)
{
	static const double radius = .2, half = .4;
	ob_quat tilt = ob_world_slope(w, slope).state->pose.q;
	ob_mat3 r = ob_quat_matrix(tilt);
	ob_vec3 down = ob_column(&r, 0), across = ob_column(&r, 1), up = ob_column(&r, 2);
	ob_quat lying = ob_quat_turn(ob_quat_turn(ob_quat_identity(), onto_side), ob_v3(0, slope, 0));
	for (int i = 0; i < 4; i++) {
		ob_vec3 on = ob_scale(across, 3 * i);
		if (i == 2)
			ob_world_box(w, 0, ob_v3(5, 3, .5), ob_madd(ob_madd(ob_scale(across, 7.5), 4, down), .5, up))
				.state->pose.q = tilt;
		if (i >= 2)
			on = ob_madd(on, 1, up);
		ob_world_body b =
			(i % 2 ? ob_world_capsule : ob_world_cylinder)(w, 20, radius, half, ob_madd(on, radius, up));
		b.state->pose.q = lying;
	}
	ob_world_material(w, .5, 0);
}

static void judge_rolling(ob_case_run_state *t)
{
	ob_mat3 r = ob_quat_matrix(t->world->state[0].pose.q);
	for (uint32_t id = 1, i = 0; id < t->world->objects; id++) {
		const ob_passport *p = &t->world->passport[id];
		if (!ob_look_moves(t, id))
			continue;
		double moment = p->inertia.z / (p->mass * p->size.x * p->size.x);
		double a = ob_reference_round_incline(ob_look_gravity(t), slope, moment);
		ob_vec3 exact = ob_scale(ob_column(&r, 0), .5 * a * t->time * t->time);
		double error = ob_norm(ob_sub(ob_look_moved(t, id), exact)) / ob_norm(exact);
		ob_look_keep(&t->figure[i++], error);
	}
	if (ob_look_farthest(t) < .1)
		t->failed = "nothing moved";
}

#define ROUND_ROLL "g sin t^2 / (2 (1 + moment)) (Routh 1905)"

const ob_case ob_case_round_incline = {
	.row = 37,
	.name = "round-incline",
	.title = "Cylinders and capsules roll down",
	.setup = "Cylinders and capsules of .2 m radius roll down a slope of 20 degrees, a plane and a box, friction "
		 ".5; "
		 "1.5 s.",
	.duration = 1.5,
	.figures = 4,
	.figure = { { "error of the way, cylinder on a plane", "1", 1e-3, ROUND_ROLL },
		    { "error of the way, capsule on a plane", "1", 1e-3, ROUND_ROLL },
		    { "error of the way, cylinder on a box", "1", 1e-3, ROUND_ROLL },
		    { "error of the way, capsule on a box", "1", 1e-3, ROUND_ROLL } },
	.build = build_rolling,
	.judge = judge_rolling,
};

// ---- heaps of all shapes, turned at random, in a loose grid of sides x sides

static ob_world_body build_any(ob_world *w, int kind, ob_vec3 p)
{
	switch (kind % 4) {
	case 0:
		return ob_world_box(w, 24, ob_v3(.2, .15, .1), p);
	case 1:
		return ob_world_cylinder(w, 28, .15, .2, p);
	case 2:
		return ob_world_sphere(w, 24, .18, p);
	default:
		return ob_world_capsule(w, 20, .12, .15, p);
	}
}

enum { COUNT, SIDE, FIRST_SEED }; // variant

static void build_mixture(ob_world *w, uint32_t run, const double *variant)
{
	const int count = (int)variant[COUNT], side = (int)variant[SIDE];
	uint64_t seed = (uint64_t)variant[FIRST_SEED] + run;
	const double apart = .6; // m: the longest are .54 m, and are drawn up to .02 m off
	ob_world_ground(w);
	for (int i = 0; i < count; i++) {
		ob_vec3 p = ob_v3(apart * (i % side - .5 * (side - 1)), apart * (i / side % side - .5 * (side - 1)),
				  .5 + apart * (i / side / side));
		p = ob_add(p, ob_splitmix_vector(&seed, .02));
		ob_world_body b = build_any(w, (int)(ob_splitmix(&seed) % 4), p);
		b.state->pose.q = ob_world_random_attitude(&seed);
	}
}

const ob_case ob_case_mixed_pile = {
	.row = 37,
	.name = "mixed-pile",
	.slow = true,
	.title = "Pile of 200 of all shapes",
	.setup = "200 boxes, cylinders, spheres and capsules of .24 to .5 m, turned at random, drop in a loose grid; "
		 "friction "
		 ".5, no restitution; 5 s.",
	.duration = 5,
	.figures = OB_HEAP_FIGURES,
	.figure = { { "settled mean penetration", "mm", .5, "no penetration; in the last second" },
		    { "settled worst penetration", "mm", 1, "no penetration; in the last second" },
		    { "worst penetration at any moment", "mm", 1, "no penetration" },
		    { "growth of energy", "1", 1e-5,
		      "none: largest rise from its lowest so far, over that at the start" } },
	.build = build_mixture,
	.variant = { 200, 6, 200 },
	.observe = ob_heap_observe,
	.judge = ob_heap_judge,
};

// ---- many small ones: frequency of meeting the tolerance

enum { KEPT, WORST };

static void observe_random_heap(ob_case_run_state *t)
{
	ob_look_penetration(t, &t->figure[WORST]);
	ob_look_fail_below(t);
}

static void judge_random_heap(ob_case_run_state *t)
{
	double tolerance = t->settings.tolerance > 0 ? t->settings.tolerance : OB_DEFAULT_TOLERANCE;
	bool moved = ob_look_farthest(t) > .1;
	t->figure[KEPT] = !moved || !(t->figure[WORST] <= 1e3 * tolerance);
	if (!moved && !t->failed)
		t->failed = "nothing moved";
}

const ob_case ob_case_random_heaps = {
	.row = 38,
	.name = "random-heaps",
	.slow = true,
	.title = "A hundred random heaps",
	.setup = "24 boxes, cylinders, spheres and capsules at random drop on the ground, a hundred times; friction "
		 ".5, no "
		 "restitution; 2 s each. Of engines without a tolerance 1 mm is asked.",
	.duration = 2,
	.runs = 100,
	.figures = 2,
	.averaged = 1u << 0,
	.figure = { { "share above the tolerance", "1", .01, "none: deepest that two bodies ever are in each other" },
		    { "worst penetration at any moment", "mm", NAN, "no penetration" } },
	.build = build_mixture,
	.variant = { 24, 3, 3800 },
	.observe = observe_random_heap,
	.judge = judge_random_heap,
};
