// A second solver, which takes an island through the same step from the same start with another number of substeps. The
// difference of the two solutions shows the error of the coarser one, whatever causes it.
//
//   input ──> probe: other substeps ──> bodies at the step's end ──────────┐
//     └─────> solver of the run ──────> bodies at the step's end ──> ob_probe_distance
//
// It leaves no trace: it has its own memory and counters, and its contacts and touches go nowhere.
#ifndef OB_SOLVER_PROBE_H
#define OB_SOLVER_PROBE_H

#include "solver/solver.h"

typedef struct ob_probe ob_probe;

// Error (m) of a time (s) whose steps (s long) all have these errors of place (m) and speed (m/s): each error of speed
// lasts for half of it in the mean.
static inline double ob_error_of_time(double error, double speed, double step, double time)
{
	return (error + .5 * time * speed) * time / step;
}

// The same of a second in the units of the run.
static inline double ob_error_of_run(const ob_solver *s, double error, double speed)
{
	return ob_error_of_time(error, speed, s->settings->step_length, ob_coarse_time(&s->island));
}

// Creates a probe with the thresholds of a run with so many substeps. NULL if there is no memory.
ob_probe *ob_probe_create(const ob_run_settings *run, uint32_t substeps);
void ob_probe_destroy(ob_probe *p);

// Solves the island. ob_probe_solve: beside s's solution, with which it is compared, with other substeps, by its budget; its partial
// substeps (solver/adaptive_substep.h) are longer or shorter in proportion. ob_probe_try: returns false if it would take more work (solver/budget.h) than `most`.
void ob_probe_solve(ob_probe *p, ob_solver *s, uint32_t substeps, uint32_t beside);
bool ob_probe_try(ob_probe *p, const ob_island_input *in, uint32_t substeps, uint64_t most);
// Returns the probe's own solution.
ob_island_work *ob_probe_island(ob_probe *p);
// Finds the differences of velocity between w, a solution of the same island, and the probe's that last. Among more bodies than are watched
// closely, iterations leave some that contacts and joints take back in the next step, and leave others: these do not last.
void ob_probe_compare(ob_probe *p, ob_island_work *w);
// Returns the distance (m) of the surface of the body in this row of w from where the probe has it, at most; 0 if both
// solutions are its flight. A turn about an axis of symmetry moves no surface. speed: m/s, the same of a point's velocity, as far as it
// lasts. After ob_probe_compare with w.
double ob_probe_distance(const ob_probe *p, const ob_island_work *w, uint32_t row, double *speed);

#endif
