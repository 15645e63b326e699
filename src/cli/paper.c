// obsim paper: the paper's experiment, its tables and figures, and what becomes of its claims.
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/quantity.h"
#include "cli/paper_json.h"
#include "cli/terminal.h"
#include "cli/version.h"
#include "experiment/folder.h"
#include "experiment/progress.h"
#include "paper/claims.h"
#include "paper/paper.h"
#include "paper/report.h"

enum { OBJECTS_MAX = 4096 }; // each is a process

static void show(size_t done, size_t all, double left, const char *what)
{
	enum { BAR = 20 };
	static const char hashes[] = "####################";
	char line[200], rest[48] = "-";
	int columns, lines, filled = (int)(BAR * done / all);
	if (!isnan(left))
		ob_progress_print_time(rest, sizeof rest, left);
	snprintf(line, sizeof line, "[%.*s%*s] %zu of %zu, %s left: %s", filled, hashes, BAR - filled, "", done, all,
		 rest, what);
	ob_terminal_size(&columns, &lines);
	fprintf(stderr, "\r\033[K%.*s", columns - 1, line);
	fflush(stderr);
}

static bool run(const ob_paper_plan *p, ob_paper_results *r, ob_error *e)
{
	bool seen = isatty(STDERR_FILENO);
	ob_provenance_machine(r->machine, sizeof r->machine);
	ob_provenance_commit(ob_version_commit, r->commit, sizeof r->commit);
	bool fine = ob_paper_run(p, seen ? show : NULL, r, e);
	if (seen)
		fputs("\r\033[K", stderr);
	return fine;
}

// "  " before each line, broken between words
static void print_folded(const char *text)
{
	enum { WIDTH = 100 };
	while (*text) {
		size_t n = strlen(text), cut = n;
		for (size_t i = 0; n > WIDTH && i < WIDTH; i++)
			cut = text[i] == ' ' ? i : cut;
		printf("    %.*s\n", (int)cut, text);
		text += cut + (text[cut] == ' ');
	}
}

static void print_claims(const ob_paper_results *r)
{
	ob_paper_claim claim[OB_PAPER_CLAIMS];
	ob_paper_judge(r, claim);
	for (int i = 0; i < OB_PAPER_CLAIMS; i++) {
		const ob_paper_claim *c = &claim[i];
		printf("%s\n  %s%s%s\n", c->says, ob_paper_verdict_text(c->verdict), *c->condition ? " " : "",
		       c->condition);
		print_folded(c->because);
		putchar('\n');
	}
}

static int tell(const ob_paper_results *r, const char *out, bool json)
{
	ob_error e;
	if (json) {
		ob_paper_write_json(r, stdout);
	} else {
		print_claims(r);
		printf("%s/report.html shows it all; %s/results.csv has every run.\n", out, out);
	}
	if (fflush(stdout) == 0 && !ferror(stdout))
		return OB_EXIT_OK;
	ob_fail(&e, "standard output: %s", strerror(errno));
	return ob_command_fail(OB_EXIT_FAILED, e.text);
}

int ob_command_paper(const ob_arguments *a)
{
	ob_error e;
	ob_paper_results r = { 0 };
	ob_paper_plan plan = a->value[OB_OPTION_QUICK] ? ob_paper_plan_quick() : ob_paper_plan_full();
	const char *out = a->value[OB_OPTION_OUT] ? a->value[OB_OPTION_OUT] : "obsim-paper";
	uint64_t objects = plan.objects;
	if (a->operand) {
		ob_fail(&e, "unexpected '%s': the paper has one scene of its own", a->operand);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	if (!ob_number_count("objects", a->value[OB_OPTION_OBJECTS], 1, OBJECTS_MAX, &objects, &e))
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	plan.objects = (uint32_t)objects;
	int code;
	// the folder first: ten minutes for nothing would be a pity
	if (!ob_folder_make(out, &e) || !run(&plan, &r, &e) || !ob_paper_report(&r, out, &e))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	else
		code = tell(&r, out, a->value[OB_OPTION_JSON_OUT]);
	ob_paper_results_finish(&r);
	return code;
}
