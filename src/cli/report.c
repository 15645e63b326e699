#include "cli/report.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"

// One list for the writer and the reader; its names are a promise to scripts.
static const struct field {
	const char *key;
	enum kind { TEXT, COUNT, REAL } kind;
	size_t offset, size;
	const char *unit; // "" = none
} fields[] = {
// clang-format off
#define FIELD(kind, member, unit) \
	{ #member, kind, offsetof(ob_report, member), sizeof(((ob_report *)0)->member), unit }
	// clang-format on
	FIELD(TEXT, scene, ""),
	FIELD(TEXT, outcome, ""),
	FIELD(TEXT, arch, ""),
	FIELD(TEXT, isolation, ""),
	FIELD(COUNT, workers, ""),
	FIELD(COUNT, objects, ""),
	FIELD(COUNT, bodies, ""),
	FIELD(REAL, step, "s"),
	FIELD(COUNT, steps, ""),
	FIELD(COUNT, substeps, ""),
	FIELD(REAL, tolerance, "m"),
	FIELD(REAL, error_reached, "m"),
	FIELD(COUNT, substeps_min, ""),
	FIELD(COUNT, substeps_median, ""),
	FIELD(COUNT, substeps_max, ""),
	FIELD(COUNT, islands_redone, ""),
	FIELD(COUNT, islands_over, ""),
	FIELD(COUNT, iterations, ""),
	FIELD(TEXT, solver, ""),
	FIELD(COUNT, lag, ""),
	FIELD(TEXT, integrator, ""),
	FIELD(TEXT, narrow, ""),
	FIELD(COUNT, load, ""),
	FIELD(COUNT, box_tests, ""),
	FIELD(COUNT, seed, ""),
	FIELD(REAL, simulated_s, "s"),
	FIELD(REAL, wall_s, "s"),
	FIELD(REAL, cpu_s, "s"),
	FIELD(REAL, total_s, "s"),
	FIELD(REAL, body_step_cpu_us, "us"),
	FIELD(REAL, startup_s, "s"),
	FIELD(REAL, step_p50_s, "s"),
	FIELD(REAL, step_p90_s, "s"),
	FIELD(REAL, step_p99_s, "s"),
	FIELD(REAL, step_max_s, "s"),
	FIELD(REAL, critical_s, "s"),
	FIELD(REAL, work_s, "s"),
	FIELD(REAL, held_s, "s"),
	FIELD(REAL, gate_s, "s"),
	FIELD(REAL, gate_cpu_s, "s"),
	FIELD(REAL, idle_s, "s"),
	FIELD(REAL, elapsed_s, "s"),
	FIELD(REAL, host_cpu_s, "s"),
	FIELD(REAL, renderer_cpu_s, "s"),
	FIELD(COUNT, switches, ""),
	FIELD(COUNT, deaths, ""),
	FIELD(COUNT, worker_memory_bytes, "B"),
	FIELD(COUNT, memory_bytes, "B"),
	FIELD(TEXT, state_hash, ""),
	FIELD(REAL, energy_start, "J"),
	FIELD(REAL, energy_end, "J"),
	FIELD(REAL, energy_gain_max, ""),
	FIELD(REAL, energy_recovered, "J"),
	FIELD(REAL, momentum_error, ""),
	FIELD(REAL, penetration_max_m, "m"),
	FIELD(REAL, penetration_mean_m, "m"),
	FIELD(REAL, worst_penetration_m, "m"),
	FIELD(REAL, worst_penetration_time_s, "s"),
	FIELD(REAL, separation_max_m, "m"),
	FIELD(REAL, separation_mean_m, "m"),
	FIELD(COUNT, frames, ""),
	FIELD(REAL, frame_rate, "1/s"),
	FIELD(REAL, fps, "1/s"),
	FIELD(COUNT, trace_events, ""),
	FIELD(COUNT, trace_lost, ""),
	FIELD(TEXT, commit, ""),
#undef FIELD
};
enum { FIELDS = sizeof fields / sizeof *fields };

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
}

void ob_report_write_json(const ob_report *r, FILE *f)
{
	ob_json j = { .f = f };
	ob_json_open(&j, NULL);
	ob_report_write_members(r, &j);
	ob_json_close(&j);
}

bool ob_report_read_json(ob_report *r, const char *text)
{
	for (int i = 0; i < FIELDS; i++) {
		const struct field *f = &fields[i];
		const char *value = ob_json_find(text, f->key);
		char *to = (char *)r + f->offset, *end = NULL;
		if (!value)
			return false;
		if (f->kind == TEXT) {
			if (!ob_json_read_string(value, to, f->size))
				return false;
			continue;
		}
		if (f->kind == COUNT)
			*(uint64_t *)to = strtoull(value, &end, 10);
		else if (strncmp(value, "null", 4) == 0)
			*(double *)to = NAN;
		else
			*(double *)to = strtod(value, &end);
		if (end == value)
			return false;
	}
	return true;
}

void ob_report_write_csv(const ob_report *r, FILE *f)
{
	fputs("quantity,value,unit\n", f);
	ob_csv c = { .f = f };
	for (int i = 0; i < FIELDS; i++) {
		const struct field *field = &fields[i];
		const char *at = (const char *)r + field->offset;
		ob_csv_text(&c, field->key);
		if (field->kind == TEXT)
			ob_csv_text(&c, at);
		else if (field->kind == COUNT)
			ob_csv_count(&c, *(const uint64_t *)at);
		else
			ob_csv_number(&c, isfinite(*(const double *)at) ? *(const double *)at : NAN);
		ob_csv_text(&c, field->unit);
		ob_csv_end(&c);
	}
}
