// Bodies that joints hold: pendulums, a top, a chain, linkages, beside Lagrange's equations and closed forms.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/integrator.h"
#include "world/world.h"

static const double g = OB_WORLD_GRAVITY;
static const ob_quat y_axis = { M_SQRT1_2, -M_SQRT1_2, 0, 0 }; // a joint's z axis along y
static const ob_quat x_axis = { M_SQRT1_2, 0, M_SQRT1_2, 0 };

// Turns the frame of two angles of the plane into a place: x to the right, z up, the angle from straight down.
static ob_vec3 hanging(ob_vec3 from, double length, double angle)
{
	return ob_madd(from, length, ob_v3(sin(angle), 0, -cos(angle)));
}

// Lets the reference go on in t->memory up to now, from one frame to the next.
static const double *follow(ob_case_run_state *t, const ob_reference_system *s, const double *start)
{
	double *y = t->memory, *time = t->memory + OB_REFERENCE_STATES;
	for (size_t i = 0; i < s->states && t->frame == 0; i++)
		y[i] = start[i];
	if (t->time > *time)
		ob_reference_integrate(s, t->time - *time, y);
	*time = t->time;
	return y;
}

// ---- pendulum: a ball of 1 kg and .1 m, 1 m below a hinge

enum { BOB_MASS = 1 };
static const double bob_radius = .1;

static double bob_moment(void)
{
	return .4 * BOB_MASS * bob_radius * bob_radius;
}

static void build_pendulum(ob_world *w, uint32_t run, const double *variant)
{
	const ob_world_body bob =
		ob_world_sphere(w, BOB_MASS, bob_radius, hanging(ob_v3(0, 0, 0), 1, variant[0] * M_PI / 180));
	ob_world_join(w, OB_JOINT_HINGE, bob.passport->id, OB_JOINT_WORLD, (ob_pose){ { 0, 0, 0 }, y_axis });
}

static void swing(const double *y, double *rate, const void *with)
{
	rate[0] = y[1];
	rate[1] = -BOB_MASS * g / (BOB_MASS + bob_moment()) * sin(y[0]);
}

static void observe_pendulum(ob_case_run_state *t)
{
	static const ob_reference_system system = { .states = 2, .rate = swing, .tolerance = 1e-13 };
	const double *y = follow(t, &system, (double[]){ t->of->variant[0] * M_PI / 180, 0 });
	ob_look_keep(&t->figure[0], ob_norm(ob_sub(ob_look_at(t, 0).pose.p, hanging(ob_v3(0, 0, 0), 1, y[0]))));
	ob_look_keep(&t->figure[1], ob_look_parted(t));
}

#define PENDULUM(target) \
	{ "error of position", "m", target, \
	  "the pendulum's equation (Huygens 1673), Dormand and Prince's method to 1e-13" }, \
	{ \
		"gap of a joint", "m", 1e-9, "its two places are one" \
	}

const ob_case ob_case_pendulum_90 = {
	.row = 44,
	.name = "pendulum-90",
	.title = "Pendulum of 90 degrees",
	.setup = "A ball 1 m below a hinge is let go level; 20 s.",
	.compared = true,
	.duration = 20,
	.variant = { 90 },
	.figures = 2,
	.figure = { PENDULUM(1e-5) },
	.build = build_pendulum,
	.observe = observe_pendulum,
	.judge = ob_look_fail_still,
};

const ob_case ob_case_pendulum_179 = {
	.row = 44,
	.name = "pendulum-179",
	.title = "Pendulum of 179 degrees",
	.setup = "The same, let go 1 degree from straight up; 20 s.",
	.duration = 20,
	.variant = { 179 },
	.figures = 2,
	.figure = { PENDULUM(1e-3) },
	.build = build_pendulum,
	.observe = observe_pendulum,
	.judge = ob_look_fail_still,
};

// ---- double pendulum: two such balls, each 1 m from the joint above; the lower hangs at the upper one's centre

static void build_double(ob_world *w, uint32_t run, const double *variant)
{
	const ob_vec3 first = ob_v3(1, 0, 0);
	ob_world_sphere(w, BOB_MASS, bob_radius, first);
	ob_world_sphere(w, BOB_MASS, bob_radius, ob_add(first, ob_v3(1, 0, 0)));
	ob_world_join(w, OB_JOINT_HINGE, 0, OB_JOINT_WORLD, (ob_pose){ { 0, 0, 0 }, y_axis });
	ob_world_join(w, OB_JOINT_HINGE, 1, 0, (ob_pose){ first, y_axis });
}

static void swing_twice(const double *y, double *rate, const void *with)
{
	const double m = BOB_MASS, upper = 2 * m + bob_moment(), lower = m + bob_moment(), c = m * cos(y[0] - y[1]),
		     s = m * sin(y[0] - y[1]), det = upper * lower - c * c,
		     f = -s * y[3] * y[3] - 2 * m * g * sin(y[0]), h = s * y[2] * y[2] - m * g * sin(y[1]);
	rate[0] = y[2], rate[1] = y[3];
	rate[2] = (lower * f - c * h) / det;
	rate[3] = (upper * h - c * f) / det;
}

static void observe_double(ob_case_run_state *t)
{
	static const ob_reference_system system = { .states = 4, .rate = swing_twice, .tolerance = 1e-13 };
	const double *y = follow(t, &system, (double[]){ M_PI / 2, M_PI / 2, 0, 0 });
	const ob_vec3 end = hanging(hanging(ob_v3(0, 0, 0), 1, y[0]), 1, y[1]);
	ob_look_keep(&t->figure[0], ob_norm(ob_sub(ob_look_at(t, 1).pose.p, end)));
	ob_look_keep(&t->figure[1], ob_look_parted(t));
}

const ob_case ob_case_double_pendulum = {
	.row = 45,
	.name = "double-pendulum",
	.title = "Double pendulum",
	.setup = "Two balls on two arms of 1 m are let go level; 4 s, before its chaos hides all errors.",
	.compared = true,
	.duration = 4,
	.figures = 2,
	.figure = { { "error of position", "m", 1e-4, "Lagrange's equations, Dormand and Prince's method to 1e-13" },
		    { "gap of a joint", "m", 1e-9, "its two places are one" } },
	.build = build_double,
	.observe = observe_double,
	.judge = ob_look_fail_still,
};

// ---- bodies that turn about a point: a spherical pendulum, and a heavy top

// Symmetric body: its angular momenta about the vertical and its axis are constant (Lagrange 1788).
typedef struct turning {
	double across, about; // moments about the point and the axis, kg m^2
	double pull; // moment of its weight at 90 degrees, N m; negative: the centre hangs
	double vertical, axial; // angular momenta, N m s
} turning;

// y: angle of the axis from straight up, its rate, and the angle about the vertical.
static void turn(const double *y, double *rate, const void *with)
{
	const turning *b = with;
	const double s = sin(y[0]), c = cos(y[0]), precession = (b->vertical - b->axial * c) / (b->across * s * s);
	rate[0] = y[1];
	rate[1] = (b->across * precession * precession * s * c - b->axial * precession * s + b->pull * s) / b->across;
	rate[2] = precession;
}

static void observe_turning(ob_case_run_state *t, const turning *b, double angle, double length)
{
	const ob_reference_system system = { .states = 3, .rate = turn, .tolerance = 1e-13, .with = b };
	const double *y = follow(t, &system, (double[]){ angle, 0, 0 });
	const ob_vec3 at = ob_v3(length * sin(y[0]) * cos(y[2]), length * sin(y[0]) * sin(y[2]), length * cos(y[0]));
	ob_look_keep(&t->figure[0], ob_norm(ob_sub(ob_look_at(t, 0).pose.p, at)));
	ob_look_keep(&t->figure[1], ob_look_parted(t));
}

static const double cone = 2 * M_PI / 3, round_rate = 2; // rad from straight up; rad/s about the vertical

static void build_spherical(ob_world *w, uint32_t run, const double *variant)
{
	const ob_vec3 n = ob_v3(sin(cone), 0, cos(cone)), up = ob_v3(0, 0, round_rate);
	ob_world_body bob = ob_world_sphere(w, BOB_MASS, bob_radius, n);
	bob.state->w = ob_madd(up, -ob_dot(up, n), n);
	bob.state->v = ob_cross(bob.state->w, n);
	ob_world_join(w, OB_JOINT_BALL, 0, OB_JOINT_WORLD, (ob_pose){ { 0, 0, 0 }, ob_quat_identity() });
}

static void observe_spherical(ob_case_run_state *t)
{
	const double across = BOB_MASS + bob_moment(), s = sin(cone);
	const turning b = { across, bob_moment(), BOB_MASS * g, across * s * s * round_rate, 0 };
	observe_turning(t, &b, cone, 1);
}

const ob_case ob_case_spherical_pendulum = {
	.row = 46,
	.name = "spherical-pendulum",
	.title = "Spherical pendulum",
	.setup = "A ball 1 m from a ball joint, 60 degrees from straight down, goes round at 2 rad/s; 20 s.",
	.duration = 20,
	.figures = 2,
	.figure = { { "error of position", "m", 1e-5, "Lagrange's equations, Dormand and Prince's method to 1e-13" },
		    { "gap of a joint", "m", 1e-9, "its two places are one" } },
	.build = build_spherical,
	.observe = observe_spherical,
	.judge = ob_look_fail_still,
};

// A disk of 1 kg, .1 m in radius, .2 m from its point along its axis, which leans by 30 degrees.
enum { TOP_SPIN = 100 }; // rad/s
static const double top_angle = M_PI / 6, top_length = .2, top_radius = .1, top_half = .01;

static void build_top(ob_world *w, uint32_t run, const double *variant)
{
	const ob_vec3 n = ob_v3(sin(top_angle), 0, cos(top_angle));
	ob_world_body disk = ob_world_cylinder(w, 1, top_radius, top_half, ob_scale(n, top_length));
	disk.state->pose.q = (ob_quat){ cos(top_angle / 2), 0, sin(top_angle / 2), 0 };
	disk.state->w = ob_scale(n, TOP_SPIN);
	ob_world_join(w, OB_JOINT_BALL, 0, OB_JOINT_WORLD, (ob_pose){ { 0, 0, 0 }, ob_quat_identity() });
}

static void observe_top(ob_case_run_state *t)
{
	const ob_vec3 i = t->world->passport[0].inertia;
	const double axial = i.z * TOP_SPIN;
	const turning b = { i.x + top_length * top_length, i.z, g * top_length, axial * cos(top_angle), axial };
	observe_turning(t, &b, top_angle, top_length);
}

const ob_case ob_case_top = {
	.row = 47,
	.name = "top",
	.title = "Heavy top",
	.setup = "A disk on a rod of .2 m that leans by 30 degrees spins at 100 rad/s, let go at rest otherwise: it "
		 "precesses, "
		 "and nods; 10 s.",
	.compared = true,
	.duration = 10,
	.figures = 2,
	.figure = { { "error of position", "m", 1e-5, "Lagrange's equations, Dormand and Prince's method to 1e-13" },
		    { "gap of a joint", "m", 1e-9, "its two places are one" } },
	.build = build_top,
	.observe = observe_top,
	.judge = ob_look_fail_still,
};

// ---- a chain of 100 links of .1 m and .01 kg with 10 kg at its end

enum { LINKS = 100 };
static const double chain_lean = .2; // rad

static void build_chain(ob_world *w, uint32_t run, const double *variant)
{
	const double link = .1, lean = chain_lean;
	ob_vec3 at = ob_v3(0, 0, 0);
	for (uint32_t i = 0; i < LINKS; i++) {
		ob_world_body b = ob_world_capsule(w, .01, .01, .04, hanging(at, link / 2, lean));
		b.state->pose.q = (ob_quat){ cos(lean / 2), 0, -sin(lean / 2), 0 };
		ob_world_join(w, OB_JOINT_BALL, i, i ? i - 1 : OB_JOINT_WORLD, (ob_pose){ at, ob_quat_identity() });
		at = hanging(at, link, lean);
	}
	ob_world_sphere(w, 10, .1, hanging(at, .1, lean));
	ob_world_join(w, OB_JOINT_BALL, LINKS, LINKS - 1, (ob_pose){ at, ob_quat_identity() });
}

// Energy is a measure of the motion that needs no reference: it falls from the start to the lowest place by the swing's.
static void observe_chain(ob_case_run_state *t)
{
	const double length = .1 * LINKS,
		     lift = g * (1 - cos(chain_lean)) * (10 * (length + .1) + .01 * LINKS * length / 2);
	const double energy = ob_look_energy(t);
	if (t->frame == 0)
		t->memory[0] = energy;
	ob_look_keep(&t->figure[0], fabs(energy - t->memory[0]) / lift);
	ob_look_keep(&t->figure[1], ob_look_parted(t));
}

const ob_case ob_case_chain_100 = {
	.row = 48,
	.name = "chain-100",
	.title = "Chain of 100 under a load",
	.setup = "100 links of .01 kg with 10 kg at the end swing from 11 degrees; 2 s.",
	.slow = true,
	.compared = true,
	.duration = 2,
	.figures = 2,
	.figure = { { "error of energy", "1", 1e-4, "constant; over that of the swing" },
		    { "gap of a joint", "m", 1e-9, "its two places are one" } },
	.build = build_chain,
	.observe = observe_chain,
	.judge = ob_look_fail_still,
};

// ---- linkages

static const double crank = .5, rod = 1.3; // m
enum { CRANK_RATE = 5 }; // rad/s

static void hold_rate(ob_joint_passport *j, double rate)
{
	j->flags |= OB_JOINT_DRIVEN;
	j->axis.motor = OB_MOTOR_RATE, j->axis.target = rate, j->axis.most = INFINITY;
}

static ob_vec3 middle(ob_vec3 a, ob_vec3 b)
{
	return ob_scale(ob_add(a, b), .5);
}

static const ob_vec3 rocker_foot = { 3, 0, 0 };

// Joint of coupler (3 m) and rocker (2.5 m), with the crank's end at b: where two circles meet.
static ob_vec3 rocker_end(ob_vec3 b)
{
	const ob_vec3 to = ob_sub(rocker_foot, b);
	const double far = ob_norm(to), along = (9 - 6.25 + far * far) / (2 * far), above = sqrt(9 - along * along);
	return ob_madd(ob_madd(b, along / far, to), above / far, ob_v3(-to.z, 0, to.x));
}

// Hinges in one plane: rows across it are there several times.
static void build_four_bar(ob_world *w, uint32_t run, const double *variant)
{
	const ob_vec3 a = ob_v3(0, 0, 0), b = ob_v3(0, 0, 1), c = rocker_end(b), d = rocker_foot;
	ob_world_sphere(w, 1, .1, middle(a, b));
	ob_world_sphere(w, 1, .1, middle(b, c));
	ob_world_sphere(w, 1, .1, middle(c, d));
	hold_rate(ob_world_join(w, OB_JOINT_HINGE, 0, OB_JOINT_WORLD, (ob_pose){ a, y_axis }), CRANK_RATE);
	ob_world_join(w, OB_JOINT_HINGE, 0, 1, (ob_pose){ b, y_axis });
	ob_world_join(w, OB_JOINT_HINGE, 1, 2, (ob_pose){ c, y_axis });
	ob_world_join(w, OB_JOINT_HINGE, 2, OB_JOINT_WORLD, (ob_pose){ d, y_axis });
}

static void observe_four_bar(ob_case_run_state *t)
{
	const double angle = CRANK_RATE * t->time;
	const ob_vec3 at = middle(rocker_end(ob_v3(sin(angle), 0, cos(angle))), rocker_foot);
	ob_look_keep(&t->figure[0], ob_norm(ob_sub(ob_look_at(t, 2).pose.p, at)));
	ob_look_keep(&t->figure[1], ob_look_parted(t));
}

const ob_case ob_case_four_bar = {
	.row = 49,
	.name = "four-bar",
	.title = "Four-bar linkage",
	.setup = "A crank of 1 m at 5 rad/s moves a coupler and a rocker by hinges that are all parallel, so rows "
		 "depend on each "
		 "other; 60 s.",
	.compared = true,
	.duration = 60,
	.figures = 2,
	.figure = { { "error of the rocker's position", "m", 1e-9, "where two circles meet" },
		    { "gap of a joint", "m", 1e-9, "its two places are one" } },
	.build = build_four_bar,
	.observe = observe_four_bar,
	.judge = ob_look_fail_still,
};

static void build_slider_crank(ob_world *w, uint32_t run, const double *variant)
{
	const ob_vec3 a = ob_v3(0, 0, 0), b = ob_v3(crank, 0, 0), c = ob_v3(crank + rod, 0, 0);
	ob_world_sphere(w, 1, .1, middle(a, b));
	ob_world_sphere(w, 1, .1, middle(b, c));
	ob_world_box(w, 2, ob_v3(.1, .1, .1), c);
	hold_rate(ob_world_join(w, OB_JOINT_HINGE, 0, OB_JOINT_WORLD, (ob_pose){ a, y_axis }), -CRANK_RATE);
	ob_world_join(w, OB_JOINT_HINGE, 0, 1, (ob_pose){ b, y_axis });
	ob_world_join(w, OB_JOINT_BALL, 1, 2, (ob_pose){ c, ob_quat_identity() });
	ob_world_join(w, OB_JOINT_SLIDER, 2, OB_JOINT_WORLD, (ob_pose){ c, x_axis });
	const double up = CRANK_RATE * crank; // m/s, of the crank's end
	w->state[0].w = ob_v3(0, -CRANK_RATE, 0), w->state[0].v = ob_v3(0, 0, up / 2);
	w->state[1].w = ob_v3(0, up / rod, 0), w->state[1].v = ob_v3(0, 0, up / 2);
}

static void observe_slider_crank(ob_case_run_state *t)
{
	const double angle = CRANK_RATE * t->time, z = crank * sin(angle);
	ob_look_keep(&t->figure[0], fabs(ob_look_at(t, 2).pose.p.x - crank * cos(angle) - sqrt(rod * rod - z * z)));
	ob_look_keep(&t->figure[1], ob_look_parted(t));
}

const ob_case ob_case_slider_crank = {
	.row = 50,
	.name = "slider-crank",
	.title = "Slider-crank",
	.setup = "A motor turns a crank of .5 m at 5 rad/s; a rod of 1.3 m moves a block on a slide; 20 s.",
	.compared = true,
	.duration = 20,
	.figures = 2,
	.figure = { { "error of the block's position", "m", 1e-9, "r cos + sqrt(l^2 - r^2 sin^2)" },
		    { "gap of a joint", "m", 1e-9, "its two places are one" } },
	.build = build_slider_crank,
	.observe = observe_slider_crank,
	.judge = ob_look_fail_still,
};

// ---- Furuta's pendulum: a motor turns an arm about the vertical, at whose end a pendulum swings across it

static const double arm = .5, torque = .4; // m, N m

static void build_furuta(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_box(w, 2, ob_v3(arm, .05, .05), ob_v3(0, 0, 0));
	ob_world_sphere(w, BOB_MASS, bob_radius, ob_v3(arm, 0, -1));
	ob_joint_passport *j =
		ob_world_join(w, OB_JOINT_HINGE, 0, OB_JOINT_WORLD, (ob_pose){ { 0, 0, 0 }, ob_quat_identity() });
	j->flags |= OB_JOINT_DRIVEN;
	j->axis.motor = OB_MOTOR_RATE, j->axis.target = 1e3, j->axis.most = torque;
	ob_world_join(w, OB_JOINT_HINGE, 1, 0, (ob_pose){ { arm, 0, 0 }, x_axis });
}

// y: angles of the arm and of the pendulum from straight down, and their rates.
static void turn_furuta(const double *y, double *rate, const void *moment)
{
	const double m = BOB_MASS, s = sin(y[1]), c = cos(y[1]), i = bob_moment(),
		     across = *(const double *)moment + m * arm * arm + m * s * s + i, both = m * arm * c, own = m + i,
		     det = across * own - both * both,
		     f = torque - 2 * m * s * c * y[2] * y[3] + m * arm * s * y[3] * y[3],
		     h = m * s * c * y[2] * y[2] - m * g * s;
	rate[0] = y[2], rate[1] = y[3];
	rate[2] = (own * f - both * h) / det;
	rate[3] = (across * h - both * f) / det;
}

static void observe_furuta(ob_case_run_state *t)
{
	const double moment = t->world->passport[0].inertia.z;
	const ob_reference_system system = { .states = 4, .rate = turn_furuta, .tolerance = 1e-13, .with = &moment };
	const double *y = follow(t, &system, (double[]){ 0, 0, 0, 0 });
	const ob_vec3 out = ob_v3(cos(y[0]), sin(y[0]), 0), along = ob_v3(-sin(y[0]), cos(y[0]), 0);
	const ob_vec3 at = ob_add(ob_madd(ob_scale(out, arm), sin(y[1]), along), ob_v3(0, 0, -cos(y[1])));
	ob_look_keep(&t->figure[0], ob_norm(ob_sub(ob_look_at(t, 1).pose.p, at)));
	ob_look_keep(&t->figure[1], ob_look_parted(t));
}

const ob_case ob_case_furuta = {
	.row = 51,
	.name = "furuta",
	.title = "Furuta's pendulum under a motor",
	.setup = "A torque of .4 N m turns an arm of .5 m about the vertical; at its end hangs a pendulum of 1 m; 5 s.",
	.duration = 5,
	.figures = 2,
	.figure = { { "error of position", "m", 1e-5, "Lagrange's equations, Dormand and Prince's method to 1e-13" },
		    { "gap of a joint", "m", 1e-9, "its two places are one" } },
	.build = build_furuta,
	.observe = observe_furuta,
	.judge = ob_look_fail_still,
};
