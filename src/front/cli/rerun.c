#include "cli/rerun.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/interrupt.h"
#include "cli/command.h"
#include "measure/measure.h"

enum { STATE_EVERY = 10 }; // steps

ob_request_log_head ob_rerun_head(const ob_run_request *r, const ob_scene *s, uint32_t spare)
{
	ob_request_log_head head = {
		.run = r->run, .seed = s->seed, .objects = s->objects, .spare = spare, .on_death = r->on_death
	};
	head.run.fault = (ob_fault_plan){ 0 };
	head.run.timed = head.run.verify = 0;
	return head;
}

static bool hash_of(const ob_host *h, uint64_t *hash, ob_error *e)
{
	ob_snapshot now = { 0 };
	const bool fine = ob_snapshot_take(&now, ob_host_universe(h), 0, e);
	if (fine)
		*hash = ob_measure_hash(&now);
	ob_snapshot_finish(&now);
	return fine;
}

void ob_rerun_log_state(ob_request_log *log, const ob_host *h, uint64_t *next)
{
	const uint64_t step = ob_step_count(ob_host_universe(h));
	uint64_t hash;
	ob_error e;
	if (log && step >= *next && hash_of(h, &hash, &e)) {
		*next = step + STATE_EVERY;
		ob_request_log_state(log, step, hash);
	}
}

// Runs from state to state of the log. false and e: the run failed, or reached a different state.
static bool compare_states(ob_host *h, const ob_logged_requests *l, ob_error *e)
{
	uint64_t hash = 0;
	ob_host_go(h, 0);
	if (!ob_host_wait(h, e))
		return false;
	for (uint32_t i = 0; i < l->states; i++) {
		ob_host_go(h, l->state[i].step);
		if (!ob_host_wait(h, e) || !hash_of(h, &hash, e))
			return false;
		if (hash != l->state[i].hash)
			return ob_fail(e, "step %" PRIu64 ": state %016" PRIx64 ", the log has %016" PRIx64,
				       l->state[i].step, hash, l->state[i].hash);
	}
	printf("%u requests carried out again, %u objects frozen; %u states equal those of the log, the last "
	       "%016" PRIx64 " after step %" PRIu64 "\n",
	       l->requests, l->freezes, l->states, hash, l->states ? l->state[l->states - 1].step : 0);
	return true;
}

// Refuses options without effect: a replay ends with the log, and writes no files.
static bool check_options(const ob_arguments *a, ob_error *e)
{
	const uint64_t useless = OB_BIT(OB_OPTION_DURATION) | OB_BIT(OB_OPTION_PICTURES) | OB_BIT(OB_OPTION_RECORD) |
				 OB_BIT(OB_OPTION_SERIES) | OB_BIT(OB_OPTION_JSON) | OB_BIT(OB_OPTION_REPORT) |
				 OB_BIT(OB_OPTION_TRACE) | OB_BIT(OB_OPTION_EXPLAIN) | OB_BIT(OB_OPTION_RESUME) |
				 OB_BIT(OB_OPTION_CHECKPOINT) | OB_BIT(OB_OPTION_ON_DEATH);
	return ob_options_refuse(a, useless, 0,
				 ": --replay-requests does as the log says, and writes nothing; leave it away", e);
}

static bool prepare(const ob_arguments *a, ob_run_request *q, ob_scene **scene, ob_logged_requests *l, ob_error *e)
{
	const char *path = a->value[OB_OPTION_REPLAY_REQUESTS];
	if (!check_options(a, e) || !ob_request_read(q, a, e) || !ob_request_log_read(l, path, e))
		return false;
	*scene = ob_scene_load(q->scene, &q->scene_options, e);
	if (!*scene || !ob_request_resolve(q, *scene, e))
		return false;
	q->on_death = l->head.on_death <= OB_ON_DEATH_KEEP ? (ob_on_death)l->head.on_death : q->on_death;
	const ob_request_log_head own = ob_rerun_head(q, *scene, l->head.spare);
	return memcmp(&own, &l->head, sizeof own) == 0 ||
	       ob_fail(e, "%s: it is of another scene, seed, -D or settings: give those of the run that was logged",
		       path);
}

int ob_command_rerun(const ob_arguments *a)
{
	ob_run_request q = { 0 };
	ob_logged_requests l = { 0 };
	ob_scene *scene = NULL;
	ob_error e;
	int code = OB_EXIT_OK;
	if (!prepare(a, &q, &scene, &l, &e)) {
		code = ob_command_fail(OB_EXIT_USAGE, e.text);
	} else {
		ob_host_config config = ob_request_host(&q);
		config.spare = l.head.spare;
		config.replay = &l;
		ob_interrupt_watch();
		ob_host *h = ob_host_start(scene, &config, &e);
		if (!h || !compare_states(h, &l, &e))
			code = ob_command_fail(h && ob_host_broke_invariant(h) ? OB_EXIT_BROKEN : OB_EXIT_FAILED,
					       e.text);
		ob_host_stop(h);
		ob_interrupt_release();
	}
	ob_logged_requests_finish(&l);
	ob_scene_free(scene);
	return code;
}
