// Bodies that move evenly on two others, or on one that gives way: accelerations in closed form, kept to rounding,
// since a few contacts are solved to the end. A sphere that rolls in a groove, a block that slides down a wedge that
// slides away, a cylinder that rolls on a plank that is pulled.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const double g = 9.81;

static ob_quat turn_about(ob_vec3 axis, double angle)
{
	return ob_quat_turn(ob_quat_identity(), ob_scale(axis, angle));
}

// Two faces at "half" to the level make a groove that falls by "slope": a sphere that touches both at r cos(half) from
// the axis that it turns about rolls at g sin(slope) / (1 + 2/5 / cos^2(half)), by the balance of moments about the
// line of contact (Routh 1905).
static void check_groove(double half, double slope)
{
	const double r = .1, time = 2, height = r / cos(half);
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(g * sin(slope), 0, -g * cos(slope));
	for (int side = -1; side <= 1; side += 2) {
		const ob_vec3 normal = ob_v3(0, -side * sin(half), cos(half)),
			      outwards = ob_v3(0, side * cos(half), sin(half));
		ob_world_body wall =
			ob_world_box(&s->world, 0, ob_v3(20, 1, .1), ob_sub(outwards, ob_scale(normal, .1)));
		wall.state->pose.q = turn_about(ob_v3(1, 0, 0), side * half);
	}
	ob_world_sphere(&s->world, 1, r, ob_v3(-15, 0, height));
	ob_world_material(&s->world, 1.5, 0);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, time);
	const ob_state ball = little_state(&l, 2);
	const double speed = time * g * sin(slope) / (1 + .4 / (cos(half) * cos(half)));
	printf("groove of %g: speed off by %.1e, %.1e m aside\n", half, ball.v.x / speed - 1, ball.pose.p.y);
	CHECK_NEAR(ball.v.x / speed, 1, 1e-9);
	CHECK_NEAR(ball.pose.p.y, 0, 1e-9);
	CHECK_NEAR(ball.pose.p.z, height, 1e-9);
	little_close(&l);
	free(s);
}

// A block on a wedge on a table, all smooth: the wedge goes away at m g sin cos / (M + m sin^2), and the block down the
// wedge at (M + m) g sin / (M + m sin^2).
static void check_wedge(double angle)
{
	const double block = 1, wedge = 3, time = .6, length = 4, half = .1, s1 = sin(angle), c1 = cos(angle);
	const ob_vec3 normal = ob_v3(s1, 0, c1), down = ob_v3(c1, 0, -s1), top = ob_v3(0, 0, length * tan(angle));
	ob_vec3 corner[6];
	for (int side = 0; side < 2; side++) {
		corner[3 * side] = ob_v3(0, 2 * side - 1, 0);
		corner[3 * side + 1] = ob_v3(length, 2 * side - 1, 0);
		corner[3 * side + 2] = ob_v3(0, 2 * side - 1, top.z);
	}
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_hull(&s->world, wedge, corner, 6, ob_v3(0, 0, 0));
	ob_world_body b =
		ob_world_box(&s->world, block, ob_v3(.2, .2, half), ob_madd(ob_madd(top, .8, down), half, normal));
	b.state->pose.q = turn_about(ob_v3(0, 1, 0), angle);
	ob_world_material(&s->world, 0, 0);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, time);
	const double away = -block * g * s1 * c1 / (wedge + block * s1 * s1),
		     along = (wedge + block) * g * s1 / (wedge + block * s1 * s1);
	const double wedge_off = little_state(&l, 1).v.x / (time * away) - 1,
		     block_off = little_state(&l, 2).v.x / (time * (away + along * c1)) - 1;
	printf("wedge of %g: its speed off by %.1e, the block's by %.1e\n", angle, wedge_off, block_off);
	CHECK_NEAR(wedge_off, 0, 1e-9);
	CHECK_NEAR(block_off, 0, 1e-9);
	little_close(&l);
	free(s->world.hull);
	free(s);
}

// A plank on a smooth table is pulled by F, a solid cylinder rolls on it: the plank goes at F / (M + m / 3), the
// cylinder at a third of that.
static void check_plank(void)
{
	const double force = 6, plank = 2, roller = 1.5, r = .2, pull = force / (plank + roller / 3);
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world).passport->friction = 0;
	ob_world_body b = ob_world_box(&s->world, plank, ob_v3(5, .5, .05), ob_v3(0, 0, .05));
	b.passport->friction = 1;
	b.passport->force = ob_v3(force, 0, 0);
	ob_world_body c = ob_world_add(&s->world, OB_SHAPE_CYLINDER, ob_v3(r, .2, 0), roller, ob_v3(0, 0, .1 + r));
	c.passport->friction = 1;
	c.state->pose.q = turn_about(ob_v3(1, 0, 0), M_PI / 2);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 1);
	const double plank_off = little_state(&l, 1).v.x / pull - 1,
		     roller_off = little_state(&l, 2).v.x / (pull / 3) - 1;
	printf("plank: speed off by %.1e, the cylinder's by %.1e\n", plank_off, roller_off);
	CHECK_NEAR(plank_off, 0, 1e-9);
	CHECK_NEAR(roller_off, 0, 1e-9);
	little_close(&l);
	free(s);
}

// A box that slides and rotates down a rough groove, obliquely, on three or four corners: iterations and steps for all
// contacts at once end after a few, for any change of the slip's direction.
static void check_iterations(void)
{
	const double half = M_PI / 4, slope = .6, most = 6; // in each substep, of each body
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(9.81 * sin(slope), 0, -9.81 * cos(slope));
	for (int side = -1; side <= 1; side += 2) {
		const ob_vec3 normal = ob_v3(0, -side * sin(half), cos(half)),
			      outwards = ob_v3(0, side * cos(half), sin(half));
		ob_world_body wall = ob_world_box(&s->world, 0, ob_v3(20, 2, .1),
						  ob_sub(ob_scale(outwards, 1.5), ob_scale(normal, .1)));
		wall.state->pose.q = turn_about(ob_v3(1, 0, 0), side * half);
	}
	ob_world_body b = ob_world_box(&s->world, 1, ob_v3(.3, .2, .1), ob_v3(-15, .02, .5));
	b.state->pose.q = turn_about(ob_v3(0, 0, 1), .3);
	ob_world_material(&s->world, .4, 0);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 1.5);
	ob_counters count;
	ob_universe_count(l.u, &count);
	const double each = (double)count.solver_iterations / (double)count.body_substeps;
	printf("box in a groove: %.2f iterations in each of %.0f substeps\n", each, (double)count.body_substeps);
	CHECK(each <= most);
	little_close(&l);
	free(s);
}

int main(void)
{
	check_iterations();
	for (double degrees = 20; degrees <= 60; degrees += 10)
		check_groove(degrees * M_PI / 180, 15 * M_PI / 180);
	check_wedge(30 * M_PI / 180);
	check_wedge(50 * M_PI / 180);
	check_plank();
	return check_end();
}
