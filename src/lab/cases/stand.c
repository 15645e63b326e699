#include "lab/cases/stand.h"

#include "lab/look.h"

enum { MEMORY_SUM, MEMORY_FRAMES }; // m: sum of the mean penetrations so far

void ob_stand_observe_at(ob_case_run_state *t, ob_vec3 carried)
{
	t->memory[MEMORY_SUM] += ob_look_penetration(t, &t->figure[OB_STAND_WORST]).mean_m;
	t->memory[MEMORY_FRAMES]++;
	double fallen = 0;
	for (uint32_t id = 0; id < t->world->objects; id++) {
		const ob_vec3 moved = ob_sub(ob_look_moved(t, id), carried);
		ob_look_keep(&t->figure[OB_STAND_DRIFT], 1e3 * hypot(moved.x, moved.y));
		fallen += ob_norm(moved) > .25;
	}
	t->figure[OB_STAND_FALLEN] = fallen;
	if (fallen > 0)
		t->failed = "fell";
}

void ob_stand_observe(ob_case_run_state *t)
{
	ob_stand_observe_at(t, ob_v3(0, 0, 0));
}

void ob_stand_judge(ob_case_run_state *t)
{
	t->figure[OB_STAND_MEAN] = 1e3 * t->memory[MEMORY_SUM] / t->memory[MEMORY_FRAMES];
}
