// Holds the object "ball" at a height: hover NAME HEIGHT, of a run that `obsim control` has started.
// cc hover.c $(pkg-config --cflags --libs obsim) -o hover
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <ob/control.h>

enum { STEPS = 600 };

static bool find(const ob_universe *u, const char *name, ob_passport *out)
{
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	for (uint32_t id = 0; id < info.capacity; id++)
		if (ob_universe_get_passport(u, id, out) && strcmp(out->name, name) == 0)
			return true;
	return false;
}

// A spring and a damper between the ball and the height, beside its weight.
static bool hover(const ob_universe *u, ob_controller *c, double height, ob_error *e)
{
	ob_universe_info info;
	ob_passport ball;
	ob_motion m;
	if (!find(u, "ball", &ball))
		return ob_fail(e, "the universe has no object \"ball\"");
	for (int i = 0; i < STEPS; i++) {
		ob_universe_get_info(u, &info);
		if (!ob_universe_get_motion(u, ball.id, &m))
			return ob_fail(e, "the ball has gone");
		const ob_state now = ob_motion_at(&m, ball.inertia, info.time);
		const double push = ball.mass * (25 * (height - now.pose.p.z) - 10 * now.v.z - info.gravity.z);
		const ob_change force = { ball.id, ball.generation, { 0, 0, push } };
		if (!ob_controller_set_forces(c, &force, 1, e) || !ob_controller_step(c, 1, e))
			return false;
		if (i % 60 == 0 || i == STEPS - 1)
			printf("%.2f s: %.6f m\n", info.time, now.pose.p.z);
	}
	return true;
}

int main(int argc, char **argv)
{
	ob_error e = { "usage: hover NAME HEIGHT" };
	ob_universe *u = argc == 3 ? ob_universe_attach(argv[1], &e) : NULL;
	ob_controller *c = u ? ob_controller_open(u, &e) : NULL;
	const bool fine = c && hover(u, c, strtod(argv[2], NULL), &e);
	if (!fine)
		fprintf(stderr, "hover: %s\n", e.text);
	ob_controller_close(c);
	ob_universe_detach(u);
	return fine ? 0 : 1;
}
