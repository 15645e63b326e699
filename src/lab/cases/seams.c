// Over ten seams: fixed boxes side by side, with their upper faces in one plane, act as one floor.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/mechanics.h"
#include "world/world.h"

enum { LANES = 6, TILES = 14, FIRST = LANES * TILES }; // body FIRST + i goes along lane i
static const double tile = .25, mu = .5, speed = 5; // m, m/s

static void build_lanes(ob_world *w)
{
	for (int lane = 0; lane < LANES; lane++)
		for (int i = 0; i < TILES; i++)
			ob_world_box(w, 0, ob_v3(.5 * tile, .6, .1), ob_v3(tile * (i - .5), 2 * lane, -.1));
}

static void build_sliders(ob_world *w, uint32_t run, const double *variant)
{
	build_lanes(w);
	for (int lane = 0; lane < LANES; lane++) {
		ob_vec3 half = lane % 2 ? ob_v3(.2, .15, .05) : ob_v3(.1, .08, .05);
		ob_world_body b = ob_world_box(w, 4, half, ob_v3(.013 * lane, 2 * lane, half.z));
		b.state->v.x = speed;
		b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, .3 * (lane / 2)));
	}
	ob_world_material(w, mu, 0);
}

// Round bodies lie with their axes across the lane, and roll from the start.
static void build_rollers(ob_world *w, uint32_t run, const double *variant)
{
	static const double radius = .1;
	build_lanes(w);
	for (int lane = 0; lane < LANES; lane++) {
		const ob_vec3 at = ob_v3(.013 * lane, 2 * lane, radius);
		const bool sphere = lane / 2 == 0;
		ob_world_body b = sphere          ? ob_world_sphere(w, 4, radius, at)
				  : lane / 2 == 1 ? ob_world_cylinder(w, 4, radius, .2, at)
						  : ob_world_capsule(w, 4, radius, .2, at);
		b.state->v.x = speed;
		b.state->w.y = speed / radius;
		if (!sphere)
			b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(M_PI_2, 0, 0));
	}
	ob_world_material(w, mu, 0);
}

static double hop(const ob_case_run_state *t, int lane)
{
	return 1e3 * ob_look_moved(t, (uint32_t)(FIRST + lane)).z;
}

static double error_of_way(const ob_case_run_state *t, int lane, double exact)
{
	ob_vec3 moved = ob_look_moved(t, (uint32_t)(FIRST + lane));
	return hypot(moved.x - exact, moved.y) / exact;
}

static void fail_below(ob_case_run_state *t)
{
	for (int lane = 0; lane < LANES; lane++)
		if (hop(t, lane) < -50)
			t->failed = "fell through the floor";
}

static void observe_sliders(ob_case_run_state *t)
{
	for (int lane = 0; lane < LANES; lane++)
		ob_look_keep(&t->figure[1], hop(t, lane));
}

static void judge_sliders(ob_case_run_state *t)
{
	for (int lane = 0; lane < LANES; lane++)
		ob_look_keep(&t->figure[0],
			     error_of_way(t, lane, ob_reference_stop_distance(speed, mu, ob_look_gravity(t))));
	fail_below(t);
}

static void observe_rollers(ob_case_run_state *t)
{
	for (int lane = 0; lane < LANES; lane++)
		ob_look_keep(&t->figure[lane / 2 * 2 + 1], hop(t, lane));
}

static void judge_rollers(ob_case_run_state *t)
{
	for (int lane = 0; lane < LANES; lane++)
		ob_look_keep(&t->figure[lane / 2 * 2], error_of_way(t, lane, speed * t->time));
	fail_below(t);
}

#define LEVEL "none: the floor is level"
#define ROLLS "v t: it rolls on (Newton 1687)"
#define SEAM_CASE .row = 34

const ob_case ob_case_seams_slide = {
	.name = "seams-slide",
	.title = "Boxes slide over ten seams",
	.setup = "Boxes of two sizes, turned by three angles, slide at 5 m/s over fixed boxes of .25 m side by side "
		 "until "
		 "they stop; friction .5.",
	.duration = 1.2,
	.figures = 2,
	.figure = { { "worst error of the way", "1", 1e-3, "v^2 / (2 mu g) (Coulomb 1785)" },
		    { "highest hop", "mm", .01, LEVEL } },
	.build = build_sliders,
	.observe = observe_sliders,
	.judge = judge_sliders,
	SEAM_CASE,
};

const ob_case ob_case_seams_roll = {
	.name = "seams-roll",
	.title = "Round ones roll over ten seams",
	.setup = "Spheres, cylinders and capsules of .1 m radius roll at 5 m/s over fixed boxes of .25 m side by side; "
		 "friction .5; .5 s.",
	.duration = .5,
	.figures = 6,
	.figure = { { "error of the way, spheres", "1", 1e-3, ROLLS },
		    { "highest hop, spheres", "mm", .01, LEVEL },
		    { "error of the way, cylinders", "1", 1e-3, ROLLS },
		    { "highest hop, cylinders", "mm", .01, LEVEL },
		    { "error of the way, capsules", "1", 1e-3, ROLLS },
		    { "highest hop, capsules", "mm", .01, LEVEL } },
	.build = build_rollers,
	.observe = observe_rollers,
	.judge = judge_rollers,
	SEAM_CASE,
};
