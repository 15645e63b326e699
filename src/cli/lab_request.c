#include "cli/lab_request.h"

#include <string.h>

#include "base/spelling.h"
#include "cli/quantity.h"

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
		return ob_fail(e, "no case '%s': obsim lab --list shows all", *word);
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

static bool check(const ob_lab_request *r, const ob_arguments *a, ob_error *e)
{
	char word[64];
	ob_engine_list own;
	bool has_own = false;
	ob_list_engines(&own, "obsim,obsim-lag", word); // those who promise something
	for (size_t i = 0; i < r->plan.engines.count; i++)
		for (size_t j = 0; j < own.count; j++)
			has_own |= r->plan.engines.of[i] == own.of[j];
	if (r->check && !has_own)
		return ob_fail(e, "--check is about obsim: it must be among --engines %s", a->value[OB_OPTION_ENGINES]);
	if (r->list && r->json)
		return ob_fail(e, "--list is text: leave --json away");
	return true;
}

bool ob_lab_request_read(ob_lab_request *r, const ob_arguments *a, ob_error *e)
{
	*r = (ob_lab_request){
		.plan.limit = 150,
		.out = a->value[OB_OPTION_OUT] ? a->value[OB_OPTION_OUT] : "obsim-lab",
		.list = a->value[OB_OPTION_LIST],
		.fresh = a->value[OB_OPTION_FRESH],
		.json = a->value[OB_OPTION_JSON_OUT],
		.check = a->value[OB_OPTION_CHECK],
	};
	uint64_t repeats = 1;
	bool fine = read_cases(&r->plan.cases, a, e) &&
		    read_engines(&r->plan.engines, a->value[OB_OPTION_ENGINES], e) &&
		    ob_sweep_parse(&r->plan.sweep, a->value[OB_OPTION_SWEEP], e) &&
		    ob_number_count("repeats", a->value[OB_OPTION_REPEATS], 1, OB_REPEATS, &repeats, e) &&
		    ob_number_real("limit", a->value[OB_OPTION_LIMIT], 0, 1e6, &r->plan.limit, e);
	r->plan.repeats = (uint32_t)repeats;
	return fine && check(r, a, e);
}
