#include "paper/boxes.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/random.h"

static const double spacing = 1.8; // m: exceeds the longest diagonal, so that no two boxes start in contact
static const double lowest = 1.5; // m
static const double density = 1000, friction = .5;
static const double least_side = .2, most_side = 1; // m
enum { LEVELS = 4 };

// Uniform over all attitudes (Shoemake 1992).
static ob_quat draw_attitude(uint64_t *state)
{
	double u = ob_splitmix_real(state), a = 2 * M_PI * ob_splitmix_real(state),
	       b = 2 * M_PI * ob_splitmix_real(state);
	return (ob_quat){ sqrt(1 - u) * sin(a), sqrt(1 - u) * cos(a), sqrt(u) * sin(b), sqrt(u) * cos(b) };
}

static void put_ground(ob_object_def *o)
{
	o->passport = (ob_passport){
		.flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC,
		.shape = OB_SHAPE_PLANE,
		.friction = friction,
		.colour = { .45f, .48f, .44f, 1 },
		.name = "ground",
	};
	o->state.pose.q = ob_quat_identity();
	o->dies = INFINITY;
}

static void put_box(ob_object_def *o, uint32_t id, uint32_t side, uint64_t *state)
{
	uint32_t column = (id - 1) / LEVELS, level = (id - 1) % LEVELS;
	double x = ob_splitmix_within(state, least_side, most_side),
	       y = ob_splitmix_within(state, least_side, most_side),
	       z = ob_splitmix_within(state, least_side, most_side), middle = .5 * (side - 1);
	o->passport = (ob_passport){
		.id = id,
		.flags = OB_OBJECT_PRESENT,
		.shape = OB_SHAPE_BOX,
		.size = ob_v3(x / 2, y / 2, z / 2),
		.mass = density * x * y * z,
		.friction = friction,
		.colour = { (float)(.15 + .7 * ob_splitmix_real(state)), (float)(.15 + .5 * ob_splitmix_real(state)),
			    (float)(.1 + .5 * ob_splitmix_real(state)), 1 },
		.roughness = .45f,
	};
	snprintf(o->passport.name, sizeof o->passport.name, "box#%u", id);
	o->state.pose.p =
		ob_v3((column % side - middle) * spacing, (column / side - middle) * spacing, lowest + level * spacing);
	o->state.pose.q = draw_attitude(state);
	o->dies = INFINITY;
}

bool ob_paper_boxes(ob_scene *s, uint32_t boxes, uint64_t seed)
{
	uint32_t columns = (boxes + LEVELS - 1) / LEVELS, side = (uint32_t)ceil(sqrt(columns));
	double reach = side * spacing;
	*s = (ob_scene){
		.title = "falling boxes",
		.run = { .gravity = { 0, 0, -9.81 } },
		.seed = seed,
		.objects = boxes + 1,
		.object = calloc(boxes + 1, sizeof *s->object),
		.cameras = 1,
		.camera = calloc(1, sizeof *s->camera),
		.look = { .sky_top = { .11f, .29f, .58f },
			  .sky_horizon = { .72f, .81f, .88f },
			  .ground_colour = { .46f, .48f, .45f },
			  .grid = true,
			  .sun = ob_scale(ob_v3(-.45, -.5, .9), 1 / ob_norm(ob_v3(-.45, -.5, .9))) },
	};
	if (!s->object || !s->camera)
		return false;
	s->camera[0] = (ob_camera_def){ .name = "main",
					.eye = ob_v3(-reach - 4, -1.5 * reach - 6, .5 * reach + 3),
					.target = ob_v3(0, 0, 1.5),
					.fov = .8 };
	put_ground(&s->object[0]);
	for (uint32_t i = 1; i <= boxes; i++)
		put_box(&s->object[i], i, side, &seed);
	return true;
}

void ob_paper_boxes_finish(ob_scene *s)
{
	free(s->object);
	free(s->camera);
}
