#include "cli/report.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"
#include "cli/quantity.h"
#include "shape/shape.h"

static const struct field {
	const char *key;
	enum kind { TEXT, COUNT, REAL } kind;
	size_t offset;
} fields[] = {
#define FIELD_OF(kind, member) { #member, kind, offsetof(ob_report, member) },
#define TEXT_FIELD(member, bytes) FIELD_OF(TEXT, member)
#define COUNT_FIELD(member) FIELD_OF(COUNT, member)
#define REAL_FIELD(member) FIELD_OF(REAL, member)
	OB_REPORT_MEMBERS(TEXT_FIELD, COUNT_FIELD, REAL_FIELD)
};
enum { FIELDS = sizeof fields / sizeof *fields };

static void write_death(const ob_death *d, ob_json *j)
{
	static const char *const causes[OB_DEATH_CAUSES] = { "signal", "exit", "stall", "damage", "failure" };
	ob_json_open(j, NULL);
	ob_json_string(j, "cause", causes[d->cause]);
	ob_json_count(j, "step", d->step);
	if (d->worker != OB_NO_WORKER)
		ob_json_count(j, "simulator", d->worker);
	if (d->pid)
		ob_json_count(j, "process", (uint64_t)d->pid);
	if (d->cause == OB_DEATH_SIGNAL)
		ob_json_count(j, "signal", (uint64_t)d->signal);
	if (d->cause == OB_DEATH_EXIT)
		ob_json_count(j, "exit_code", (uint64_t)d->code);
	if (d->object != OB_NO_OBJECT) {
		ob_json_count(j, "object", d->object);
		ob_json_string(j, "name", d->name);
	}
	ob_json_string(j, "what", d->text);
	ob_json_string(j, "last_words", d->words);
	ob_json_count(j, "frozen", d->frozen);
	ob_json_close(j);
}

static void write_script_error(const ob_script_error *e, ob_json *j)
{
	ob_json_open(j, NULL);
	ob_json_count(j, "step", e->step);
	ob_json_count(j, "object", e->object);
	ob_json_string(j, "name", e->name);
	ob_json_string(j, "what", e->text);
	ob_json_close(j);
}

static void write_expectation(const ob_expectation *x, ob_json *j)
{
	ob_json_open(j, NULL);
	ob_json_string(j, "name", x->name);
	ob_json_number(j, "value", x->value);
	ob_json_number(j, "below", x->limit);
	ob_json_string(j, "unit", x->unit);
	ob_json_string(j, "source", x->source);
	ob_json_true(j, "met", ob_expectation_is_met(x));
	ob_json_close(j);
}

bool ob_report_missed_expectation(const ob_report *r)
{
	const ob_expected *x = r->expected;
	bool missed = x && *x->failed;
	for (uint32_t i = 0; x && x->ended && i < x->count; i++)
		missed |= !ob_expectation_is_met(&x->expectation[i]);
	return missed;
}

// A line for each expectation, and one for a failure.
static void print_expected(const ob_expected *x, FILE *f)
{
	if (x && x->count && !x->ended)
		fputs("  expected     not judged: that takes all of the run, and --set measure=step\n", f);
	for (uint32_t i = 0; x && x->ended && i < x->count; i++) {
		const ob_expectation *one = &x->expectation[i];
		const char *unit = strcmp(one->unit, "1") == 0 ? "" : one->unit, *space = *unit ? " " : "";
		fprintf(f, "  %-12s %s %.3g%s%s", i ? "" : "expected", one->name, one->value, space, unit);
		if (!isnan(one->limit))
			fprintf(f, ", at most %g%s%s: %s", one->limit, space, unit,
				ob_expectation_is_met(one) ? "met" : "MISSED");
		fprintf(f, *one->source ? " (%s)\n" : "\n", one->source);
	}
	if (x && *x->failed)
		fprintf(f, "  failed       %s\n", x->failed);
}

void ob_report_write_members(const ob_report *r, ob_json *j)
{
	for (int i = 0; i < FIELDS; i++) {
		const struct field *f = &fields[i];
		const char *at = (const char *)r + f->offset;
		if (f->kind == TEXT)
			ob_json_string(j, f->key, at);
		else if (f->kind == COUNT)
			ob_json_count(j, f->key, *(const uint64_t *)at);
		else
			ob_json_number(j, f->key, *(const double *)at);
	}
	if (r->deaths_told) {
		ob_json_open_list(j, "death_list");
		for (uint32_t i = 0; i < r->deaths_told; i++)
			write_death(&r->death[i], j);
		ob_json_close_list(j);
	}
	if (r->expected && r->expected->ended) {
		ob_json_string(j, "failed", r->expected->failed);
		ob_json_open_list(j, "expectations");
		for (uint32_t i = 0; i < r->expected->count; i++)
			write_expectation(&r->expected->expectation[i], j);
		ob_json_close_list(j);
	}
	if (r->script_errors_told) {
		ob_json_open_list(j, "script_errors");
		for (uint32_t i = 0; i < r->script_errors_told; i++)
			write_script_error(&r->script_error[i], j);
		ob_json_close_list(j);
	}
}

void ob_report_write_json(const ob_report *r, FILE *f)
{
	ob_json j = { .f = f };
	ob_json_open(&j, NULL);
	ob_report_write_members(r, &j);
	ob_json_close(&j);
}

// Smallest number of substeps with which at least this share of the island-steps were solved.
static uint64_t quantile(const ob_counters *c, double share)
{
	uint64_t all = 0, sum = 0;
	for (int i = 0; i < OB_SUBSTEP_CHOICES; i++)
		all += c->chosen[i];
	for (int i = 0; i < OB_SUBSTEP_CHOICES; i++) {
		sum += c->chosen[i];
		if (sum > 0 && (double)sum >= share * (double)all)
			return UINT64_C(1) << i;
	}
	return 0;
}

static uint64_t sum_of(const uint32_t *count, int n)
{
	uint64_t sum = 0;
	for (int i = 0; i < n; i++)
		sum += count[i];
	return sum;
}

// Error (m) that this share of those counted in bins does not exceed: the end of a bin, at most the largest.
static double error_quantile(const uint32_t bin[OB_ERROR_BINS], double share, double largest)
{
	const uint64_t all = sum_of(bin, OB_ERROR_BINS);
	uint64_t sum = 0;
	int i = 0;
	while (i + 1 < OB_ERROR_BINS && (double)(sum += bin[i]) < share * (double)all)
		i++;
	return all ? fmin(largest, ldexp(1, OB_ERROR_LEAST_EXPONENT + i + 1)) : NAN;
}

static bool is_monolith(const ob_report *r)
{
	return strcmp(r->arch, "monolith") == 0;
}

// Share of the errors of a second that are certainly below the tolerance.
static double share_below(const uint32_t bin[OB_ERROR_BINS], double tolerance)
{
	uint64_t sum = 0;
	for (int i = 0; i < OB_ERROR_BINS && ldexp(1, OB_ERROR_LEAST_EXPONENT + i + 1) <= tolerance; i++)
		sum += bin[i];
	return (double)sum / (double)sum_of(bin, OB_ERROR_BINS);
}

static void count_verified(ob_report *r, const ob_counters *c)
{
	const uint32_t *step = c->verified_step, *second = c->verified_second;
	const double most = c->verified_most[0], most_of_second = c->verified_most[1];
	r->verified_steps = sum_of(step, OB_ERROR_BINS);
	r->unverified_steps = c->unverified;
	r->verified_p50_m = error_quantile(step, .5, most);
	r->verified_p90_m = error_quantile(step, .9, most);
	r->verified_p99_m = error_quantile(step, .99, most);
	r->verified_max_m = r->verified_steps ? most : NAN;
	r->verified_second_p50_m = error_quantile(second, .5, most_of_second);
	r->verified_second_p90_m = error_quantile(second, .9, most_of_second);
	r->verified_second_p99_m = error_quantile(second, .99, most_of_second);
	r->verified_second_max_m = r->verified_steps ? most_of_second : NAN;
	r->verified_share = r->verified_steps && r->tolerance > 0 ? share_below(second, r->tolerance) : NAN;
}

static double work_of(const ob_counters *c)
{
	double sum = 0;
	for (int i = 0; i < OB_PROFILE_SECTIONS; i++)
		sum += 1e-9 * (double)c->time_ns[i];
	return sum;
}

static void count_fault(ob_report *r, uint32_t kind, uint64_t times)
{
	const char *name = OB_FAULT_NAMES;
	while (kind-- > 0)
		name += strcspn(name, "|") + 1;
	size_t n = strlen(r->fault_kinds);
	if (times > 0)
		snprintf(r->fault_kinds + n, sizeof r->fault_kinds - n, "%s%.*s %" PRIu64, n ? ", " : "",
			 (int)strcspn(name, "|"), name, times);
	r->faults += times;
}

void ob_report_faults(ob_report *r, const uint64_t faults[OB_FAULT_KINDS], uint32_t overwritten)
{
	r->faults_overwritten = overwritten;
	for (uint32_t i = 0; i < OB_FAULT_KINDS; i++)
		count_fault(r, i, faults[i]);
}

void ob_report_count(ob_report *r, const ob_counters *c, bool timed)
{
	bool chosen = r->tolerance > 0;
	r->error_reached = chosen ? c->error : NAN;
	r->depth_reached = chosen ? c->depth : NAN;
	r->creep_reached = chosen ? c->creep : NAN;
	r->bounce_reached = chosen ? c->bounce : NAN;
	r->deviation_reached = chosen ? c->deviation : NAN;
	r->unbounded_steps = c->unbounded;
	r->estimates = c->estimates;
	r->substeps_min = quantile(c, 0);
	r->substeps_median = quantile(c, .5);
	r->substeps_max = quantile(c, 1);
	r->islands_redone = c->islands_redone;
	r->islands_over = c->islands_over;
	count_verified(r, c);
	r->energy_recovered = is_monolith(r) ? NAN : c->recovered;
	r->box_tests = c->box_tests;
	r->work_s = timed ? work_of(c) : NAN;
	r->held_s = timed ? 1e-9 * (double)c->held_ns : NAN;
	r->gate_cpu_s = timed ? 1e-9 * (double)c->gate_cpu_ns : NAN;
}

static bool is_free(const ob_report *r)
{
	return strcmp(r->sync, "free") == 0;
}

static const char *plural_of_workers(const ob_report *r)
{
	return r->workers == 1 ? "" : r->isolation[0] == 't' ? "s" : "es";
}

static void print_simulators(const ob_report *r, FILE *f)
{
	fprintf(f, "  simulators   one per object in %" PRIu64 " %s%s; ", r->workers, r->isolation,
		plural_of_workers(r));
	if (r->tolerance > 0)
		fprintf(f, "substeps as needed, of up to %" PRIu64 " iterations", r->iterations);
	else
		fprintf(f, "%" PRIu64 " substeps of up to %" PRIu64 " iterations", r->substeps, r->iterations);
	fprintf(f, ", %s, %s\n", r->solver, r->integrator);
}

bool ob_report_missed_tolerance(const ob_report *r)
{
	return r->tolerance > 0 && r->islands_over > 0;
}

bool ob_report_motion_is_bounded(const ob_report *r)
{
	return !(r->tolerance > 0) || (r->unbounded_steps == 0 && !(r->verified_share < 1));
}

// The cause of the largest error.
static const char *cause_of(const ob_report *r)
{
	return r->error_reached == 0                  ? ""
	       : r->error_reached == r->depth_reached ? " of depth"
	       : r->error_reached == r->creep_reached ? " of creep"
						      : " of a bounce";
}

// States for how much of the time of objects motion is bounded, too, and what the rest is worth; after "begin".
static void print_motion(const ob_report *r, const char *begin, FILE *f)
{
	ob_quantity a, b;
	if (!(r->tolerance > 0) || isnan(r->bounded_share))
		return;
	fprintf(f, "%swithin %s a second", begin, ob_quantity_text(&a, r->tolerance, "m"));
	if (r->unbounded_steps > 0)
		fprintf(f, " for %.3g %% of the time of objects, else one of many that may come, up to %s apart",
			100 * r->bounded_share, ob_quantity_text(&b, r->deviation_reached, "m"));
}

// The verdict, which the short and the full report begin with.
static void print_verdict(const ob_report *r, FILE *f)
{
	ob_quantity a, b;
	fprintf(f, "%s %s, the largest error was %s%s", ob_quantity_text(&a, r->tolerance, "m"),
		ob_report_missed_tolerance(r) ? "MISSED" : "kept", ob_quantity_text(&b, r->error_reached, "m"),
		cause_of(r));
}

static void print_tolerance(const ob_report *r, FILE *f)
{
	if (!(r->tolerance > 0))
		return;
	fputs("  tolerance    ", f);
	print_verdict(r, f);
	if (r->substeps_max)
		fprintf(f, "; %" PRIu64 " to %" PRIu64 " substeps, %" PRIu64 " in the median; %" PRIu64 " solved again",
			r->substeps_min, r->substeps_max, r->substeps_median, r->islands_redone);
	else
		fputs("; nothing touched", f);
	if (r->islands_over)
		fprintf(f, ", %" PRIu64 " above it all the same", r->islands_over);
	fputc('\n', f);
}

static void print_verified(const ob_report *r, FILE *f)
{
	ob_quantity a, b, c, d;
	if (!r->verified_steps && !r->unverified_steps)
		return;
	fprintf(f, "  verified     %" PRIu64 " body steps with %d substeps", r->verified_steps, OB_VERIFY_SUBSTEPS);
	if (r->verified_steps)
		fprintf(f, ": errors of a step %s in the median, %s at 99 %%, %s most; of a second %s in the median",
			ob_quantity_text(&a, r->verified_p50_m, "m"), ob_quantity_text(&b, r->verified_p99_m, "m"),
			ob_quantity_text(&c, r->verified_max_m, "m"),
			ob_quantity_text(&d, r->verified_second_p50_m, "m"));
	if (!isnan(r->verified_share))
		fprintf(f, ", %.3g %% within the tolerance", 100 * r->verified_share);
	if (r->unverified_steps)
		fprintf(f, "; %" PRIu64 " take too much work", r->unverified_steps);
	fputc('\n', f);
}

static void print_run(const ob_report *r, FILE *f)
{
	char scene[sizeof r->scene];
	memcpy(scene, r->scene, sizeof scene);
	ob_utf8_make_plain(scene); // a file's name may hold any bytes
	fprintf(f, "%s: %" PRIu64 " objects, %" PRIu64 " steps, %g s simulated", scene, r->objects, r->steps,
		r->simulated_s);
	if (!isnan(r->resumed_s))
		fprintf(f, ", resumed at %g s", r->resumed_s);
	fprintf(f, strcmp(r->outcome, "finished") == 0 ? "\n" : " (%s)\n", r->outcome);
}

static void print_setup(const ob_report *r, FILE *f)
{
	if (is_monolith(r))
		fprintf(f, "  simulators   one ODE world in a %s, %" PRIu64 " substep%s a step\n", r->isolation,
			r->substeps, r->substeps == 1 ? "" : "s");
	else
		print_simulators(r, f);
}

// Time (s) that this process simulated
static double own_time(const ob_report *r)
{
	return isnan(r->resumed_s) ? r->simulated_s : r->simulated_s - r->resumed_s;
}

static void print_cost(const ob_report *r, FILE *f)
{
	ob_quantity a, b, c;
	const double simulated = own_time(r);
	fprintf(f, "  wall         %s, %s per simulated second", ob_quantity_text(&a, r->wall_s, "s"),
		ob_quantity_text(&b, r->wall_s / simulated, "s"));
	if (r->wall_s > 0)
		fprintf(f, " (%.3g x real time)", simulated / r->wall_s);
	fprintf(f, "\n  CPU          %s of the simulators, %s per simulated second",
		ob_quantity_text(&a, r->cpu_s, "s"), ob_quantity_text(&b, r->cpu_s / simulated, "s"));
	if (isfinite(r->body_step_cpu_us))
		fprintf(f, ", %s per body and step", ob_quantity_text(&c, 1e-6 * r->body_step_cpu_us, "s"));
	if (r->frames > 0)
		fprintf(f, "; drawing took %s besides", ob_quantity_text(&a, r->renderer_cpu_s, "s"));
	fputc('\n', f);
	if (isnan(r->step_p50_s))
		fprintf(f, "  start-up     %s\n", ob_quantity_text(&c, r->startup_s, "s"));
	else
		fprintf(f, "  step         %s in the median, %s at the 99th percentile; start-up %s\n",
			ob_quantity_text(&a, r->step_p50_s, "s"), ob_quantity_text(&b, r->step_p99_s, "s"),
			ob_quantity_text(&c, r->startup_s, "s"));
	fprintf(f, "  memory       %s\n", ob_quantity_text(&a, (double)r->memory_bytes, "B"));
}

static void print_scripts(const ob_report *r, FILE *f)
{
	enum { SHOWN = 4 };
	if (r->scripts_stopped + r->scripts_warned == 0)
		return;
	fprintf(f, "  scripts      %" PRIu64 " stopped by an error, %" PRIu64 " with something in vain\n",
		r->scripts_stopped, r->scripts_warned);
	for (uint32_t i = 0; i < r->script_errors_told && i < SHOWN; i++) {
		const ob_script_error *e = &r->script_error[i];
		fprintf(f, "               object %u (%s) in step %" PRIu64 ": %s\n", e->object, e->name, e->step,
			e->text);
	}
	if (r->script_errors_told && r->scripts_stopped > SHOWN)
		fprintf(f, "               and %" PRIu64 " more\n", r->scripts_stopped - SHOWN);
}

// Lines of what a run should not have: deaths, injected faults, scripts that stopped, lost events; and of --set verify=on.
static void print_exceptions(const ob_report *r, FILE *f)
{
	print_verified(r, f);
	if (r->frozen > 0)
		fprintf(f, "  deaths       %" PRIu64 "; %" PRIu64 " object%s frozen since then\n", r->deaths, r->frozen,
			r->frozen == 1 ? "" : "s");
	else if (r->deaths > 0)
		fprintf(f, "  deaths       %" PRIu64 "%s\n", r->deaths,
			strcmp(r->outcome, "failed") == 0 ? ""
			: is_free(r)                      ? "; each simulator went on where it had published"
							  : "; the state is as it would be without");
	if (r->faults > 0 || r->faults_overwritten > 0)
		fprintf(f, "  faults       %s%" PRIu64 " injected%s%s%s\n", r->faults_overwritten ? "at least " : "",
			r->faults, *r->fault_kinds ? ": " : "", r->fault_kinds,
			r->faults_overwritten ? "; simulators have written over other counters of them" : "");
	print_scripts(r, f);
	if (r->trace_lost > 0)
		fprintf(f,
			"  trace        %" PRIu64 " of %" PRIu64
			" events LOST, for they came faster than they could be written\n",
			r->trace_lost, r->trace_events);
}

static void print_quality(const ob_report *r, FILE *f)
{
	ob_quantity a, b, c;
	if (r->penetration_max_m > 0)
		fprintf(f, "  penetration  %s mean, %s most at the end",
			ob_quantity_text(&a, r->penetration_mean_m, "m"),
			ob_quantity_text(&b, r->penetration_max_m, "m"));
	else
		fprintf(f, "  penetration  %s at the end", isnan(r->penetration_max_m) ? "not measured" : "none");
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
	fputc('\n', f);
}

static void print_free(const ob_report *r, FILE *f)
{
	ob_quantity a, b, c;
	if (strcmp(r->coupling, "group") == 0) {
		fprintf(f, "  free         %g Hz, coupling group; %.0f updates, %.0f waits\n", r->update_rate,
			r->updates, r->waits);
		return;
	}
	fprintf(f, "  free         %g Hz, coupling %s, lag of at most %s; %.0f updates\n", r->update_rate, r->coupling,
		isnan(r->max_lag) ? "any size" : ob_quantity_text(&a, r->max_lag, "s"), r->updates);
	fprintf(f, "  lag          %s in the mean, %s most; %.0f waits, %s together\n",
		ob_quantity_text(&a, r->lag_mean_s, "s"), ob_quantity_text(&b, r->lag_max_s, "s"), r->waits,
		ob_quantity_text(&c, r->wait_s, "s"));
}

// One line each: the error, the speed, the simulators.
static void print_short(const ob_report *r, FILE *f)
{
	ob_quantity a;
	fputs("  error        ", f);
	if (r->tolerance > 0)
		print_verdict(r, f);
	else if (isnan(r->worst_penetration_m))
		fputs("no tolerance, and penetration was not measured", f);
	else
		fprintf(f, "no tolerance; the worst penetration was %s",
			ob_quantity_text(&a, r->worst_penetration_m, "m"));
	print_motion(r, "; motion is ", f);
	if (own_time(r) > 0 && r->wall_s > 0)
		fprintf(f, "\n  speed        %.3g x real time", own_time(r) / r->wall_s);
	if (own_time(r) > 0 && isfinite(r->body_step_cpu_us))
		fprintf(f, ", %s of CPU per body and step", ob_quantity_text(&a, 1e-6 * r->body_step_cpu_us, "s"));
	if (is_monolith(r))
		fprintf(f, "\n  simulators   none: one ODE world in a %s\n", r->isolation);
	else
		fprintf(f, "\n  simulators   %" PRIu64 ", one per object that moves, in %" PRIu64 " %s%s%s\n",
			r->bodies, r->workers, r->isolation, plural_of_workers(r), is_free(r) ? ", free" : "");
}

static void print_full(const ob_report *r, FILE *f)
{
	ob_quantity bytes, held;
	print_tolerance(r, f);
	print_motion(r, "  motion       ", f);
	if (r->tolerance > 0 && !isnan(r->bounded_share))
		fputc('\n', f);
	print_setup(r, f);
	if (is_free(r))
		print_free(r, f);
	if (own_time(r) > 0)
		print_cost(r, f);
	print_quality(r, f);
	if (r->frame_rate > 0) {
		fprintf(f, "  frames       %" PRIu64, r->frames);
		if (r->fps > 0)
			fprintf(f, ", %.3g per second", r->fps);
		fputc('\n', f);
	}
	if (r->checkpoints > 0)
		fprintf(f, "  checkpoints  %" PRIu64 " of %s; they held the run up for %s\n", r->checkpoints,
			ob_quantity_text(&bytes, (double)r->checkpoint_bytes, "B"),
			ob_quantity_text(&held, r->checkpoint_s, "s"));
	if (r->trace_events > 0)
		fprintf(f, "  trace        %" PRIu64 " events\n", r->trace_events);
}

void ob_report_print(const ob_report *r, bool full, FILE *f)
{
	print_run(r, f);
	(full ? print_full : print_short)(r, f);
	print_exceptions(r, f);
	print_expected(r->expected, f);
	fprintf(f, "  state        %s\n", r->state_hash);
}

// ---- explain

// Prints one line: an item and its description.
__attribute__((format(printf, 3, 4))) static void line(FILE *f, const char *thing, const char *format, ...)
{
	va_list list;
	va_start(list, format);
	fprintf(f, "    %-12s ", thing);
	vfprintf(f, format, list);
	fputc('\n', f);
	va_end(list);
}

// Traits of the scene's objects that a part of the step would have to model.
typedef struct traits {
	uint32_t bodies, round, rough, elastic, forced, varying;
} traits;

static traits traits_of(const ob_scene *s)
{
	traits t = { 0 };
	for (uint32_t i = 0; i < s->objects; i++) {
		const ob_passport *p = &s->object[i].passport;
		bool moves = !(p->flags & OB_OBJECT_PRESCRIBED);
		t.bodies += moves;
		t.round += moves && ob_shape_is(p->shape, OB_ISOTROPIC);
		t.forced += moves && ob_norm2(p->force) > 0;
		t.varying += s->object[i].force != NULL;
		t.rough += p->friction > 0;
		t.elastic += p->restitution > 0;
	}
	return t;
}

static void explain_motion(const ob_explained *x, const traits *t, FILE *f)
{
	const ob_counters *c = &x->counters;
	uint64_t awake = c->ballistic_advances + c->body_steps;
	double asleep = x->body_steps - (double)awake;
	bool exact = x->settings->integrator == OB_INTEGRATOR_EXACT;
	if (c->ballistic_advances)
		line(f, "flight", "%s: %" PRIu64 " steps of objects that touched nothing",
		     exact ? "closed form, no substeps" : "ODE's stepper", c->ballistic_advances);
	else
		line(f, "flight", "none: no object was ever alone");
	if (c->body_steps)
		line(f, "substeps", "%.3g a step, for %" PRIu64 " steps of objects that touched, or might have",
		     (double)c->body_substeps / (double)c->body_steps, c->body_steps);
	else
		line(f, "substeps", "none: nothing came near anything");
	if (!x->settings->sleeping)
		line(f, "sleep", "none: it is switched off");
	else if (asleep > .5)
		line(f, "sleep", "%.0f steps of objects were not computed at all", asleep);
	else
		line(f, "sleep", "none: no island was ever at rest for long enough");
	if (c->gyroscopic_steps)
		line(f, "gyroscope",
		     "Euler's equations in %" PRIu64
		     " substeps of objects that turned while they touched or were joined",
		     c->gyroscopic_steps);
	else if (!exact)
		line(f, "gyroscope", "ODE's own");
	else
		line(f, "gyroscope", "none: %s",
		     t->round == t->bodies ? "all are spheres" : "nothing that touched or was joined turned");
	if (t->forced)
		line(f, "forces", "constant ones on %" PRIu32 " objects", t->forced);
	if (t->varying)
		line(f, "varying", "forces that change in time on %" PRIu32 " objects: energy is put in and taken out",
		     t->varying);
}

static void explain_contact(const ob_explained *x, const traits *t, FILE *f)
{
	const ob_counters *c = &x->counters;
	if (c->narrowphase_tests)
		line(f, "collision",
		     "%" PRIu64 " tests of pairs; %" PRIu64 " of them followed the pair through its substep",
		     c->narrowphase_tests, c->swept_tests);
	else
		line(f, "collision", "none: no two boxes came near each other");
	if (c->pair_solves)
		line(f, "contact", "%" PRIu64 " solves of pairs in %" PRIu64 " iterations; %" PRIu64 " direct solves",
		     c->pair_solves, c->solver_iterations, c->direct_solves);
	else
		line(f, "contact", "none: nothing touched");
	if (!t->rough)
		line(f, "friction", "none: no object has any");
	else if (c->pair_solves > c->frictionless_solves)
		line(f, "friction", "Coulomb's cone in %" PRIu64 " solves; %" PRIu64 " without rows for it",
		     c->pair_solves - c->frictionless_solves, c->frictionless_solves);
	else
		line(f, "friction", "none: no two rough objects touched");
	if (!t->elastic)
		line(f, "restitution", "none: no object has any; %" PRIu64 " plastic impacts at their own instants",
		     c->impacts);
	else
		line(f, "restitution", "%" PRIu64 " impacts at their own instants, in %" PRIu64 " iterations",
		     c->impacts, c->impact_iterations);
	line(f, "recovery", "%.3g J of potential energy, from pushing penetrations apart", c->recovered);
	if (x->settings->tolerance > 0)
		line(f, "tolerance", "%" PRIu64 " islands were solved, %" PRIu64 " solutions rejected as too coarse",
		     c->island_steps, c->islands_redone);
	else
		line(f, "tolerance", "none: every island takes %" PRIu32 " substeps", x->settings->substeps);
}

static void explain_rest(const ob_run_request *q, const ob_scene *scene, FILE *f)
{
	line(f, "renderer", q->frames.wanted ? "frames were asked for" : "none: no frames were asked for");
	line(f, "recorder", q->record ? "--record" : "none: nothing was to be recorded");
	line(f, "measuring",
	     q->asked.measure == OB_MEASURE_STEPS ? "energy, momentum and penetration of each step (--set measure=step)"
						  : "only of the start and the end (--set measure)");
	line(f, "Lua",
	     scene->scripts ? "objects' scripts, when they are due" : "none: it ended when the scene had been read");
	line(f, "one world", "none: each object is a simulator of its own");
}

static void print_costs(const ob_explained *x, FILE *f)
{
	static const char *const what[OB_PROFILE_SECTIONS] = {
		[OB_PROFILE_BROADPHASE] = "broad-phase queries",
		[OB_PROFILE_SCHEDULE] = "pairs, islands, and their workers",
		[OB_PROFILE_BALLISTIC] = "closed forms of flight",
		[OB_PROFILE_LOAD] = "islands out of the universe, and back",
		[OB_PROFILE_NARROWPHASE] = "collision tests",
		[OB_PROFILE_IMPACTS] = "impacts",
		[OB_PROFILE_SOLVE] = "iterations of the contact solver",
		[OB_PROFILE_MOVE] = "turning, predicting, displacing",
		[OB_PROFILE_PROJECT] = "penetrations pushed apart",
		[OB_PROFILE_PUBLISH] = "publication of motions",
		[OB_PROFILE_SCRIPTS] = "objects' scripts",
		[OB_PROFILE_ESTIMATE] = "steps solved again to estimate their errors",
		[OB_PROFILE_VERIFY] = "steps solved again to know their errors",
	};
	double rest = x->cpu_s;
	ob_quantity q;
	for (int i = 0; i < OB_PROFILE_SECTIONS; i++) {
		double s = 1e-9 * (double)x->counters.time_ns[i];
		rest -= s;
		fprintf(f, "    %-11s %10s %5.1f %%  %s\n", ob_profile_name((uint32_t)i), ob_quantity_text(&q, s, "s"),
			100 * s / x->cpu_s, what[i]);
	}
	rest = fmax(0, rest);
	fprintf(f, "    %-11s %10s %5.1f %%  waiting for each other, and the cost of these clocks\n", "gate",
		ob_quantity_text(&q, rest, "s"), 100 * rest / x->cpu_s);
}

void ob_explain_print(const ob_explained *x, FILE *f)
{
	const traits t = traits_of(x->scene);
	ob_quantity q;
	fputs("  what was modelled, and what was not\n", f);
	explain_motion(x, &t, f);
	explain_contact(x, &t, f);
	explain_rest(x->request, x->scene, f);
	fprintf(f, "  what it cost: %s of CPU\n", ob_quantity_text(&q, x->cpu_s, "s"));
	print_costs(x, f);
}
