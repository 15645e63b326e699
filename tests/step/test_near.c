// Bodies that spin some millimetres from a ball, and never touch it: their angular momentum stays.
#include <stdlib.h>

#include "base/random.h"
#include "check.h"
#include "little_universe.h"

static ob_vec3 momentum_of(const ob_state *b, ob_vec3 inertia)
{
	ob_mat3 r = ob_quat_matrix(b->pose.q);
	ob_vec3 w = ob_rotate_back(&r, b->w);
	return ob_rotate(&r, ob_v3(inertia.x * w.x, inertia.y * w.y, inertia.z * w.z));
}

// A body whose bounding sphere is so far (m) from the ball, beside it.
static ob_world_body add_spinner(little_scene *s, int shape, double gap)
{
	static const ob_shape shapes[] = { OB_SHAPE_BOX, OB_SHAPE_CYLINDER, OB_SHAPE_CAPSULE };
	const ob_vec3 size = shape ? ob_v3(.2, .3, 0) : ob_v3(.3, .2, .1);
	return ob_world_add(&s->world, shapes[shape], size, 1,
			    ob_v3(.2 + gap + ob_shape_radius(shapes[shape], size), 0, 0));
}

// Largest change of the angular momentum, relative to itself.
static double turned_momentum(uint64_t seed, bool moves)
{
	enum { STEPS = 6 };
	little_scene *s = little_scene_new();
	s->run.tolerance = 1e-3;
	s->run.gravity = ob_v3(0, 0, seed & 2 ? -9.81 : 0);
	const int shape = (int)(seed / 4 % 3);
	ob_world_sphere(&s->world, moves ? 5 : 0, .2, ob_v3(0, 0, 0));
	ob_world_body b = add_spinner(s, shape, .01 * exp(ob_splitmix_within(&seed, -1, 1)));
	b.state->w = ob_splitmix_vector(&seed, pow(10, 1.2 + 1.2 * ob_splitmix_within(&seed, -1, 1)));
	b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_splitmix_vector(&seed, 1));
	const ob_state start = *b.state;
	const ob_vec3 inertia = b.passport->inertia, before = momentum_of(&start, inertia);
	double worst = 0;
	little_universe l;
	little_open(&l, s);
	for (int step = 0; step < STEPS; step++) {
		little_run(&l, 1);
		const ob_state now = little_state(&l, 1);
		worst = fmax(worst, ob_norm(ob_sub(momentum_of(&now, inertia), before)) / ob_norm(before));
	}
	little_close(&l);
	free(s);
	return worst;
}

int main(void)
{
	enum { SCENES = 3000 };
	for (int moves = 0; moves < 2; moves++) {
		double worst = 0;
		int off = 0;
		for (uint64_t seed = 0; seed < SCENES; seed += 1 + (uint64_t)moves) {
			const double turned = turned_momentum(seed, moves);
			off += turned > 1e-12;
			worst = fmax(worst, turned);
		}
		printf("beside a %s ball: angular momentum turned in %d of %d scenes, by %.1e at most\n",
		       moves ? "free" : "static", off, SCENES / (1 + moves), worst);
		CHECK(off == 0);
	}
	return check_end();
}
