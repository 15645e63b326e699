// Contacts of objects: by their shapes, or by their AABBs; and the cost of a box test.
#include <stdlib.h>

#include "base/cpu.h"
#include "base/clock.h"
#include "solver/boxes.h"
#include "solver/narrowphase.h"

#include "../check.h"
#include "little_universe.h"

static const double diagonal = .7853981633974483; // 45 degrees

// Two unit cubes next to each other, one turned about the vertical: .1 m apart, but not between their
// boxes.
static little_scene *neighbours(ob_narrow_phase narrow)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.narrow_phase = narrow;
	ob_world_box(&s->world, 1, ob_v3(.5, .5, .5), ob_v3(0, 0, 0));
	ob_world_body turned = ob_world_box(&s->world, 1, ob_v3(.5, .5, .5), ob_v3(.9, .9, 0));
	turned.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, diagonal));
	return s;
}

// Gap (m) of the boxes round the two objects along the axis with the largest gap.
static double gap_between_boxes(const little_universe *l)
{
	double a[6], b[6], most = -INFINITY;
	ob_shape_bounds(OB_SHAPE_BOX, ob_v3(.5, .5, .5), little_state(l, 0).pose, a);
	ob_shape_bounds(OB_SHAPE_BOX, ob_v3(.5, .5, .5), little_state(l, 1).pose, b);
	for (int k = 0; k < 3; k++)
		most = fmax(most, fmax(a[k] - b[3 + k], b[k] - a[3 + k]));
	return most;
}

static void test_gap_between(ob_narrow_phase narrow)
{
	little_scene *s = neighbours(narrow);
	little_universe l;
	little_open(&l, s);
	ob_counters before, c;
	ob_universe_count(l.u, &before);
	little_run(&l, 120);
	ob_universe_count(l.u, &c);
	ob_vec3 apart = ob_sub(little_state(&l, 1).pose.p, little_state(&l, 0).pose.p);
	if (narrow == OB_NARROW_AABB) {
		CHECK_NEAR(gap_between_boxes(&l), 0, 1e-3); // pushed no farther than necessary
		CHECK(c.box_tests > before.box_tests);
	} else {
		CHECK_NEAR(apart.x, .9, 0);
		CHECK_NEAR(apart.y, .9, 0);
		CHECK(c.box_tests == before.box_tests);
	}
	CHECK(before.box_tests >= 2); // each has tested the other
	little_close(&l);
	free(s);
}

// A body that falls onto the ground comes to lie on its box: a ball on its lowest point, a turned cube above it.
static void test_on_the_ground(ob_narrow_phase narrow)
{
	little_scene *s = little_scene_new();
	s->run.narrow_phase = narrow;
	ob_world_ground(&s->world);
	ob_world_sphere(&s->world, 1, .5, ob_v3(0, 0, 1));
	ob_world_body edge = ob_world_box(&s->world, 1, ob_v3(.5, .5, .5), ob_v3(3, 0, 1));
	edge.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(.3, 0, 0));
	little_universe l;
	little_open(&l, s);
	little_run(&l, 300);
	CHECK_NEAR(little_state(&l, 1).pose.p.z, .5, 1e-3);
	double height = little_state(&l, 2).pose.p.z, box = .5 * (cos(.3) + sin(.3));
	if (narrow == OB_NARROW_AABB)
		CHECK_NEAR(height, box, 2e-3); // four corners of the box carry it, so it does not rotate
	else
		CHECK_NEAR(height, .5, 2e-3);
	little_close(&l);
	free(s);
}

// The AABBs' separation is a lower bound of the shapes', and equals that of boxes made by hand.
static void test_find(void)
{
	ob_mat3 turned = ob_quat_matrix(ob_quat_turn(ob_quat_identity(), ob_v3(.4, .7, -.2)));
	static const ob_shape shapes[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
	ob_placed wall = { .shape = OB_SHAPE_BOX,
			   .size = ob_v3(.1, 5, 5),
			   .p = ob_v3(2, 0, 0),
			   .r = ob_quat_matrix(ob_quat_identity()) };
	for (int i = 0; i < 4; i++) {
		ob_placed x = { .shape = shapes[i], .size = ob_v3(.3, .5, .2), .r = turned };
		double bounds[6];
		ob_quat q = ob_quat_turn(ob_quat_identity(), ob_v3(.4, .7, -.2));
		ob_shape_bounds(x.shape, x.size, (ob_pose){ x.p, q }, bounds);
		ob_manifold m;
		ob_manifold_aabb(&x, &wall, 2, &m);
		CHECK(m.points == 4);
		CHECK_NEAR(m.normal.x, -1, 1e-15);
		CHECK_NEAR(m.gap[0], 1.9 - bounds[3], 1e-12);
		CHECK_NEAR(m.separation, 1.9 - bounds[3], 1e-12);
	}
}

static double least_time(uint32_t load)
{
	double least = INFINITY;
	for (int i = 0; i < 20; i++) {
		double begun = ob_clock_thread_cpu();
		for (int k = 0; k < 100; k++)
			ob_synthetic_load(load);
		least = fmin(least, ob_clock_thread_cpu() - begun);
	}
	return least;
}

// A hundred times as many numbers take far longer: the compiler has not removed the sum.
static void test_synthetic_load(void)
{
	CHECK(least_time(100000) > 20 * least_time(1000));
	CHECK(least_time(1000) > 10 * least_time(0));
}

int main(void)
{
	test_gap_between(OB_NARROW_OBB);
	test_gap_between(OB_NARROW_AABB);
	test_on_the_ground(OB_NARROW_OBB);
	test_on_the_ground(OB_NARROW_AABB);
	test_find();
	test_synthetic_load();
	return check_end();
}
