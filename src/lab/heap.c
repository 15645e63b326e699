#include "lab/heap.h"

#include "lab/look.h"

enum { MEMORY_SUM, MEMORY_FRAMES, MEMORY_START, MEMORY_LOWEST }; // resting penetrations (m); energies (J)

void ob_heap_observe(ob_case_run_state *t)
{
	double energy = ob_look_energy(t), *memory = t->memory;
	const ob_penetration p = ob_look_penetration(t, &t->figure[OB_HEAP_WORST]);
	if (t->time > t->of->duration - 1) {
		memory[MEMORY_SUM] += p.mean_m;
		memory[MEMORY_FRAMES]++;
		ob_look_keep(&t->figure[OB_HEAP_RESTING_WORST], 1e3 * p.max_m);
	}
	if (!t->frame)
		memory[MEMORY_START] = memory[MEMORY_LOWEST] = energy;
	memory[MEMORY_LOWEST] = fmin(memory[MEMORY_LOWEST], energy);
	ob_look_keep(&t->figure[OB_HEAP_GROWTH], (energy - memory[MEMORY_LOWEST]) / memory[MEMORY_START]);
	ob_look_fail_below(t);
}

void ob_heap_judge(ob_case_run_state *t)
{
	t->figure[OB_HEAP_RESTING_MEAN] = 1e3 * t->memory[MEMORY_SUM] / fmax(t->memory[MEMORY_FRAMES], 1);
	if (!t->failed && ob_look_farthest(t) < .1)
		t->failed = "nothing moved";
}
