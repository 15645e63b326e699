// Boxes that spin free of torque for five minutes while they are near others, watched for contacts: step by step
// through the island solver.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "reference/spin.h"

static const ob_vec3 order[] = { { 1, 2, 3 }, { 1, 3, 2 }, { 2, 1, 3 }, { 2, 3, 1 }, { 3, 1, 2 }, { 3, 2, 1 } };
enum { BOXES = sizeof order / sizeof *order };

static little_scene *spinning_boxes(void)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < BOXES; i++) {
		ob_world_body o = ob_world_box(&s->world, 1, ob_v3(.3, .2, .1), ob_v3(.75 * i, 0, 0));
		o.passport->inertia = order[i];
		o.state->w = ob_v3(.05, 5, .02);
	}
	return s;
}

static ob_vec3 momentum_of(const ob_state *b, ob_vec3 inertia)
{
	ob_mat3 r = ob_quat_matrix(b->pose.q);
	ob_vec3 w = ob_rotate_back(&r, b->w);
	return ob_rotate(&r, ob_v3(inertia.x * w.x, inertia.y * w.y, inertia.z * w.z));
}

// Energy and momentum in every step, the attitude every ten seconds.
int main(void)
{
	double energy = 0, momentum = 0, turned = 0;
	little_scene *s = spinning_boxes();
	ob_reference_spin exact[BOXES];
	little_universe l;
	little_open(&l, s);
	for (int i = 0; i < BOXES; i++)
		ob_reference_spin_plan(&exact[i], ob_quat_identity(), s->world.state[i].w, order[i]);
	for (int step = 1; step <= 300 * 60; step++) {
		little_run(&l, 1);
		for (uint32_t i = 0; i < BOXES; i++) {
			ob_state b = little_state(&l, i), start = s->world.state[i];
			ob_vec3 m = momentum_of(&b, order[i]), m0 = momentum_of(&start, order[i]);
			energy = fmax(energy, fabs(ob_dot(b.w, m) / ob_dot(start.w, m0) - 1));
			momentum = fmax(momentum, ob_norm(ob_sub(m, m0)) / ob_norm(m0));
			if (step % 600)
				continue;
			ob_quat q;
			ob_vec3 w;
			ob_reference_spin_at(&exact[i], step / 60., &q, &w);
			turned = fmax(turned, ob_reference_turn_between(q, b.pose.q));
		}
	}
	printf("energy within %.1e, momentum %.1e, attitude %.1e rad\n", energy, momentum, turned);
	CHECK_NEAR(energy, 0, 1e-9);
	CHECK_NEAR(momentum, 0, 1e-12);
	CHECK_NEAR(turned, 0, 1e-8);
	CHECK(ob_universe_step_data(l.u)->count->pairs > 0);
	little_close(&l);
	free(s);
	return check_end();
}
