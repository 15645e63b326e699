// What a worker keeps for itself (see sim.h).
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
	ob_step_data *data; // of u, the same for its whole life
	const ob_run_settings *settings; // of u, constant
	uint32_t worker;
	ob_ode_bodies ode_bodies;
	ob_island_work island; // scratch
	ob_rotation_cache rotations;
	struct ob_committer *committer; // NULL unless this is the arranger (commit.h)
	ob_peers peers; // the arranger's; no ranks: there is but this one
	struct ob_ode_baseline *baseline; // NULL unless one ODE world holds all objects
	struct { // sim/budget.h
		uint64_t noted, told; // work; of which the step's sum, or the share's, knows
		uint64_t share; // of the running share, if it has a budget of its own
		uint32_t object;
		bool spent;
	} budget;
	struct { // sim/scripts.h; NULL: this worker runs none
		ob_script_run run;
		void *runner;
		ob_script_turn turn; // of a contained simulator, the copies that it runs ..
		ob_script_cell cell; // .. and hands over
	} scripts;
	uint64_t fault_chances; // in this process (sim/fault.h)
	ob_counters counters; // handed over to the universe at the end of each phase
	struct { // sim/profile.h
		bool timed, shown; // for the counters; for the trace
		bool wanted; // either
		ob_profile_section section; // that the time counts for
		uint64_t since, wall[OB_PROFILE_SECTIONS]; // ns; of the running phase
		uint64_t asking; // ns, wall, of the running phase: in which the CPU clock was read, of no section
		double cpu, cpu_end; // s, when it began; when the one before ended
	} times;
	struct { // sim/profile.h: tasks that are done since its CPU clock was read
		uint32_t n, task[OB_TASKS_TIMED], ns[OB_TASKS_TIMED]; // wall
		uint64_t since, sum; // ns, wall: when the last one ended; of those
		double cpu; // s, when it was read
		uint64_t told; // ns of CPU: of all of the phase before
	} tasks;
	struct { // sim/profile.h
		bool traced;
		ob_trace_kind kind; // of level 0, that goes on
		uint64_t since, chunk, island; // ns, when each level's span began
		uint32_t islands, members; // counted at "since"
	} span;
};

#endif
