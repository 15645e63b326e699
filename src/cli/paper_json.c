#include "cli/paper_json.h"

#include <string.h>

#include "experiment/json.h"
#include "cli/version.h"
#include "paper/claims.h"

static void put_claim(ob_json *j, const ob_paper_claim *c)
{
	static const char *const verdicts[OB_PAPER_VERDICTS] = { "holds", "holds_only_if", "does_not_hold",
								 "cannot_be_told" };
	ob_json_open(j, NULL);
	ob_json_string(j, "claim", c->key);
	ob_json_string(j, "paper_says", c->says);
	ob_json_string(j, "where", c->where);
	ob_json_string(j, "verdict", verdicts[c->verdict]);
	if (*c->condition)
		ob_json_string(j, "only_if", c->condition);
	else
		ob_json_null(j, "only_if");
	ob_json_string(j, "measured", c->because);
	ob_json_string(j, "paper_itself", c->itself);
	ob_json_close(j);
}

static void put_mean(ob_json *j, const ob_paper_results *r, ob_paper_scenario s, ob_paper_quantity q)
{
	ob_statistics of = ob_paper_summarise(r, s, q);
	ob_json_open(j, ob_paper_quantities[q].key);
	ob_json_count(j, "n", of.n);
	ob_json_number(j, "mean", of.mean);
	ob_json_number(j, "low", of.mean_low);
	ob_json_number(j, "high", of.mean_high);
	ob_json_close(j);
}

static void put_sample(ob_json *j, const ob_paper_sample *s)
{
	ob_json_open(j, NULL);
	ob_json_string(j, "scenario", ob_paper_setups[s->scenario].key);
	ob_json_string(j, "series", s->growth ? "growth" : "experiment");
	ob_json_count(j, "experiment", s->experiment + 1);
	ob_json_count(j, "objects", s->objects);
	ob_json_count(j, "seed", s->seed);
	for (int q = 0; q < OB_PAPER_QUANTITIES; q++)
		ob_json_number(j, ob_paper_quantities[q].key, ob_paper_value(s, q));
	if (*s->failed)
		ob_json_string(j, "failed", s->failed);
	else
		ob_json_null(j, "failed");
	ob_json_close(j);
}

void ob_paper_write_json(const ob_paper_results *r, FILE *f)
{
	ob_json j = { .f = f };
	ob_paper_claim claim[OB_PAPER_CLAIMS];
	ob_paper_judge(r, claim);
	ob_json_open(&j, NULL);
	ob_json_string(&j, "version", ob_version_number);
	ob_json_string(&j, "commit", r->commit);
	ob_json_string(&j, "machine", r->machine);
	ob_json_number(&j, "load_average_before", r->busy);
	ob_json_open_list(&j, "claims");
	for (int i = 0; i < OB_PAPER_CLAIMS; i++)
		put_claim(&j, &claim[i]);
	ob_json_close_list(&j);
	ob_json_open(&j, "means");
	for (int s = 0; s < OB_PAPER_SCENARIOS; s++) {
		ob_json_open(&j, ob_paper_setups[s].key);
		for (int q = 0; q < OB_PAPER_QUANTITIES; q++)
			put_mean(&j, r, s, q);
		ob_json_close(&j);
	}
	ob_json_close(&j);
	ob_json_open_list(&j, "runs");
	for (size_t i = 0; i < r->count; i++)
		put_sample(&j, &r->sample[i]);
	ob_json_close_list(&j);
	ob_json_close(&j);
}
