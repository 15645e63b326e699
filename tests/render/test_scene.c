#include "test_scene.h"

#include <stdio.h>
#include <stdlib.h>

static const float palette[][3] = {
	{ .80f, .26f, .12f }, { .90f, .56f, .12f }, { .10f, .33f, .55f }, { .12f, .46f, .42f },
	{ .86f, .80f, .66f }, { .50f, .13f, .20f }, { .32f, .50f, .70f }, { .93f, .72f, .30f },
};

void test_scene_start(ob_snapshot *s, uint32_t count)
{
	*s = (ob_snapshot){ .passport = calloc(count + 1, sizeof *s->passport),
			    .motion = calloc(count + 1, sizeof *s->motion),
			    .count_max = count + 1 };
	if (!s->passport || !s->motion)
		abort();
	test_scene_add(s, OB_SHAPE_PLANE, ob_v3(0, 0, 0), ob_v3(0, 0, 0), ob_quat_identity(), palette[4]);
	s->passport[0].flags |= OB_OBJECT_STATIC;
}

ob_motion *test_scene_add(ob_snapshot *s, ob_shape shape, ob_vec3 size, ob_vec3 p, ob_quat q, const float colour[3])
{
	uint32_t i = s->count++;
	if (i >= s->count_max)
		abort();
	s->passport[i] = (ob_passport){ .id = i,
					.flags = OB_OBJECT_PRESENT,
					.shape = shape,
					.size = size,
					.mass = 1,
					.inertia = { 1, 1, 1 },
					.colour = { colour[0], colour[1], colour[2], 1 },
					.roughness = .5f };
	s->motion[i] = (ob_motion){ .p = p, .q = q, .valid_until = INFINITY };
	return &s->motion[i];
}

void test_scene_finish(ob_snapshot *s)
{
	free(s->passport);
	free(s->motion);
	*s = (ob_snapshot){ 0 };
}

static double uniform(unsigned *seed)
{
	return rand_r(seed) / (RAND_MAX + 1.);
}

void test_scene_boxes(ob_snapshot *s, uint32_t count, double spread, unsigned seed)
{
	test_scene_start(s, count);
	ob_vec3 below = { 0, 0, 0 }, half = { 0, 0, 0 };
	for (uint32_t i = 0; i < count; i++) {
		const float *colour = palette[(int)(8 * uniform(&seed))];
		double kind = uniform(&seed), x = spread * (uniform(&seed) - .5), y = spread * (uniform(&seed) - .5);
		ob_vec3 size = ob_v3(.15 + .4 * uniform(&seed), .15 + .4 * uniform(&seed), .12 + .4 * uniform(&seed));
		ob_vec3 p = ob_v3(x, y, size.z), turn = ob_v3(0, 0, 6 * uniform(&seed));
		if (kind < .45 && i) { // on the one before
			p = ob_v3(below.x + .2 * (uniform(&seed) - .5), below.y, below.z + half.z + size.z);
		} else if (kind > .9) { // falling
			p.z += 4 * uniform(&seed);
			turn = ob_v3(uniform(&seed), 2 * uniform(&seed), turn.z);
		}
		test_scene_add(s, OB_SHAPE_BOX, size, p, ob_quat_turn(ob_quat_identity(), turn), colour);
		if (kind <= .9) {
			below = p;
			half = size;
		}
	}
}

ob_look_def test_scene_look(void)
{
	return (ob_look_def){ .sky_top = { .12f, .30f, .62f },
			      .sky_horizon = { .72f, .82f, .90f },
			      .ground_colour = { .42f, .41f, .38f },
			      .grid = true,
			      .sun = { .5, -.35, .8 } };
}

ob_camera_def test_scene_camera(ob_vec3 eye, ob_vec3 target)
{
	return (ob_camera_def){ .name = "test", .eye = eye, .target = target, .fov = 40 * M_PI / 180 };
}
