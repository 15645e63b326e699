// obsim paper: the paper's experiment, its tables and figures, and the verdict on its claims.
#include <errno.h>
#include <string.h>

#include "cli/command.h"
#include "cli/quantity.h"
#include "cli/version.h"
#include "experiment/table.h"
#include "paper/claims.h"
#include "paper/paper.h"
#include "ranks/ranks.h"
#include "render/render.h"

enum { OBJECTS_MAX = 4096 }; // each is a process

static void print_claims(const ob_paper_results *r)
{
	ob_paper_claim claim[OB_PAPER_CLAIMS];
	ob_paper_judge(r, claim);
	for (int i = 0; i < OB_PAPER_CLAIMS; i++) {
		const ob_paper_claim *c = &claim[i];
		printf("%s\n  %s%s%s\n", c->says, ob_paper_verdict_text(c->verdict), *c->condition ? " " : "",
		       c->condition);
		ob_word_wrap(stdout, "    ", c->because, 99);
		putchar('\n');
	}
}

static int tell(const ob_paper_results *r, const char *out, bool json)
{
	ob_error e;
	if (json) {
		ob_paper_write_json(r, ob_version_number, stdout);
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
	uint64_t objects = plan.objects, experiments = plan.experiments;
	if (a->operand) {
		ob_fail(&e, "unexpected '%s': the paper has one scene of its own", a->operand);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	if (!ob_number_count("objects", a->value[OB_OPTION_OBJECTS], 1, OBJECTS_MAX, &objects, &e) ||
	    !ob_number_count("repeats", a->value[OB_OPTION_REPEATS], 1, OB_PAPER_EXPERIMENTS_MAX, &experiments, &e) ||
	    !ob_render_check(&e))
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	plan.objects = (uint32_t)objects;
	plan.experiments = (uint32_t)experiments;
	int code;
	const bool first = ob_ranks_started().rank == 0; // rank 0 has the records, and prints reports
	if (!ob_paper_run(&plan, ob_version_commit, out, a->value[OB_OPTION_FRESH], &r, &e) ||
	    (first && !ob_paper_report(&r, out, &e)))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	else
		code = !first ? OB_EXIT_OK : tell(&r, out, a->value[OB_OPTION_JSON_OUT]);
	ob_records_finish(&r.records);
	return code;
}
