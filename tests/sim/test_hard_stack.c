// Hard case: a stack of ten unit cubes stands for 20 s, awake, and none is ever more than half a millimetre deep in
// another.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

int main(void)
{
	little_scene *s = little_scene_new();
	little_stack(s, 10, 7);
	little_universe l;
	little_open(&l, s);
	double deepest = 0, drift = 0, energy = little_energy(&l), gained = 0;
	for (int step = 0; step < 1200; step++) {
		little_run(&l, 1);
		deepest = fmax(deepest, little_penetration(&l).max_m);
		gained = fmax(gained, little_energy(&l) / energy - 1);
	}
	for (uint32_t i = 1; i <= 10; i++) {
		ob_vec3 moved = ob_sub(little_state(&l, i).pose.p, s->object[i].state.pose.p);
		drift = fmax(drift, hypot(moved.x, moved.y));
		CHECK(fabs(moved.z) < .005);
		CHECK(!little_asleep(&l, i));
	}
	printf("deepest %.3f mm, drift %.3f mm, energy gained %.1e\n", 1e3 * deepest, 1e3 * drift, gained);
	CHECK(deepest <= .5e-3);
	CHECK(drift <= 1e-3);
	CHECK(gained <= 1e-7);
	little_close(&l);
	free(s);
	return check_end();
}
