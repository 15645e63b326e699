// Mechanisms: a bridge of planks, ragdolls, a car.
#include <stdlib.h>

#include "lab/cases/cases.h"
#include "base/random.h"
#include "lab/look.h"
#include "world/world.h"

static const double g = OB_WORLD_GRAVITY;
static const ob_quat y_axis = { M_SQRT1_2, -M_SQRT1_2, 0, 0 }; // a joint's z axis along y

static void hold_rate(ob_joint_passport *j, double rate, double most)
{
	j->flags |= OB_JOINT_DRIVEN;
	j->axis.motor = OB_MOTOR_RATE, j->axis.target = rate, j->axis.most = most;
}

// ---- a bridge of planks, a box on the middle one

enum { PLANKS = 9, MIDDLE = PLANKS / 2 };
static const double plank = .5, plank_half = .03, plank_span = 4.3; // m
static const double plank_mass = 2, bridge_load = 10; // kg

// Angle of plank k from the middle, hanging with this tension along x: its ends pull at it along its own line.
static double plank_angle(double load, double tension, int k)
{
	return k ? atan2(.5 * (load + plank_mass) * g + (k - .5) * plank_mass * g, tension) : 0;
}

static double bridge_width(double load, double tension)
{
	double sum = plank;
	for (int k = 1; k <= MIDDLE; k++)
		sum += 2 * plank * cos(plank_angle(load, tension, k));
	return sum;
}

// Tension (N) along x at rest, by bisection.
static double bridge_tension(double load)
{
	double low = 1, high = 1e6;
	for (int i = 0; i < 200; i++) {
		const double half = .5 * (low + high);
		*(bridge_width(load, half) < plank_span ? &low : &high) = half;
	}
	return low;
}

// Centre and slope of plank i at rest.
static ob_vec3 plank_at(double load, uint32_t i, double *slope)
{
	const double tension = bridge_tension(load);
	const int k = abs((int)i - MIDDLE), side = (int)i < MIDDLE ? -1 : 1;
	double x = 0, z = 0;
	for (int n = MIDDLE; n > k; n--)
		z -= plank * sin(plank_angle(load, tension, n));
	for (int n = 0; n < k; n++)
		x += (n ? 1 : .5) * plank * cos(plank_angle(load, tension, n));
	const double angle = plank_angle(load, tension, k);
	*slope = -side * angle;
	return ob_v3(side * (k ? x + .5 * plank * cos(angle) : 0), 0, z - .5 * plank * sin(angle));
}

static void build_bridge(ob_world *w, uint32_t run)
{
	for (uint32_t i = 0; i <= PLANKS; i++) {
		double slope = 0;
		const ob_vec3 at = i < PLANKS ? plank_at(0, i, &slope) : ob_v3(0, 0, 0);
		const ob_vec3 along = ob_scale(ob_v3(cos(slope), 0, -sin(slope)), .5 * plank);
		if (i < PLANKS) {
			ob_world_body b = ob_world_box(w, plank_mass, ob_v3(.48 * plank, .3, plank_half), at);
			b.state->pose.q = (ob_quat){ cos(slope / 2), 0, sin(slope / 2), 0 };
		}
		ob_joint_passport *j = i == PLANKS ? ob_world_join(w, OB_JOINT_HINGE, PLANKS - 1, OB_JOINT_WORLD,
								   (ob_pose){ { .5 * plank_span, 0, 0 }, y_axis })
						   : ob_world_join(w, OB_JOINT_HINGE, i, i ? i - 1 : OB_JOINT_WORLD,
								   (ob_pose){ ob_sub(at, along), y_axis });
		j->flags |= OB_JOINT_DRIVEN;
		j->axis.damping = 20;
	}
	double level;
	const double top = plank_at(0, MIDDLE, &level).z + plank_half;
	ob_world_box(w, bridge_load, ob_v3(.15, .15, .15), ob_v3(0, 0, top + .15));
}

static void observe_bridge(ob_case_run_state *t)
{
	double slope, off = 0;
	for (uint32_t i = 0; i < PLANKS; i++)
		off = fmax(off, ob_norm(ob_sub(ob_look_at(t, i).pose.p, plank_at(bridge_load, i, &slope))));
	t->figure[0] = off; // at the end
	ob_look_keep(&t->figure[1], ob_look_parted(t));
	ob_look_penetration(t, &t->figure[2]);
}

const ob_case ob_case_plank_bridge = {
	.row = 54,
	.name = "plank-bridge",
	.title = "Bridge of planks under a load",
	.setup = "Nine planks of 2 kg hang by damped hinges between two walls; a box of 10 kg is put on the middle "
		 "one. Where they "
		 "are after 20 s.",
	.duration = 20,
	.figures = 3,
	.figure = { { "error of position", "m", 1e-4, "moments of each plank about its centre" },
		    { "gap of a joint", "m", 1e-9, "its two places are one" },
		    { "worst penetration", "mm", 1, "none" } },
	.build = build_bridge,
	.observe = observe_bridge,
	.judge = ob_look_fail_still,
};

// ---- ragdolls that come to rest

static void build_ragdoll(ob_world *w, uint32_t run)
{
	static const double height[] = { .8, .8, 2.2 }, lean[] = { .8, 1.2, 2.8 };
	ob_world_ragdoll(w, ob_v3(0, 0, height[run]), lean[run]);
	ob_world_ground(w);
}

static void observe_ragdoll(ob_case_run_state *t)
{
	double fastest = 0;
	for (uint32_t i = 0; i + 1 < t->world->objects; i++) {
		const ob_state x = ob_look_at(t, i);
		fastest = fmax(fastest, ob_norm(x.v));
	}
	t->figure[0] = fastest; // at the end
	ob_look_keep(&t->figure[1], ob_look_parted(t));
	ob_look_penetration(t, &t->figure[2]);
}

const ob_case ob_case_ragdoll = {
	.row = 55,
	.name = "ragdoll",
	.title = "Ragdolls that fall",
	.setup = "Three ragdolls with limits and dry friction in their joints fall on the ground; 6 s.",
	.sleeps = true,
	.duration = 6,
	.runs = 3,
	.figures = 3,
	.figure = { { "speed at the end", "m/s", 1e-9, "they lie at rest, and sleep" },
		    { "gap of a joint", "m", 1e-9, "its two places are one" },
		    { "worst penetration", "mm", 1, "none" } },
	.build = build_ragdoll,
	.observe = observe_ragdoll,
	.judge = ob_look_fail_still,
};

// ---- a car over bars of unlike height, across its way

enum { WHEELS = 4, BARS = 10 };
static const double wheel = .25, wheel_rate = 6; // m, rad/s

static void build_car(ob_world *w, uint32_t run)
{
	uint64_t seed = 3;
	ob_world_box(w, 60, ob_v3(.8, .3, .12), ob_v3(0, 0, wheel + .1));
	for (int k = 0; k < WHEELS; k++) {
		const ob_vec3 at = ob_v3(k & 1 ? .6 : -.6, k & 2 ? .4 : -.4, wheel);
		const uint32_t id = w->objects;
		ob_world_body b = ob_world_cylinder(w, 6, wheel, .07, at);
		b.state->pose.q = y_axis;
		hold_rate(ob_world_join(w, OB_JOINT_HINGE, id, 0, (ob_pose){ at, y_axis }), wheel_rate, 40);
	}
	ob_world_ground(w);
	for (int i = 0; i < BARS; i++) {
		const double half = ob_splitmix_within(&seed, .01, .03);
		ob_world_box(w, 0, ob_v3(.05, 2, half), ob_v3(1.6 + .5 * i, 0, half));
	}
	ob_world_material(w, .8, 0);
}

static void observe_car(ob_case_run_state *t)
{
	ob_look_keep(&t->figure[0], fabs(ob_look_at(t, 0).pose.p.y));
	ob_look_keep(&t->figure[1], ob_look_parted(t));
	ob_look_penetration(t, &t->figure[2]);
}

static void judge_car(ob_case_run_state *t)
{
	if (!(ob_look_moved(t, 0).x > 5))
		t->failed = "did not get over the bars";
}

const ob_case ob_case_car = {
	.row = 56,
	.name = "car",
	.title = "Car over a rough floor",
	.setup = "A car of 84 kg whose four wheels have motors drives over ten bars of 2 to 6 cm; 8 s. All is the same "
		 "on its left and "
		 "on its right.",
	.duration = 8,
	.figures = 3,
	.figure = { { "way aside", "m", .01, "none, by symmetry; contacts are solved one after the other" },
		    { "gap of a joint", "m", 1e-9, "its two places are one" },
		    { "worst penetration", "mm", 1, "none" } },
	.build = build_car,
	.observe = observe_car,
	.judge = judge_car,
};
