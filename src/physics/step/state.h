// Private state of a worker (see sim.h).
#ifndef OB_STEP_STATE_H
#define OB_STEP_STATE_H

#include "cluster/cluster.h"
#include "solver/solver.h"
#include "step/rotation_cache.h"
#include "step/sim.h"
#include "table/trace.h"

enum { OB_TASKS_TIMED = 64 };

// Input of the island that is being solved (step/islands.c); memory grown as needed, never shrunk.
typedef struct ob_island_scratch {
	ob_island_input in;
	const ob_island *island;
	ob_island_object *object;
	ob_island_pair *pair;
	ob_island_joint *joint;
	ob_terrain_part *terrain; // of pairs with a terrain
	ob_passport *plane; // of those where it is flat
	uint32_t objects_max, pairs_max, joints_max, terrains, terrains_max;
	uint32_t *index_of; // [object of the universe]: its place in the input, if it is there
} ob_island_scratch;

struct ob_sim {
	ob_universe *u;
	ob_step_data *data; // of u, constant
	const ob_run_settings *settings; // of u, constant
	uint32_t worker;
	ob_solver solver;
	void (*fly)(ob_sim *s, const uint32_t *id, uint32_t n, bool *done); // ob_ballistic_advance, or by ODE
	ob_island_scratch scratch;
	ob_terrain_part checked; // by a check of a pair with a terrain
	ob_rotation_cache rotations;
	struct ob_probe *verifier; // step/islands.c; NULL: the run is not verified
	struct ob_committer *committer; // NULL unless this is the arranger (commit.h)
	ob_cluster *cluster; // the arranger's, of several ranks; else NULL
	struct ob_ode_baseline *baseline; // NULL unless one ODE world holds all objects
	struct { // step/budget.h
		uint64_t share; // spent in the running share, if that has a budget of its own
		uint32_t object;
	} budget;
	struct { // step/scripts.h; NULL: this worker runs none
		ob_script_run run;
		void *runner;
		ob_script_turn turn[OB_SCRIPT_BATCH]; // for a contained simulator: the copies that it runs
		ob_script_cell cell[OB_SCRIPT_BATCH]; // the copies that it hands over
	} scripts;
	uint64_t fault_chances; // in this process (step/fault.h)
	struct { // step/profile.h
		bool timed, shown; // for the counters; for the trace
		ob_profile_section section; // section to which the time is added
		uint64_t since, wall[OB_PROFILE_SECTIONS]; // ns, in the running phase
		uint64_t asking; // ns, wall, of the running phase: spent reading the CPU clock, part of no section
		double cpu, cpu_end; // s: at the phase's begin; at the previous phase's end
	} times;
	struct { // step/profile.h: tasks done since the CPU clock was read
		uint32_t n, task[OB_TASKS_TIMED], ns[OB_TASKS_TIMED]; // wall
		uint64_t since, sum; // ns, wall: when the last task ended; sum of these tasks
		double cpu; // s, when it was read
		uint64_t told; // ns of CPU, sum of all tasks of the phase before
	} tasks;
	struct { // step/profile.h
		bool traced;
		ob_trace_kind kind; // running span of level 0
		uint64_t since, chunk, island; // ns, when each level's span began
		uint32_t islands, members; // counted at "since"
	} span;
};

#endif
