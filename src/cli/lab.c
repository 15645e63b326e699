// obsim lab: hard cases x engines x settings. What is measured is kept in the folder's file of results, so that the
// same command goes on where it was broken off.
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/lab_folder.h"
#include "cli/lab_json.h"
#include "cli/lab_request.h"
#include "cli/progress.h"
#include "cli/terminal.h"
#include "lab/tables.h"

static bool is_asked(const ob_lab_plan *p, const ob_result *r)
{
	bool of = false, engine = false;
	for (size_t i = 0; i < p->cases.count; i++)
		of |= p->cases.of[i] == r->of;
	for (size_t i = 0; i < p->engines.count; i++)
		engine |= p->engines.of[i] == r->engine;
	return of && engine;
}

// Those with the cases and engines of this call, or all others
static bool pick(const ob_lab_plan *p, const ob_results *from, bool asked, ob_results *to)
{
	*to = (ob_results){ 0 };
	memcpy(to->machine, from->machine, sizeof to->machine);
	memcpy(to->commit, from->commit, sizeof to->commit);
	bool fine = true;
	for (size_t i = 0; fine && i < from->count; i++)
		fine = is_asked(p, &from->result[i]) != asked || ob_results_add(to, &from->result[i]);
	return fine;
}

static void show(const ob_lab_progress *p, void *with)
{
	enum { BAR = 20 };
	static const char hashes[] = "####################";
	char line[256], rest[48] = "-", setting[64];
	int columns, lines, done = (int)(BAR * p->done / p->all);
	if (!isnan(p->left))
		ob_progress_print_rest(rest, sizeof rest, p->left);
	ob_sweep_print(setting, sizeof setting, &p->settings);
	snprintf(line, sizeof line, "[%.*s%*s] %zu of %zu, %s left: %s, %s, %s", done, hashes, BAR - done, "", p->done,
		 p->all, rest, p->of->name, p->engine->name, setting);
	ob_terminal_size(&columns, &lines);
	fprintf(stderr, "\r\033[K%.*s", columns - 1, line);
	fflush(stderr);
}

static int tell(const ob_lab_request *r, const ob_results *asked)
{
	ob_digest d = ob_digest_make(asked);
	ob_error e;
	if (r->json) {
		ob_lab_write_json(asked, stdout);
	} else {
		ob_lab_print_rows(stdout, &d, false);
		putchar('\n');
		ob_lab_print_equal(stdout, &d, false);
		printf("\n%s/report.html shows it all; %s/results.csv has every figure.\n", r->out, r->out);
	}
	if (fflush(stdout) != 0 || ferror(stdout)) {
		ob_fail(&e, "standard output: %s", strerror(errno));
		return ob_command_fail(OB_EXIT_FAILED, e.text);
	}
	size_t missed = r->check ? ob_lab_count_missed(&d) : 0;
	if (missed == 0)
		return OB_EXIT_OK;
	ob_fail(&e, "%zu target%s missed", missed, missed == 1 ? "" : "s");
	return ob_command_fail(OB_EXIT_MISSED, e.text);
}

// What is there already, without what is to be run afresh
static bool take_up(const ob_lab_request *r, ob_results *results, ob_error *e)
{
	ob_results others;
	if (!ob_lab_folder_open(r->out, results, e))
		return false;
	if (!r->fresh)
		return true;
	bool fine = pick(&r->plan, results, false, &others) || ob_fail(e, "out of memory");
	ob_results_finish(results);
	*results = others;
	return fine;
}

static bool run(ob_lab_request *r, ob_results *results, ob_error *e)
{
	char *file = ob_lab_folder_path(r->out, "results.csv");
	r->plan.file = file;
	r->plan.tick = isatty(STDERR_FILENO) ? show : NULL;
	bool fine = ob_lab_run(&r->plan, results, e);
	if (r->plan.tick)
		fputs("\r\033[K", stderr);
	free(file);
	return fine;
}

int ob_command_lab(const ob_arguments *a)
{
	ob_lab_request *r = calloc(1, sizeof *r);
	ob_results results = { 0 }, asked = { 0 };
	ob_error e;
	int code = OB_EXIT_OK;
	if (!r || !ob_lab_request_read(r, a, &e))
		code = ob_command_fail(OB_EXIT_USAGE, r ? e.text : "out of memory");
	else if (r->list)
		ob_list_print(stdout, &r->plan.cases);
	else if (!take_up(r, &results, &e) || !run(r, &results, &e) || !ob_lab_folder_write(r->out, &results, &e))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	else if (!pick(&r->plan, &results, true, &asked))
		code = ob_command_fail(OB_EXIT_FAILED, "out of memory");
	else
		code = tell(r, &asked);
	ob_results_finish(&results);
	ob_results_finish(&asked);
	free(r);
	return code;
}
