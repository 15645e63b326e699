#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "cli/quantity.h"
#include "cli/report.h"

static void print_simulators(const ob_report *r, const char *plural, FILE *f)
{
	fprintf(f, "  simulators   one per object in %" PRIu64 " %s%s; ", r->workers, r->isolation, plural);
	if (r->tolerance > 0)
		fprintf(f, "substeps as needed, of up to %" PRIu64 " iterations", r->iterations);
	else
		fprintf(f, "%" PRIu64 " substeps of up to %" PRIu64 " iterations", r->substeps, r->iterations);
	fprintf(f, ", %s, %s\n", r->solver, r->integrator);
}

static void print_tolerance(const ob_report *r, FILE *f)
{
	ob_quantity a, b;
	if (!(r->tolerance > 0))
		return;
	fprintf(f, "  tolerance    %s reached of %s allowed; ", ob_quantity_text(&a, r->error_reached, "m"),
		ob_quantity_text(&b, r->tolerance, "m"));
	if (r->substeps_max)
		fprintf(f, "%" PRIu64 " to %" PRIu64 " substeps, %" PRIu64 " in the median; %" PRIu64 " solved again",
			r->substeps_min, r->substeps_max, r->substeps_median, r->islands_redone);
	else
		fputs("nothing touched", f);
	if (r->islands_over)
		fprintf(f, ", %" PRIu64 " above it all the same", r->islands_over);
	fputc('\n', f);
}

static void print_how(const ob_report *r, FILE *f)
{
	const char *plural = r->workers == 1 ? "" : r->isolation[0] == 't' ? "s" : "es";
	fprintf(f, "%s: %" PRIu64 " objects, %" PRIu64 " steps, %g s simulated", r->scene, r->objects, r->steps,
		r->simulated_s);
	fprintf(f, strcmp(r->outcome, "finished") == 0 ? "\n" : " (%s)\n", r->outcome);
	if (strcmp(r->arch, "monolith") == 0)
		fprintf(f, "  simulators   one ODE world in a %s, %" PRIu64 " substep%s a step\n", r->isolation,
			r->substeps, r->substeps == 1 ? "" : "s");
	else
		print_simulators(r, plural, f);
}

static void print_cost(const ob_report *r, FILE *f)
{
	ob_quantity a, b, c;
	fprintf(f, "  wall         %s, %s per simulated second", ob_quantity_text(&a, r->wall_s, "s"),
		ob_quantity_text(&b, r->wall_s / r->simulated_s, "s"));
	if (r->wall_s > 0 && r->simulated_s > 0)
		fprintf(f, " (%.3g x real time)", r->simulated_s / r->wall_s);
	fprintf(f, "\n  CPU          %s, %s per simulated second, %s per body and step\n",
		ob_quantity_text(&a, r->cpu_s, "s"), ob_quantity_text(&b, r->cpu_s / r->simulated_s, "s"),
		ob_quantity_text(&c, 1e-6 * r->body_step_cpu_us, "s"));
	if (isnan(r->step_p50_s))
		fprintf(f, "  start-up     %s\n", ob_quantity_text(&c, r->startup_s, "s"));
	else
		fprintf(f, "  step         %s in the median, %s at the 99th percentile; start-up %s\n",
			ob_quantity_text(&a, r->step_p50_s, "s"), ob_quantity_text(&b, r->step_p99_s, "s"),
			ob_quantity_text(&c, r->startup_s, "s"));
	fprintf(f, "  memory       %s\n", ob_quantity_text(&a, (double)r->memory_bytes, "B"));
	if (r->deaths > 0)
		fprintf(f, "  deaths       %" PRIu64 "; the state is as it would be without\n", r->deaths);
}

static void print_worth(const ob_report *r, FILE *f)
{
	ob_quantity a, b, c;
	if (r->penetration_max_m > 0)
		fprintf(f, "  penetration  %s mean, %s most at the end",
			ob_quantity_text(&a, r->penetration_mean_m, "m"),
			ob_quantity_text(&b, r->penetration_max_m, "m"));
	else
		fputs("  penetration  none at the end", f);
	if (!isnan(r->worst_penetration_m)) {
		fprintf(f, "; worst %s", ob_quantity_text(&c, r->worst_penetration_m, "m"));
		if (r->worst_penetration_m > 0)
			fprintf(f, " at %.4g s", r->worst_penetration_time_s);
	}
	fprintf(f, "\n  energy       %s at the start, %s at the end", ob_quantity_text(&a, r->energy_start, "J"),
		ob_quantity_text(&b, r->energy_end, "J"));
	if (!isnan(r->energy_gain_max))
		fprintf(f, "; largest gain %.2g", r->energy_gain_max);
	if (!isnan(r->momentum_error))
		fprintf(f, "; momentum error %.2g", r->momentum_error);
	fprintf(f, "\n  state        %s\n", r->state_hash);
}

void ob_report_print(const ob_report *r, FILE *f)
{
	print_how(r, f);
	print_tolerance(r, f);
	if (r->steps > 0)
		print_cost(r, f);
	print_worth(r, f);
	if (r->frame_rate > 0) {
		fprintf(f, "  frames       %" PRIu64, r->frames);
		if (r->fps > 0)
			fprintf(f, ", %.3g per second", r->fps);
		fputc('\n', f);
	}
	if (r->trace_events > 0) {
		fprintf(f, "  trace        %" PRIu64 " events", r->trace_events);
		if (r->trace_lost > 0)
			fprintf(f, ", %" PRIu64 " of them LOST, for they came faster than they could be written",
				r->trace_lost);
		fputc('\n', f);
	}
}
