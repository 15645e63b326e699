// What is told of each way: from the reports of its runs to medians with intervals.
#include <math.h>
#include <string.h>

#include "cli/compare.h"

const ob_figure_info ob_figure_table[OB_FIGURE_KINDS] = {
	[OB_FIGURE_COST] = { "cpu_s_per_body_and_step", "CPU per body and step", "s", "Cost",
			     "CPU time of all workers, spinning and waking included, over bodies and steps" },
	[OB_FIGURE_WALL] = { "wall_s_per_simulated_s", "wall per simulated s", "s", NULL,
			     "wall-clock time of stepping" },
	[OB_FIGURE_CPU] = { "cpu_s_per_simulated_s", "CPU per simulated s", "s", NULL, "CPU time of all workers" },
	[OB_FIGURE_P50] = { "step_p50_s", "step, median", "s", "Latency of a step",
			    "wall-clock time from one step boundary to the next" },
	[OB_FIGURE_P90] = { "step_p90_s", "step, 90 %", "s", NULL, "so long or shorter were 90 % of the steps" },
	[OB_FIGURE_P99] = { "step_p99_s", "step, 99 %", "s", NULL, "so long or shorter were 99 %" },
	[OB_FIGURE_MAX] = { "step_max_s", "step, longest", "s", NULL, "the longest step of the run" },
	[OB_FIGURE_CRITICAL] = { "critical_s_per_step", "critical path", "s", "Where the time goes, per step",
				 "in each phase the worker with the most to do, and arranging: what the step would "
				 "take "
				 "with a core for every worker" },
	[OB_FIGURE_WORK] = { "work_s_per_step", "work, all simulators", "s", NULL,
			     "CPU time of everything but waiting, summed over all workers" },
	[OB_FIGURE_GATE] = { "gate_s_per_step_and_worker", "at the gate, a worker", "s", NULL,
			     "wall-clock time in which a worker waits for the others" },
	[OB_FIGURE_GATE_CPU] = { "gate_cpu_s_per_step", "CPU of waiting", "s", NULL,
				 "CPU time of spinning, falling asleep and waking, all workers" },
	[OB_FIGURE_HELD] = { "held_s_per_step", "without a core", "s", NULL,
			     "wall-clock time in which workers had work and no core, all together" },
	[OB_FIGURE_EXPLAINED] = { "explained", "share explained", "", NULL,
				  "work, waiting for a core, at the gate and for the host, over the time that the "
				  "workers had" },
	[OB_FIGURE_PER_SIMULATOR] = { "cpu_s_per_simulator_and_simulated_s", "CPU per simulator", "s",
				      "Who uses the CPU, per simulated s", "CPU time of all workers over objects" },
	[OB_FIGURE_HOST] = { "host_cpu_s_per_simulated_s", "host", "s", NULL,
			     "CPU time of the host's process without workers and renderer" },
	[OB_FIGURE_RENDERER] = { "renderer_cpu_s_per_simulated_s", "renderer", "s", NULL,
				 "CPU time of drawing, in a run with 60 frames of 640x480 per simulated second" },
	[OB_FIGURE_FPS] = { "frames_per_s", "frames drawn per s", "", NULL,
			    "frames that were drawn in that run, over its wall-clock time with start and end" },
	[OB_FIGURE_SWITCHES] = { "switches_per_step", "switches per step", "", "What the system carries",
				 "how often a worker was taken off its core" },
	[OB_FIGURE_STARTUP] = { "startup_s", "start-up", "s", NULL, "until every worker stood at the gate" },
	[OB_FIGURE_STARTUP_EACH] = { "startup_s_per_simulator", "start-up per simulator", "s", NULL,
				     "that over objects" },
	[OB_FIGURE_MEMORY] = { "memory_bytes", "memory", "B", NULL,
			       "proportional set size of all processes, and the universe" },
	[OB_FIGURE_MEMORY_EACH] = { "memory_bytes_per_simulator", "memory per simulator", "B", NULL,
				    "that over objects" },
	[OB_FIGURE_MEMORY_WORKER] = { "memory_bytes_per_worker_process", "a worker's process", "B", NULL,
				      "proportional set size of a worker where workers are processes" },
	[OB_FIGURE_PENETRATION] = { "penetration_mean_m", "penetration, end, mean", "m", "Error",
				    "of the pairs that penetrate" },
	[OB_FIGURE_WORST] = { "worst_penetration_m", "penetration, worst", "m", NULL, "at any step" },
	[OB_FIGURE_SEPARATION] = { "separation_mean_m", "separation, end, mean", "m", NULL,
			    "of contacts that carry an impulse" },
	[OB_FIGURE_ENERGY] = { "energy_gain_max", "energy, largest gain", "", NULL,
			       "over the energy at the start, at any step" },
	[OB_FIGURE_MOMENTUM] = { "momentum_error", "momentum error", "", NULL, "of closed scenes only" },
};

// What does not say where a worker's time goes.
static double other_figure(const ob_report *r, ob_figure f)
{
	double steps = (double)r->steps, workers = (double)r->workers, objects = (double)r->objects;
	switch (f) {
	case OB_FIGURE_PER_SIMULATOR:
		return r->cpu_s / r->simulated_s / objects;
	case OB_FIGURE_HOST:
		return r->host_cpu_s / r->simulated_s;
	case OB_FIGURE_RENDERER:
		return r->renderer_cpu_s / r->simulated_s;
	case OB_FIGURE_FPS:
		return r->fps;
	case OB_FIGURE_SWITCHES:
		return (double)r->switches / steps;
	case OB_FIGURE_STARTUP:
		return r->startup_s;
	case OB_FIGURE_STARTUP_EACH:
		return r->startup_s / objects;
	case OB_FIGURE_MEMORY:
		return (double)r->memory_bytes;
	case OB_FIGURE_MEMORY_EACH:
		return (double)r->memory_bytes / objects;
	case OB_FIGURE_MEMORY_WORKER:
		return r->worker_memory_bytes ? (double)r->worker_memory_bytes / workers : NAN;
	case OB_FIGURE_PENETRATION:
		return r->penetration_mean_m;
	case OB_FIGURE_WORST:
		return r->worst_penetration_m;
	case OB_FIGURE_SEPARATION:
		return r->separation_mean_m;
	case OB_FIGURE_ENERGY:
		return r->energy_gain_max;
	case OB_FIGURE_MOMENTUM:
		return r->momentum_error;
	default:
		return NAN;
	}
}

double ob_figure_of(const ob_report *r, ob_figure f)
{
	double steps = (double)r->steps, workers = (double)r->workers;
	switch (f) {
	case OB_FIGURE_COST:
		return 1e-6 * r->body_step_cpu_us;
	case OB_FIGURE_WALL:
		return r->wall_s / r->simulated_s;
	case OB_FIGURE_CPU:
		return r->cpu_s / r->simulated_s;
	case OB_FIGURE_P50:
		return r->step_p50_s;
	case OB_FIGURE_P90:
		return r->step_p90_s;
	case OB_FIGURE_P99:
		return r->step_p99_s;
	case OB_FIGURE_MAX:
		return r->step_max_s;
	case OB_FIGURE_CRITICAL:
		return r->critical_s / steps;
	case OB_FIGURE_WORK:
		return r->work_s / steps;
	case OB_FIGURE_GATE:
		return r->gate_s / steps / workers;
	case OB_FIGURE_GATE_CPU:
		return r->gate_cpu_s / steps;
	case OB_FIGURE_HELD:
		return r->held_s / steps;
	case OB_FIGURE_EXPLAINED:
		return (r->work_s + r->held_s + r->gate_s + r->idle_s) / (workers * r->elapsed_s);
	default:
		return other_figure(r, f);
	}
}

static ob_spread spread(double *x, size_t n)
{
	ob_statistics s = ob_reference_summarise(n, x);
	bool interval = !isnan(s.median_low);
	return (ob_spread){ s.median, interval ? s.median_low : s.least, interval ? s.median_high : s.most, n };
}

ob_spread ob_spread_of(const ob_cell *c, ob_figure f)
{
	double x[OB_REPEATS_MAX];
	size_t n = 0;
	for (uint32_t i = 0; c->state == OB_WAY_DONE && i < c->samples; i++) {
		double value = ob_figure_of(&c->sample[i], f);
		if (!isnan(value))
			x[n++] = value;
	}
	return spread(x, n);
}

ob_spread ob_ratio_of(const ob_cell *of, const ob_cell *to, ob_figure f)
{
	double x[OB_REPEATS_MAX];
	size_t n = 0;
	bool both = of->state == OB_WAY_DONE && to->state == OB_WAY_DONE;
	for (uint32_t i = 0; both && i < of->samples && i < to->samples; i++) {
		double value = ob_figure_of(&of->sample[i], f) / ob_figure_of(&to->sample[i], f);
		if (!isnan(value))
			x[n++] = value;
	}
	return spread(x, n);
}

bool ob_cell_is_done(const ob_section *s, ob_way_id way)
{
	return s->cell[way].state == OB_WAY_DONE;
}

static bool agree(const ob_section *s, bool other_narrow)
{
	const char *hash = NULL;
	for (int w = 0; w < OB_WAYS; w++) {
		const ob_cell *c = &s->cell[w];
		bool monolith = w == OB_WAY_MONOLITH || w == OB_WAY_MONOLITH_OTHER;
		if (c->state != OB_WAY_DONE || monolith || ob_way_table[w].other_narrow != other_narrow)
			continue;
		for (uint32_t i = 0; i < c->samples; i++) {
			hash = hash ? hash : c->sample[i].state_hash;
			if (strcmp(hash, c->sample[i].state_hash) != 0)
				return false;
		}
	}
	return true;
}

bool ob_section_agrees(const ob_section *s)
{
	return agree(s, false) && agree(s, true) && !s->measured_differs;
}
