// A scene without a file: a ground and some balls above it.
#ifndef OB_TESTS_HOST_LITTLE_SCENE_H
#define OB_TESTS_HOST_LITTLE_SCENE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "host/host.h"

static inline ob_object_def ball(const char *name, double x, double y, double z)
{
	ob_object_def d = { .dies = INFINITY };
	snprintf(d.passport.name, OB_NAME_MAX, "%s", name);
	d.passport.shape = OB_SHAPE_SPHERE;
	d.passport.size = ob_v3(.1, 0, 0);
	d.passport.mass = 1;
	d.passport.friction = .5;
	d.state.pose = (ob_pose){ .p = ob_v3(x, y, z), .q = ob_quat_identity() };
	return d;
}

// The ground is object 0, balls are 1 .. balls, one metre apart in rows of 50. The caller frees object.
static inline ob_scene little_scene(uint32_t balls)
{
	ob_scene s = { .run = { .gravity = ob_v3(0, 0, -9.81), .step_length = .01 }, .objects = balls + 1 };
	s.object = calloc(s.objects, sizeof *s.object);
	s.object[0] = ball("ground", 0, 0, 0);
	s.object[0].passport.shape = OB_SHAPE_PLANE;
	s.object[0].passport.flags = OB_OBJECT_STATIC;
	s.object[0].passport.mass = 0;
	for (uint32_t i = 1; i <= balls; i++) {
		char name[32];
		snprintf(name, sizeof name, "ball %u", i);
		s.object[i] = ball(name, i % 50, i / 50, 1);
		s.object[i].passport.id = i;
	}
	return s;
}

// Balls that fall onto each other, and keep all contacts busy.
static inline ob_scene busy_heap(uint32_t balls)
{
	ob_scene s = little_scene(balls);
	for (uint32_t i = 1; i <= balls; i++) {
		s.object[i].state.pose.p = ob_v3(.11 * (i % 3), .12 * (i / 3 % 3) + .01 * i, .3 + .22 * (i / 9));
		s.object[i].passport.restitution = .3;
	}
	return s;
}

// Balls far apart that come together within a second, in one heap on the ground.
static inline ob_scene falling_heap(uint32_t balls)
{
	ob_scene s = little_scene(balls);
	for (uint32_t i = 1; i <= balls; i++) {
		ob_vec3 place = ob_v3(i % 7, i / 7 % 7, i / 49); // in a lattice
		ob_vec3 to = ob_add(ob_scale(place, .15), ob_v3(0, 0, .2)),
			from = ob_add(ob_scale(place, 4), ob_v3(0, 0, 40));
		s.object[i].state.pose.p = from;
		s.object[i].state.v = ob_sub(to, from);
	}
	return s;
}

static inline ob_host_config little_config(const ob_scene *s, ob_isolation isolation, uint32_t workers)
{
	ob_host_config c = { .isolation = isolation, .workers = workers };
	c.run = (ob_run_settings){
		.gravity = s->run.gravity, .step_length = s->run.step_length, .substeps = 2, .iterations = 4
	};
	return c;
}

static inline uint64_t steps_of(const ob_host *h)
{
	ob_universe_info info;
	ob_universe_get_info(ob_host_universe(h), &info);
	return info.step;
}

#endif
