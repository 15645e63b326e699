// obsim lab: hard cases x engines x settings. The folder's file of results keeps all measurements, so that the same
// command resumes where it was interrupted.
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/spelling.h"
#include "cli/command.h"
#include "cli/quantity.h"
#include "cli/version.h"
#include "lab/analysis.h"
#include "lab/lab.h"
#include "lab/report.h"
#include "lab/scene.h"
#include "ranks/ranks.h"

// Request of the command line
typedef struct request {
	ob_lab_plan plan;
	double limit; // s
	const char *out; // folder
	bool list, fresh, json, check, audit;
} request;

// Suggests a case family: "stak" has no similar case, but a prefix of many cases is similar.
static bool suggest_family(const char *word, ob_error *e)
{
	ob_spelling s = ob_spelling_start(word);
	char families[OB_LIST_CASES][32];
	size_t i = 0;
	for (const ob_case *const *c = ob_cases; *c && i < OB_LIST_CASES; c++, i++) {
		snprintf(families[i], sizeof families[i], "%.*s", (int)strcspn((*c)->name, "-"), (*c)->name);
		ob_spelling_offer(&s, families[i]);
	}
	for (const ob_case *const *c = ob_cases; s.best && *c; c++)
		if (!strncmp((*c)->name, s.best, strlen(s.best)))
			return ob_fail(e, "no case '%s': did you mean %s, or all that begin with '%s'?", word,
				       (*c)->name, s.best);
	return ob_fail(e, "no case '%s': obsim lab --list shows all", word);
}

// True for a user's case, which is a file.
static bool is_file(const char *word)
{
	const size_t n = strlen(word);
	return n > 4 && strcmp(word + n - 4, ".lua") == 0;
}

static bool open_cases(const ob_arguments *a, ob_error *e)
{
	const char *file[OB_LIST_CASES];
	size_t files = 0;
	for (const char **word = a->operands; *word; word++) {
		if (is_file(*word) && files == OB_LIST_CASES)
			return ob_fail(e, "lab: expected at most %d files", OB_LIST_CASES);
		if (is_file(*word))
			file[files++] = *word;
	}
	return ob_cases_open(file, files, e);
}

static bool read_cases(ob_case_list *l, const ob_arguments *a, ob_error *e)
{
	if (!a->operand)
		ob_list_add_all(l, a->value[OB_OPTION_QUICK]);
	else if (a->value[OB_OPTION_QUICK])
		return ob_fail(e, "--quick is a choice of cases: leave it, or '%s', away", a->operand);
	for (const char **word = a->operands; *word; word++) {
		if (ob_list_add_cases(l, *word))
			continue;
		ob_spelling s = ob_spelling_start(*word);
		for (const ob_case *const *c = ob_cases; *c; c++)
			ob_spelling_offer(&s, (*c)->name);
		if (s.best)
			return ob_fail(e, "no case '%s': did you mean %s?", *word, s.best);
		return suggest_family(*word, e);
	}
	return true;
}

static bool read_engines(ob_engine_list *l, const char *names, ob_error *e)
{
	char word[64], all[512] = "";
	if (ob_list_engines(l, names ? names : "all", word))
		return true;
	ob_spelling s = ob_spelling_start(word);
	for (const ob_engine_kind *const *k = ob_engine_kinds; *k; k++) {
		size_t n = strlen(all);
		snprintf(all + n, sizeof all - n, "%s%s", n ? ", " : "", (*k)->name);
		ob_spelling_offer(&s, (*k)->name);
	}
	if (s.best)
		return ob_fail(e, "--engines: no engine '%s': did you mean %s?", word, s.best);
	return ob_fail(e, "--engines: no engine '%s', only: %s", word, all);
}

// Checks that engines are available. Engines named on the command line must be; others that are missing are left
// out with a warning.
static bool check_engines(ob_engine_list *l, bool named, ob_error *e)
{
	size_t there = 0;
	for (size_t i = 0; i < l->count; i++) {
		const ob_engine_kind *k = l->of[i];
		if (!k->check || k->check(e))
			l->of[there++] = k;
		else if (named)
			return false;
		else
			ob_log_warn("without %s: %s", k->title, e->text);
	}
	l->count = there;
	return true;
}

static bool check(const request *r, const ob_arguments *a, ob_error *e)
{
	char word[64];
	ob_engine_list own;
	bool has_own = false;
	ob_list_engines(&own, "obsim,obsim-lag", word); // the engines with accuracy targets
	for (size_t i = 0; i < r->plan.engines.count; i++)
		for (size_t j = 0; j < own.count; j++)
			has_own |= r->plan.engines.of[i] == own.of[j];
	if (r->check && !has_own)
		return ob_fail(e, "--check is about obsim: it must be among --engines %s", a->value[OB_OPTION_ENGINES]);
	if (r->list && r->json)
		return ob_fail(e, "--list is text: leave --json away");
	return true;
}

static bool read_request(request *r, const ob_arguments *a, ob_error *e)
{
	*r = (request){
		.limit = a->value[OB_OPTION_AUDIT] ? 20 : 150,
		.out = a->value[OB_OPTION_OUT] ? a->value[OB_OPTION_OUT] : "obsim-lab",
		.list = a->value[OB_OPTION_LIST],
		.fresh = a->value[OB_OPTION_FRESH],
		.json = a->value[OB_OPTION_JSON_OUT],
		.check = a->value[OB_OPTION_CHECK_TARGETS],
		.audit = a->value[OB_OPTION_AUDIT],
	};
	bool quick = a->value[OB_OPTION_QUICK];
	const char *engines = a->value[OB_OPTION_ENGINES], *sweep = a->value[OB_OPTION_SWEEP];
	uint64_t repeats = 1;
	if (r->audit && sweep)
		return ob_fail(e, "--audit is a choice of settings: leave it, or --sweep, away");
	if (r->audit) {
		engines = engines ? engines : "obsim";
		sweep = OB_AUDIT_SWEEP;
	}
	// a quick look of a minute: obsim's targets, and one other engine, each with its users' usual settings
	if (quick && !engines)
		engines = "obsim,obsim-lag,ode-quick";
	if (quick && !sweep)
		sweep = "none";
	bool fine = open_cases(a, e) && read_cases(&r->plan.cases, a, e) &&
		    read_engines(&r->plan.engines, engines, e) && ob_sweep_parse(&r->plan.sweep, sweep, e) &&
		    ob_number_count("repeats", a->value[OB_OPTION_REPEATS], 1, OB_REPEATS, &repeats, e) &&
		    ob_number_real("limit", a->value[OB_OPTION_LIMIT], 0, 1e6, &r->limit, e);
	r->plan.repeats = (uint32_t)repeats;
	return fine && check(r, a, e) &&
	       (r->list || check_engines(&r->plan.engines, engines && strcmp(engines, "all") != 0, e));
}

static bool is_asked(const ob_lab_plan *p, const ob_result *r)
{
	bool of = false, engine = false;
	for (size_t i = 0; i < p->cases.count; i++)
		of |= p->cases.of[i] == r->of;
	for (size_t i = 0; i < p->engines.count; i++)
		engine |= p->engines.of[i] == r->engine;
	return of && engine;
}

// Picks the results with the cases and engines of this call
static bool pick(const ob_lab_plan *p, const ob_results *from, ob_results *to)
{
	memcpy(to->machine, from->machine, sizeof to->machine);
	memcpy(to->commit, from->commit, sizeof to->commit);
	bool fine = true;
	for (size_t i = 0; fine && i < from->count; i++)
		fine = !is_asked(p, &from->result[i]) || ob_results_add(to, &from->result[i]);
	return fine;
}

// Error of a user's case, whose function failed in a run; NULL: there is none.
static const char *find_wrong_case(const ob_results *r)
{
	for (size_t i = 0; i < r->count; i++) {
		const ob_case_text *t = r->result[i].of->text;
		const size_t n = t ? strlen(t->path) : 0;
		const char *said = r->result[i].outcome.failed;
		if (n && strncmp(said, t->path, n) == 0 && said[n] == ':')
			return said;
	}
	return NULL;
}

static int tell(const request *r, const ob_results *asked)
{
	ob_lab_analysis d = ob_lab_analyse(asked);
	ob_error e;
	if (r->json) {
		ob_lab_write_json(asked, ob_version_number, stdout);
	} else {
		ob_lab_print_rows(stdout, &d, false);
		putchar('\n');
		ob_lab_print_conserved(stdout, &d, false);
		putchar('\n');
		if (r->audit)
			ob_lab_print_audit(stdout, &d, false);
		else
			ob_lab_print_equal(stdout, &d, false);
		printf("\n%s/report.html shows it all; %s/results.csv has every figure.\n", r->out, r->out);
	}
	if (fflush(stdout) != 0 || ferror(stdout)) {
		ob_fail(&e, "standard output: %s", strerror(errno));
		return ob_command_fail(OB_EXIT_FAILED, e.text);
	}
	const char *wrong = find_wrong_case(asked);
	if (wrong)
		return ob_command_fail(OB_EXIT_USAGE, wrong);
	size_t missed = r->check ? ob_lab_count_missed(&d) : 0;
	if (missed == 0)
		return OB_EXIT_OK;
	ob_fail(&e, "%zu target%s missed", missed, missed == 1 ? "" : "s");
	return ob_command_fail(OB_EXIT_MISSED, e.text);
}

// Results of a user's files are never mixed with those of other texts.
static bool measure(const request *r, ob_results *results, ob_error *e)
{
	char commit[64];
	snprintf(commit, sizeof commit, ob_cases_digest() ? "%.40s, cases %08x" : "%.40s", ob_version_commit,
		 ob_cases_digest());
	ob_experiment x = ob_lab_experiment(commit, r->limit);
	ob_trials trials = { 0 };
	ob_records records = { 0 };
	bool fine = ob_lab_schedule(&r->plan, &trials, e) && ob_experiment_open(&x, r->out, &records, e);
	if (fine && r->fresh)
		ob_records_drop(&records, &trials);
	fine = fine && ob_experiment_run(&x, &trials, &records, r->out, e) && ob_lab_results(&records, results, e);
	ob_trials_finish(&trials);
	ob_records_finish(&records);
	return fine;
}

int ob_command_lab(const ob_arguments *a)
{
	request *r = calloc(1, sizeof *r);
	ob_results results = { 0 }, asked = { 0 };
	ob_error e;
	int code = OB_EXIT_OK;
	const bool first = ob_ranks_started().rank == 0; // rank 0 has the records, and prints reports
	if (!r || !read_request(r, a, &e))
		code = ob_command_fail(OB_EXIT_USAGE, r ? e.text : "out of memory");
	else if (r->list && first)
		ob_list_print(stdout, &r->plan.cases);
	else if (!r->list && (!measure(r, &results, &e) || (first && !ob_lab_report(&results, r->out, &e))))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	else if (r->list || !first)
		code = OB_EXIT_OK;
	else if (!pick(&r->plan, &results, &asked))
		code = ob_command_fail(OB_EXIT_FAILED, "out of memory");
	else
		code = tell(r, &asked);
	ob_results_finish(&results);
	ob_results_finish(&asked);
	free(r);
	return code;
}
