// Bodies that rotate fast near others: without a contact they rotate as in free flight, and none penetrates the bodies
// beside it.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static ob_vec3 momentum_of(const little_universe *l, uint32_t id)
{
	ob_state b = little_state(l, id);
	const ob_vec3 inertia = l->scene->world.passport[id].inertia;
	ob_mat3 r = ob_quat_matrix(b.pose.q);
	ob_vec3 w = ob_rotate_back(&r, b.w);
	return ob_rotate(&r, ob_v3(inertia.x * w.x, inertia.y * w.y, inertia.z * w.z));
}

// A body of this shape rotates at "rate" (rad/s) for 20 s, 10 mm from a ball, without a contact.
static void check_beside_ball(ob_shape shape, ob_vec3 size, ob_vec3 axis, double rate)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	double reach = ob_shape_radius(shape, size);
	ob_world_body o = ob_world_add(&s->world, shape, size, 1, ob_v3(0, 0, 0));
	o.state->w = ob_scale(axis, rate / ob_norm(axis));
	ob_vec3 corner = ob_v3(hypot(size.x, size.z), size.y, 0); // a box that turns about y has one there
	ob_world_sphere(&s->world, 1, .2, ob_scale(corner, (reach + .21) / ob_norm(corner)));
	little_universe l;
	little_open(&l, s);
	ob_vec3 before = momentum_of(&l, 0);
	double energy = little_energy(&l), lost = 0, changed = 0;
	for (int i = 0; i < 1200; i++) {
		little_run(&l, 1);
		lost = fmax(lost, ob_norm(ob_sub(momentum_of(&l, 0), before)) / ob_norm(before));
		changed = fmax(changed, fabs(little_energy(&l) / energy - 1));
	}
	CHECK(lost <= 1e-12);
	CHECK(changed <= 1e-11);
	printf("shape %d, %g rad/s: momentum off by %.1e, energy by %.1e\n", (int)shape, rate, lost, changed);
	little_close(&l);
	free(s);
}

// A rod rotates obliquely at 50 rad/s within reach of a box that stands beside it, e = 1 or 0.
static void check_rod_beside_box(double e, double offset, double tilt)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.tolerance = 1e-3;
	ob_world_body rod = ob_world_box(&s->world, 1, ob_v3(.5, .03, .02), ob_v3(0, 0, 0));
	rod.state->w = ob_v3(50 * sin(tilt), 10, 50 * cos(tilt));
	ob_world_box(&s->world, 5, ob_v3(.2, .3, .2), ob_v3(offset, 0, .1));
	ob_world_material(&s->world, 0, e);
	little_universe l;
	little_open(&l, s);
	double energy = little_energy(&l), gained = 0, deepest = 0;
	for (int i = 0; i < 120; i++) {
		little_run(&l, 1);
		gained = fmax(gained, little_energy(&l) / energy - 1);
		deepest = fmax(deepest, little_penetration(&l).max_m);
	}
	CHECK(gained <= 1e-9);
	CHECK(deepest <= 1e-3);
	printf("rod, e %g, box at %g, tilt %g: %.3f mm deep, gains %.1e, keeps %.3f\n", e, offset, tilt, 1e3 * deepest,
	       gained, little_energy(&l) / energy);
	little_close(&l);
	free(s);
}

int main(void)
{
	check_beside_ball(OB_SHAPE_BOX, ob_v3(.3, .2, .1), ob_v3(.3, 1, .2), 50);
	check_beside_ball(OB_SHAPE_BOX, ob_v3(.3, .02, .02), ob_v3(1, 1, .2), 50);
	check_beside_ball(OB_SHAPE_BOX, ob_v3(.3, .2, .1), ob_v3(0, 1, 1e-3), 1);
	check_beside_ball(OB_SHAPE_CYLINDER, ob_v3(.3, .05, 0), ob_v3(.3, 1, 2), 50);
	for (int k = 0; k < 12; k++)
		check_rod_beside_box(k % 2, .55 + .05 * (k / 2 % 3), k / 6 ? .7 : .2);
	return check_end();
}
