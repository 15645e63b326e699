#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "cli/compare.h"
#include "cli/quantity.h"
#include "cli/version.h"

static const struct row {
	const char *label;
	size_t offset; // of a double in ob_report
	const char *unit; // "" = a bare ratio
	double scale; // to that unit
	bool per_second; // of simulated time
} rows[] = {
	{ "wall per simulated s", offsetof(ob_report, wall_s), "s", 1, true },
	{ "CPU per simulated s", offsetof(ob_report, cpu_s), "s", 1, true },
	{ "CPU per body and step", offsetof(ob_report, body_step_cpu_us), "s", 1e-6, false },
	{ "step, median", offsetof(ob_report, step_p50_s), "s", 1, false },
	{ "step, 99 %", offsetof(ob_report, step_p99_s), "s", 1, false },
	{ "start-up", offsetof(ob_report, startup_s), "s", 1, false },
	{ "penetration, end, mean", offsetof(ob_report, penetration_mean_m), "m", 1, false },
	{ "penetration, end, most", offsetof(ob_report, penetration_max_m), "m", 1, false },
	{ "penetration, worst", offsetof(ob_report, worst_penetration_m), "m", 1, false },
	{ "energy, largest gain", offsetof(ob_report, energy_gain_max), "", 1, false },
	{ "momentum error", offsetof(ob_report, momentum_error), "", 1, false },
};

enum { LABEL_WIDTH = 24, COLUMN_WIDTH = 14, HASH_DIGITS = 12 };

static bool done(const ob_comparison *c, int i)
{
	return c->result[i].state == OB_VARIANT_DONE;
}

static double value(const struct row *row, const ob_report *r)
{
	double x = row->scale * *(const double *)((const char *)r + row->offset);
	return row->per_second ? x / r->simulated_s : x;
}

static void print_row(const ob_comparison *c, const struct row *row, FILE *f)
{
	bool known = false;
	for (int i = 0; i < OB_VARIANTS; i++)
		known |= done(c, i) && !isnan(value(row, &c->result[i].report));
	if (!known)
		return;
	fprintf(f, "%-*s", LABEL_WIDTH, row->label);
	for (int i = 0; i < OB_VARIANTS; i++) {
		ob_quantity q = { "" };
		double x = done(c, i) ? value(row, &c->result[i].report) : NAN;
		if (*row->unit || isnan(x))
			ob_quantity_text(&q, x, row->unit);
		else
			snprintf(q.text, sizeof q.text, "%.2g", x);
		fprintf(f, "%*s", COLUMN_WIDTH, q.text);
	}
	fputc('\n', f);
}

static void print_memory(const ob_comparison *c, FILE *f)
{
	fprintf(f, "%-*s", LABEL_WIDTH, "memory");
	for (int i = 0; i < OB_VARIANTS; i++) {
		ob_quantity q;
		double bytes = done(c, i) ? (double)c->result[i].report.memory_bytes : NAN;
		fprintf(f, "%*s", COLUMN_WIDTH, ob_quantity_text(&q, bytes, "B"));
	}
	fputc('\n', f);
}

static void print_hashes(const ob_comparison *c, FILE *f)
{
	const char *hash;
	bool agree = ob_comparison_agrees(c, &hash);
	fprintf(f, "%-*s", LABEL_WIDTH, "state");
	for (int i = 0; i < OB_VARIANTS; i++)
		fprintf(f, "%*.*s", COLUMN_WIDTH, HASH_DIGITS, done(c, i) ? c->result[i].report.state_hash : "-");
	fputc('\n', f);
	if (*hash)
		fprintf(f,
			agree ? "\nThe object simulators end in the same bits: %s\n"
			      : "\nThe object simulators DIFFER: the first ended in %s\n",
			hash);
}

static const ob_report *any_report(const ob_comparison *c)
{
	const ob_report *found = NULL;
	for (int i = 0; i < OB_VARIANTS; i++)
		found = done(c, i) ? &c->result[i].report : found;
	return found;
}

bool ob_comparison_agrees(const ob_comparison *c, const char **hash)
{
	*hash = "";
	for (int i = 1; i < OB_VARIANTS; i++) {
		if (!done(c, i))
			continue;
		if (!**hash)
			*hash = c->result[i].report.state_hash;
		if (strcmp(*hash, c->result[i].report.state_hash) != 0)
			return false;
	}
	return !c->measured_differs;
}

void ob_comparison_print(const ob_comparison *c, FILE *f)
{
	const ob_report *r = any_report(c);
	if (r) {
		fprintf(f, "%s: %" PRIu64 " objects, %" PRIu64 " steps of %g s, %g s simulated", c->scene, r->objects,
			r->steps, r->step, r->simulated_s);
		uint64_t pool = done(c, 1) ? c->result[1].report.workers : 0;
		if (pool)
			fprintf(f, ", pools of %" PRIu64, pool);
		fprintf(f, "\n\n%*s", LABEL_WIDTH, "");
		for (int i = 0; i < OB_VARIANTS; i++)
			fprintf(f, "%*s", COLUMN_WIDTH, ob_variant_table[i].title);
		fputc('\n', f);
		for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
			print_row(c, &rows[i], f);
		print_memory(c, f);
		print_hashes(c, f);
	}
	for (int i = 0; i < OB_VARIANTS; i++) {
		if (!done(c, i))
			fprintf(f, "%s: %s: %s\n", ob_variant_table[i].title,
				c->result[i].state == OB_VARIANT_FAILED ? "failed" : "skipped", c->result[i].why);
	}
}

void ob_comparison_write_json(const ob_comparison *c, FILE *f)
{
	const char *hash;
	bool agree = ob_comparison_agrees(c, &hash);
	ob_json j = { .f = f };
	ob_json_open(&j, NULL);
	ob_json_string(&j, "scene", c->scene);
	ob_json_string(&j, "commit", ob_version_commit);
	ob_json_true(&j, "hashes_agree", agree);
	ob_json_open(&j, "runs");
	for (int i = 0; i < OB_VARIANTS; i++) {
		if (!done(c, i))
			continue;
		ob_json_open(&j, ob_variant_table[i].key);
		ob_report_write_members(&c->result[i].report, &j);
		ob_json_close(&j);
	}
	ob_json_close(&j);
	for (ob_variant_state s = OB_VARIANT_SKIPPED; s <= OB_VARIANT_FAILED;
	     s += OB_VARIANT_FAILED - OB_VARIANT_SKIPPED) {
		ob_json_open(&j, s == OB_VARIANT_SKIPPED ? "skipped" : "failed");
		for (int i = 0; i < OB_VARIANTS; i++) {
			if (c->result[i].state == s)
				ob_json_string(&j, ob_variant_table[i].key, c->result[i].why);
		}
		ob_json_close(&j);
	}
	ob_json_close(&j);
}
