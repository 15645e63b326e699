// Results as CSV (RFC 4180).
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lab/result_file.h"

const char *ob_result_column_name(int column, char to[32])
{
	static const char *const names[OB_COLUMNS] = {
		[OB_COLUMN_CASE] = "case",
		[OB_COLUMN_ROW] = "row",
		[OB_COLUMN_ENGINE] = "engine",
		[OB_COLUMN_ENGINE_VERSION] = "engine_version",
		[OB_COLUMN_STEP] = "step_s",
		[OB_COLUMN_SUBSTEPS] = "substeps",
		[OB_COLUMN_ITERATIONS] = "iterations",
		[OB_COLUMN_TOLERANCE] = "tolerance_m",
		[OB_COLUMN_LAG] = "lag",
		[OB_COLUMN_SLEEPING] = "sleeping",
		[OB_COLUMN_FAILED] = "failed",
		[OB_COLUMN_COST] = "cpu_s_per_body_and_simulated_s",
		[OB_COLUMN_CPU] = "cpu_s",
		[OB_COLUMN_WALL] = "wall_s",
		[OB_COLUMN_BODY_SECONDS] = "bodies_times_simulated_s",
		[OB_COLUMN_REPEATS] = "repeats",
		[OB_COLUMN_CPU_EACH] = "cpu_s_of_each",
		[OB_COLUMN_WALL_EACH] = "wall_s_of_each",
		[OB_COLUMN_MACHINE] = "machine",
		[OB_COLUMN_COMMIT] = "commit",
	};
	static const char *const parts[4] = { "name", "value", "unit", "target" };
	if (names[column])
		return names[column];
	int figure = column - OB_COLUMN_FIGURE;
	snprintf(to, 32, "figure%d_%s", figure / 4 + 1, parts[figure % 4]);
	return to;
}

static void put_text(FILE *f, const char *text)
{
	if (!strpbrk(text, ",\"\r\n")) {
		fputs(text, f);
		return;
	}
	putc('"', f);
	for (; *text; text++) {
		if (*text == '"')
			putc('"', f);
		putc(*text, f);
	}
	putc('"', f);
}

// As many digits as it takes to read the same bits back. What is not a number is nothing.
static void put_number(FILE *f, double v)
{
	char text[32] = "";
	for (int digits = 15; digits <= 17 && !isnan(v); digits++) {
		snprintf(text, sizeof text, "%.*g", digits, v);
		if (strtod(text, NULL) == v)
			break;
	}
	fputs(text, f);
}

static void put_numbers(FILE *f, const double *v, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		if (i)
			putc(' ', f);
		put_number(f, v[i]);
	}
}

static void put_figure(FILE *f, const ob_result *r, int column)
{
	uint32_t i = (uint32_t)(column - OB_COLUMN_FIGURE) / 4;
	const ob_figure_def *def = &r->of->figure[i];
	if (i >= r->of->figures)
		return;
	switch ((column - OB_COLUMN_FIGURE) % 4) {
	case 0:
		put_text(f, def->name);
		break;
	case 1:
		put_number(f, r->outcome.figure[i]);
		break;
	case 2:
		put_text(f, def->unit);
		break;
	default:
		put_number(f, def->target);
	}
}

static void put_cell(FILE *f, const ob_results *all, const ob_result *r, int column)
{
	const double number[OB_COLUMNS] = {
		[OB_COLUMN_ROW] = r->of->row,
		[OB_COLUMN_STEP] = r->settings.step_length,
		[OB_COLUMN_SUBSTEPS] = r->settings.substeps,
		[OB_COLUMN_ITERATIONS] = r->settings.iterations,
		[OB_COLUMN_TOLERANCE] = r->settings.tolerance,
		[OB_COLUMN_LAG] = r->settings.lag,
		[OB_COLUMN_SLEEPING] = r->settings.sleeping,
		[OB_COLUMN_COST] = ob_result_cost(r),
		[OB_COLUMN_CPU] = r->outcome.cpu_s,
		[OB_COLUMN_WALL] = r->outcome.wall_s,
		[OB_COLUMN_BODY_SECONDS] = r->outcome.body_seconds,
		[OB_COLUMN_REPEATS] = r->repeats,
	};
	const char *const text[OB_COLUMNS] = {
		[OB_COLUMN_CASE] = r->of->name,
		[OB_COLUMN_ENGINE] = r->engine->name,
		[OB_COLUMN_ENGINE_VERSION] = r->engine->version,
		[OB_COLUMN_FAILED] = r->outcome.failed,
		[OB_COLUMN_MACHINE] = all->machine,
		[OB_COLUMN_COMMIT] = r->commit,
	};
	if (text[column])
		put_text(f, text[column]);
	else if (column == OB_COLUMN_CPU_EACH || column == OB_COLUMN_WALL_EACH)
		put_numbers(f, column == OB_COLUMN_CPU_EACH ? r->cpu_s : r->wall_s, r->repeats);
	else if (column >= OB_COLUMN_FIGURE && column < OB_COLUMN_MACHINE)
		put_figure(f, r, column);
	else
		put_number(f, number[column]);
}

static void put_all(FILE *f, const ob_results *r)
{
	char made_up[32];
	for (int column = 0; column < OB_COLUMNS; column++)
		fprintf(f, "%s%s", column ? "," : "", ob_result_column_name(column, made_up));
	fputs("\r\n", f);
	for (size_t i = 0; i < r->count; i++) {
		for (int column = 0; column < OB_COLUMNS; column++) {
			if (column)
				putc(',', f);
			put_cell(f, r, &r->result[i], column);
		}
		fputs("\r\n", f);
	}
}

bool ob_results_write(const ob_results *r, const char *path, ob_error *e)
{
	char *beside;
	if (asprintf(&beside, "%s.new", path) < 0)
		return ob_fail(e, "no memory for %s", path);
	FILE *f = fopen(beside, "we");
	bool fine = f;
	if (f) {
		put_all(f, r);
		fine = !ferror(f);
		fine &= fclose(f) == 0;
	}
	fine = fine && rename(beside, path) == 0; // whoever looks sees the old file or the new one
	int why = errno;
	if (!fine && f)
		remove(beside);
	free(beside);
	return fine || ob_fail(e, "%s cannot be written: %s", path, strerror(why));
}
