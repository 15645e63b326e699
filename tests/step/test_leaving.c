// A body that slides or rolls off something round, or over an edge, leaves it as the normal force ends, and flies on
// along its tangent: the rows of the contact still turn after that, and must not push it.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const double g = 9.81; // m/s^2

typedef enum support { SPHERE, CYLINDER, EDGE, SUPPORTS } support;

static const char *const support_name[] = { "sphere", "cylinder", "edge" };

static ob_quat lying(void)
{
	return ob_quat_turn(ob_quat_identity(), ob_v3(M_PI / 2, 0, 0));
}

// A body of radius r, with squared radius of gyration "gyration" r^2 if it rolls and 0 if it slides, leaves a support
// of radius R from rest at "start" from the top. Its centre leaves the circle of R + r at the cosine 2 cos(start) / (3
// + gyration), by energy and the balance of normal forces (Routh 1905), with v^2 = g (R + r) cosine. Returns the
// relative error of the speed along x, which is constant from there on.
static double off(support on, bool rolls, ob_shape shape, double start)
{
	const double support_radius = on == EDGE ? 0 : 1, r = .25, away = support_radius + r;
	const double gyration = !rolls ? 0 : shape == OB_SHAPE_SPHERE ? .4 : .5;
	little_scene *s = little_scene_new();
	if (on == SPHERE)
		ob_world_sphere(&s->world, 0, support_radius, ob_v3(0, 0, 0));
	else if (on == CYLINDER)
		ob_world_add(&s->world, OB_SHAPE_CYLINDER, ob_v3(support_radius, 2, 0), 0, ob_v3(0, 0, 0))
			.state->pose.q = lying();
	else
		ob_world_box(&s->world, 0, ob_v3(1, 2, 1), ob_v3(-1, 0, -1));
	ob_world_body body = ob_world_add(&s->world, shape, ob_v3(r, shape == OB_SHAPE_SPHERE ? 0 : .3, 0), 1,
					  ob_v3(away * sin(start), 0, away * cos(start)));
	body.state->pose.q = lying();
	ob_world_material(&s->world, rolls ? 1000 : 0, 0);
	const double leaves = 2 * cos(start) / (3 + gyration), speed = sqrt(g * away * leaves) * leaves;
	little_universe l;
	little_open(&l, s);
	do
		little_run(&l, 1);
	while (little_state(&l, 1).pose.p.z > .9 * away * leaves);
	const double result = little_state(&l, 1).v.x / speed - 1;
	little_close(&l);
	free(s);
	return result;
}

// Friction with a coefficient that never slips ends within a partial substep, as the load does, and is modelled to last
// for all of it.
static void check_leaving(support on, bool rolls, ob_shape shape)
{
	double worst = 0;
	for (int i = 0; i < 10; i++)
		worst = fmax(worst, fabs(off(on, rolls, shape, .2 + .006 * i)));
	printf("a %s that %s off a%s %s: speed off by %.1e\n", shape == OB_SHAPE_SPHERE ? "sphere" : "cylinder",
	       rolls ? "rolls" : "slides", on == EDGE ? "n" : "", support_name[on], worst);
	CHECK(worst < (rolls ? 2.5e-3 : 1e-4));
}

int main(void)
{
	for (support on = 0; on < SUPPORTS; on++)
		for (int rolls = 0; rolls < 2; rolls++) {
			check_leaving(on, rolls, OB_SHAPE_SPHERE);
			if (on != SPHERE)
				check_leaving(on, rolls, OB_SHAPE_CYLINDER);
		}
	return check_end();
}
