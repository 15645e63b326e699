#include "experiment/trial.h"

#include <math.h>
#include <string.h>

#include "ranks/ranks.h"

static const double wall_for_cpu = 4; // a slow machine is not the trial's fault

typedef struct job {
	const ob_experiment *experiment;
	const ob_trial *trial;
} job;

static bool work(const void *with, void *answer, ob_error *e)
{
	const job *j = with;
	ob_ranks_forget(); // a trial is alone, even in an experiment on several ranks
	return j->experiment->run(j->trial, answer, e);
}

ob_record ob_trial_record(const ob_records *of, const ob_trial *t)
{
	ob_record r = { .repeat = t->repeat, .seed = t->seed };
	memcpy(r.of, t->of, sizeof r.of);
	memcpy(r.configuration, t->configuration, sizeof r.configuration);
	memcpy(r.machine, of->machine, sizeof r.machine);
	memcpy(r.commit, of->commit, sizeof r.commit);
	for (int i = 0; i < OB_METRICS; i++)
		r.metric[i] = NAN;
	return r;
}

double ob_trial_wall_limit(const ob_experiment *x)
{
	return wall_for_cpu * x->limit_s;
}

bool ob_trial_run(const ob_experiment *x, const ob_trial *t, const ob_process *meanwhile, ob_record *r, ob_error *e)
{
	static const ob_failure failures[] = { [OB_PROCESS_GAVE_UP] = OB_FAILURE_ERROR,
					       [OB_PROCESS_CRASHED] = OB_FAILURE_CRASH,
					       [OB_PROCESS_OUT_OF_TIME] = OB_FAILURE_TIME };
	job j = { x, t };
	ob_process p = *meanwhile;
	p.work = work;
	p.with = &j;
	p.size = sizeof *r;
	p.cpu_limit_s = x->limit_s;
	p.wall_limit_s = ob_trial_wall_limit(x);
	ob_process_cost cost;
	ob_error why = { "" };
	ob_process_end end = ob_process_run(&p, r, &cost, &why);
	r->took_s = cost.wall_s;
	r->took_cpu_s = cost.cpu_s;
	if (end == OB_PROCESS_INTERRUPTED || end == OB_PROCESS_NOT_STARTED)
		return ob_fail(e, "%s", why.text);
	if (end == OB_PROCESS_ANSWERED) {
		r->failure = *r->reason ? OB_FAILURE_OUTCOME : OB_FAILURE_NONE;
	} else {
		r->failure = failures[end];
		snprintf(r->reason, sizeof r->reason, "%.159s", *why.text ? why.text : "it failed without a word");
	}
	for (char *at = r->reason; (at = strpbrk(at, "\r\n"));)
		*at = ' '; // a record is a line of the file
	return true;
}
