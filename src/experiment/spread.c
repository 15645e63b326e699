#include "experiment/spread.h"

#include <string.h>

#include "base/clock.h"
#include "base/hash.h"
#include "experiment/process.h"

static const double look_s = 1; // between polls while no message comes
static const double grace_s = 60; // after which it leaves by itself

uint64_t ob_spread_digest(const ob_experiment *x, const ob_trials *s)
{
	uint64_t hash = ob_hash_on(OB_HASH_BEGIN, x->name, strlen(x->name));
	hash = ob_hash_on(hash, &x->limit_s, sizeof x->limit_s);
	for (size_t i = 0; i < s->count; i++) {
		const ob_trial *t = &s->trial[i];
		hash = ob_hash_on(hash, t->of, strlen(t->of) + 1);
		hash = ob_hash_on(hash, t->configuration, strlen(t->configuration) + 1);
		hash = ob_hash_on(hash, &t->repeat, sizeof t->repeat);
		hash = ob_hash_on(hash, &t->seed, sizeof t->seed);
	}
	return hash;
}

typedef struct helper {
	ob_courier *courier;
	ob_spread_message last; // from the first rank
	ob_courier_news news; // kind of the last message
	ob_error why; // reason for which the first has gone
} helper;

static bool attend(void *of)
{
	helper *h = of;
	uint32_t from;
	h->news = ob_courier_receive(h->courier, &h->last, &from, &h->why);
	return h->news == OB_COURIER_NOTHING; // the first sends nothing while a trial runs
}

// Returns false if interrupted.
static bool await_order(helper *h, ob_error *e)
{
	while (attend(h) && !ob_processes_interrupted())
		ob_processes_wait(ob_courier_socket(h->courier), look_s);
	if (h->news == OB_COURIER_GONE)
		return ob_fail(e, "%s", h->why.text);
	return h->news == OB_COURIER_MESSAGE || ob_fail(e, "interrupted");
}

static bool help(helper *h, const ob_experiment *x, const ob_trials *s, const ob_records *own, ob_error *e)
{
	const ob_meanwhile meanwhile = { .attend = attend, .ear = ob_courier_socket(h->courier), .of = h };
	ob_spread_message said = { .kind = OB_SPREAD_JOIN,
				   .trial = ob_spread_digest(x, s),
				   .record = ob_trial_record(own, &(ob_trial){ .repeat = 0 }) };
	for (;;) {
		if (!ob_courier_send(h->courier, 0, &said, e) || !await_order(h, e))
			return false;
		if (h->last.kind == OB_SPREAD_LEAVE)
			return true;
		const ob_trial *t = &s->trial[h->last.trial];
		said = (ob_spread_message){ OB_SPREAD_RAN, h->last.trial, ob_trial_record(own, t) };
		if (!ob_trial_run(x, t, &meanwhile, &said.record, e))
			return h->news == OB_COURIER_GONE ? ob_fail(e, "%s", h->why.text) : false;
	}
}

// The launcher may have interrupted all ranks, and kills the rest as soon as one leaves. The first must leave first, as
// it has results to store and to report.
static void fail(helper *h, const ob_error *why)
{
	ob_spread_message said = { .kind = OB_SPREAD_FAILED };
	snprintf(said.record.reason, sizeof said.record.reason, "%.150s", why->text);
	ob_courier_send(h->courier, 0, &said, NULL);
	for (double end = ob_clock_wall() + grace_s; ob_clock_wall() < end && h->news != OB_COURIER_GONE; attend(h))
		ob_processes_wait(ob_courier_socket(h->courier), look_s);
}

bool ob_spread_help(const ob_experiment *x, const ob_trials *s, const ob_records *own, const ob_ranks *ranks,
		    ob_error *e)
{
	ob_error why;
	helper h = { .courier = ob_courier_start(ranks, sizeof(ob_spread_message), &why) };
	ob_processes_begin();
	bool fine = h.courier && help(&h, x, s, own, &why);
	if (h.courier && !fine)
		fail(&h, &why);
	ob_processes_end();
	if (fine)
		fine = ob_courier_end(h.courier, &why);
	else
		ob_courier_abandon(h.courier);
	return fine || ob_fail(e, "rank %u: %s", ranks->rank, why.text);
}
