#include "solver/estimate.h"
#include "solver/island_solver.h"

void ob_island_solve(ob_solver *s, const ob_island_input *in)
{
	ob_island_step(s, in);
	ob_estimate_update(s);
	ob_island_report(s);
}
