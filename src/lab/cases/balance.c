// Out of balance by one in a thousand, with sleeping enabled: slow bodies are not at rest.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/mechanics.h"
#include "reference/pivot.h"
#include "world/world.h"

static const double mu = .5, more = 1e-3;
static const ob_vec3 block = { .5, .5, .25 }; // m, half
enum { ON_PLANE = 1, ON_BOX = 3 }; // the blocks' ids, each after its support

static void build_pull(ob_world *w, uint32_t run, const double *variant)
{
	static const double mass = 500;
	ob_world_ground(w);
	for (int i = 0; i < 2; i++) {
		if (i)
			ob_world_box(w, 0, ob_v3(5, 2, .5), ob_v3(0, 10, .5));
		ob_world_body b = ob_world_box(w, mass, block, ob_v3(0, 10 * i, i + block.z));
		b.passport->force.x = (1 + more) * mu * mass * OB_WORLD_GRAVITY;
	}
	ob_world_material(w, mu, 0);
}

static void build_incline(ob_world *w, uint32_t run, const double *variant)
{
	double angle = atan((1 + more) * mu);
	ob_quat q = ob_world_slope(w, angle).state->pose.q;
	ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 up = ob_column(&r, 2), across = ob_column(&r, 1);
	for (int i = 0; i < 2; i++) {
		ob_vec3 on = ob_madd(ob_scale(across, 10 * i), i, up);
		if (i)
			ob_world_box(w, 0, ob_v3(5, 2, .5), ob_madd(on, -.5, up)).state->pose.q = q;
		ob_world_box(w, 500, block, ob_madd(on, block.z, up)).state->pose.q = q;
	}
	ob_world_material(w, mu, 0);
}

// acceleration: m/s^2, of both blocks along x of their support
static void judge_way(ob_case_run_state *t, double acceleration)
{
	ob_mat3 r = ob_quat_matrix(t->world->state[0].pose.q);
	ob_vec3 exact = ob_scale(ob_column(&r, 0), .5 * acceleration * t->time * t->time);
	t->figure[0] = ob_norm(ob_sub(ob_look_moved(t, ON_PLANE), exact)) / ob_norm(exact);
	t->figure[1] = ob_norm(ob_sub(ob_look_moved(t, ON_BOX), exact)) / ob_norm(exact);
	if (ob_look_farthest(t) < .1 * ob_norm(exact))
		t->failed = "nothing moved";
}

static void judge_pull(ob_case_run_state *t)
{
	judge_way(t, more * mu * ob_look_gravity(t));
}

static void judge_incline(ob_case_run_state *t)
{
	judge_way(t, ob_reference_incline(ob_look_gravity(t), atan((1 + more) * mu), mu));
}

#define UNBALANCED_CASE .row = 36, .sleeps = true

const ob_case ob_case_unbalanced_pull = {
	.name = "unbalanced-pull",
	.title = "Pulled 1 in 1000 above friction",
	.setup = "Blocks of 500 kg on a plane and on a box, pulled by 1.001 of what friction holds (.5), may sleep, "
		 "and must "
		 "not; 10 s.",
	.duration = 10,
	.figures = 2,
	.figure = { { "error of the way, on a plane", "1", .01, ".001 mu g t^2 / 2 (Coulomb 1785)" },
		    { "error of the way, on a box", "1", .01, ".001 mu g t^2 / 2 (Coulomb 1785)" } },
	.build = build_pull,
	.judge = judge_pull,
	UNBALANCED_CASE,
};

const ob_case ob_case_unbalanced_incline = {
	.name = "unbalanced-incline",
	.title = "On a slope 1 in 1000 too steep",
	.setup = "Blocks on a plane and on a box whose slope is 1.001 of the friction (.5), may sleep, and must not; "
		 "10 s.",
	.duration = 10,
	.figures = 2,
	.figure = { { "error of the way, on a plane", "1", .01, "g (sin - mu cos) t^2 / 2 (Coulomb 1785)" },
		    { "error of the way, on a box", "1", .01, "g (sin - mu cos) t^2 / 2 (Coulomb 1785)" } },
	.build = build_incline,
	.judge = judge_incline,
	UNBALANCED_CASE,
};

// ---- a brick with its centre just beyond the edge of its table

static const ob_vec3 brick = { .5, .25, .1 }; // m, half

static void build_brick(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_box(w, 0, ob_v3(2, 1, .5), ob_v3(-2, 0, -.5)); // the table: its edge at x = 0
	ob_world_box(w, 10, brick, ob_v3(more * brick.x, 0, brick.z));
	ob_world_material(w, 1, 0);
}

static void judge_brick(ob_case_run_state *t)
{
	double moment = t->world->passport[1].inertia.y / t->world->passport[1].mass;
	double exact = ob_reference_topple(more * brick.x, brick.z, moment, ob_look_gravity(t), t->time);
	ob_mat3 r = ob_quat_matrix(ob_look_at(t, 1).pose.q);
	t->figure[0] = fabs(atan2(r.m[0][2], r.m[2][2]) / exact - 1);
	if (t->figure[0] > .99)
		t->failed = "stands";
}

const ob_case ob_case_unbalanced_brick = {
	.name = "unbalanced-brick",
	.slow = true,
	.title = "Brick 1 in 1000 over the edge",
	.setup = "A brick of 1 x .5 x .2 m reaches 1.001 of half its length over a table's edge, may sleep, and must "
		 "not: "
		 "its tilt after 1.4 s.",
	.duration = 1.4,
	.figures = 1,
	.figure = { { "error of the tilt", "1", .01, "it turns about the edge (Newton 1687), integrated" } },
	.build = build_brick,
	.judge = judge_brick,
	UNBALANCED_CASE,
};
