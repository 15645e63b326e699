// Free flight without contacts.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/mechanics.h"
#include "world/world.h"

static void build_projectile(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_body b = ob_world_box(w, 48, ob_v3(.3, .2, .1), ob_v3(0, 0, 5));
	b.state->v = ob_v3(10, 0, 10);
	b.state->w = ob_v3(1, 2, 3);
}

static void observe_projectile(ob_case_run_state *t)
{
	const ob_state *start = t->world->state;
	ob_vec3 exact = ob_reference_parabola(start->pose.p, start->v, t->world->gravity, t->time);
	ob_look_keep(&t->figure[0], ob_norm(ob_sub(ob_look_at(t, 0).pose.p, exact)));
}

static void judge_projectile(ob_case_run_state *t)
{
	if (ob_look_farthest(t) < 1e-6)
		t->failed = "nothing moved";
}

const ob_case ob_case_projectile = {
	.row = 1,
	.name = "projectile",
	.title = "Projectile",
	.setup = "A box of .6 x .4 x .2 m is thrown at (10, 0, 10) m/s, tumbling at (1, 2, 3) rad/s, and watched for "
		 "2 s.",
	.others = "MuJoCo with Runge-Kutta 4: 1e-10 m; Box3D 41 mm; Jolt, Bullet and ODE 163 mm",
	.duration = 2,
	.figures = 1,
	.figure = { { "worst error of position", "m", 1e-12, "parabola (Galilei 1638)" } },
	.build = build_projectile,
	.observe = observe_projectile,
	.judge = judge_projectile,
};
