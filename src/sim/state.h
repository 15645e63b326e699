// Private state of a worker (see sim.h).
#ifndef OB_SIM_STATE_H
#define OB_SIM_STATE_H

#include "sim/island.h"
#include "sim/ode_bodies.h"
#include "sim/rotation_cache.h"
#include "sim/sim.h"
#include "table/trace.h"

enum { OB_TASKS_TIMED = 64 };

struct ob_sim {
	ob_universe *u;
	ob_step_data *data; // of u, constant
	const ob_run_settings *settings; // of u, constant
	uint32_t worker;
	ob_ode_bodies ode_bodies;
	ob_island_work island; // scratch
	ob_rotation_cache rotations;
	struct ob_committer *committer; // NULL unless this is the arranger (commit.h)
	ob_peers peers; // the arranger's; ranks = 0: this is the only one
	struct ob_ode_baseline *baseline; // NULL unless one ODE world holds all objects
	struct { // sim/budget.h
		uint64_t noted, told; // work: total; part already added to the step's sum, or the share's
		uint64_t share; // spent in the running share, if that has a budget of its own
		uint32_t object;
		bool spent;
	} budget;
	struct { // sim/scripts.h; NULL: this worker runs none
		ob_script_run run;
		void *runner;
		ob_script_turn turn; // for a contained simulator: the copy that it runs
		ob_script_cell cell; // the copy that it hands over
	} scripts;
	uint64_t fault_chances; // in this process (sim/fault.h)
	ob_counters counters; // handed over to the universe at the end of each phase
	struct { // sim/profile.h
		bool timed, shown; // for the counters; for the trace
		bool wanted; // timed or shown
		ob_profile_section section; // section to which the time is added
		uint64_t since, wall[OB_PROFILE_SECTIONS]; // ns, in the running phase
		uint64_t asking; // ns, wall, of the running phase: spent reading the CPU clock, part of no section
		double cpu, cpu_end; // s: at the phase's begin; at the previous phase's end
	} times;
	struct { // sim/profile.h: tasks done since the CPU clock was read
		uint32_t n, task[OB_TASKS_TIMED], ns[OB_TASKS_TIMED]; // wall
		uint64_t since, sum; // ns, wall: when the last task ended; sum of these tasks
		double cpu; // s, when it was read
		uint64_t told; // ns of CPU, sum of all tasks of the phase before
	} tasks;
	struct { // sim/profile.h
		bool traced;
		ob_trace_kind kind; // running span of level 0
		uint64_t since, chunk, island; // ns, when each level's span began
		uint32_t islands, members; // counted at "since"
	} span;
};

#endif
