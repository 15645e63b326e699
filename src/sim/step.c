#include "sim/step.h"

#include "sim/broadphase.h"
#include "sim/island_builder.h"
#include "sim/late_contacts.h"
#include "sim/publish.h"
#include "sim/sim.h"

enum { HANDFUL = 16 }; // perceivers: for fewer the gate would cost more than a second worker gains

static bool own_worker_each(const ob_universe *u)
{
	return ob_universe_settings(u)->one_per_object;
}

// A pool: indices 0 .. total-1 are claimed by as many workers as there is work for. The one who arranges is the first
// of them, for it need not be woken.
static void open_pool(ob_universe *u, ob_phase phase, uint32_t total, uint32_t enough)
{
	uint32_t workers = ob_universe_workers(u), *who = ob_universe_step_data(u)->scratch;
	uint32_t first = ob_universe_step_data(u)->count->scheduler;
	ob_task_reset(u, total);
	if (enough >= workers) {
		ob_gate_open(u, phase, NULL, 0);
		return;
	}
	for (uint32_t i = 0; i < enough; i++)
		who[i] = (first + i) % workers;
	for (uint32_t i = enough; i < workers && phase == OB_PHASE_ISLANDS; i++)
		ob_worker_set_objects(u, (first + i) % workers, 0);
	ob_gate_open(u, phase, who, enough);
}

// Those that have asked look around.
static void open_perceivers(ob_universe *u, uint32_t stage)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t count;
	const uint32_t *list = ob_requery_list(u, &count);
	for (uint32_t i = 0; i < count; i++)
		ob_index_put(u, list[i]);
	ex->count->stage = stage;
	if (own_worker_each(u))
		ob_gate_open(u, OB_PHASE_OBJECTS, list, count);
	else
		open_pool(u, OB_PHASE_OBJECTS, count, 1 + count / HANDFUL);
}

// With one worker per object: those whose island was solved by another. false: none.
static bool open_adopters(ob_universe *u)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t n = 0, *who = ex->scratch;
	for (uint32_t i = 0; i < ex->count->islands; i++)
		for (uint32_t k = 1; k < ex->island[i].members; k++)
			who[n++] = ex->member[ex->island[i].first_member + k];
	if (!own_worker_each(u) || !n)
		return false;
	ex->count->stage = OB_STAGE_COPY;
	ob_gate_open(u, OB_PHASE_OBJECTS, who, n);
	return true;
}

static void open_islands(ob_universe *u)
{
	ob_step_data *ex = ob_universe_step_data(u);
	if (!own_worker_each(u)) {
		open_pool(u, OB_PHASE_ISLANDS, ex->count->chunks, ex->count->chunks);
		return;
	}
	uint32_t n = 0, *who = ex->scratch;
	for (uint32_t i = 0; i < ex->chunk[ex->count->chunks]; i++)
		who[n++] = ex->member[ex->island[i].first_member];
	ob_gate_open(u, OB_PHASE_ISLANDS, who, n);
}

// Who is awake, and when the first of them is due.
static void count_awake(ob_universe *u)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t n = 0, due = UINT32_MAX;
	for (uint32_t id = 0; id < ob_universe_ids(u); id++)
		if (ex->schedule[id].state == OB_SCHEDULE_AWAKE || ex->schedule[id].state == OB_SCHEDULE_EQUILIBRIUM) {
			n++;
			due = ex->schedule[id].due < due ? ex->schedule[id].due : due;
		}
	ex->count->awake = n;
	ex->count->next_due = due;
}

// The host may ask for a pause at a step that has just gone by: then the next one will do.
static bool must_pause(const ob_universe *u)
{
	return ob_step_count(u) >= ob_gate_pause_step(u) || ob_universe_step_data(u)->count->failure;
}

static void complete_step(ob_universe *u)
{
	ob_step_data *ex = ob_universe_step_data(u);
	ob_step_complete(u, ex->count->awake, ex->count->pairs, ex->count->islands);
}

// The pairs of one step, by all workers, or by the one that asks, where it has one.
static void open_checks(ob_universe *u, uint32_t stage)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t first = 0;
	ex->count->stage = stage;
	ob_late_contacts_begin(u, stage == OB_STAGE_SOLVED);
	ob_task_reset(u, (ex->count->pairs + OB_LATE_CONTACTS_BATCH - 1) / OB_LATE_CONTACTS_BATCH);
	if (!own_worker_each(u)) {
		ob_gate_open(u, OB_PHASE_LATE_CONTACTS, NULL, 0);
		return;
	}
	while (ex->schedule[first].state < OB_SCHEDULE_AWAKE) // its worker does it; pairs are checked where somebody is awake
		first++;
	ob_gate_open(u, OB_PHASE_LATE_CONTACTS, &first, 1);
}

// Steps in which nobody is due and no pair comes near are complete as soon as they begin. s: the worker that arranges;
// NULL where the host does.
static void begin_step(ob_universe *u, ob_sim *s)
{
	ob_step_data *ex = ob_universe_step_data(u);
	if (ob_universe_settings(u)->monolith) {
		ob_gate_open(u, OB_PHASE_ISLANDS, NULL, 0);
		return;
	}
	for (;;) {
		uint64_t step = ob_step_count(u);
		if (!ex->count->awake || !ex->count->pairs)
			ex->count->next_check = UINT32_MAX;
		if (ex->count->next_check <= step && ex->count->checked != step) {
			if (!s) {
				open_checks(u, OB_STAGE_START);
				return;
			}
			ob_late_contacts_begin(u, false);
			ob_late_contacts_check(s, 0, ex->count->pairs, false);
		}
		ex->count->islands = 0;
		if (ex->count->next_check <= step || ex->count->next_due <= step)
			ob_islands_plan(u);
		if (ex->count->islands) {
			open_islands(u);
			return;
		}
		complete_step(u);
		if (must_pause(u)) {
			ob_gate_pause(u);
			return;
		}
	}
}

static void go_on(ob_universe *u, ob_sim *s)
{
	if (must_pause(u))
		ob_gate_pause(u);
	else
		begin_step(u, s);
}

static void finish_step(ob_universe *u, ob_sim *s)
{
	count_awake(u);
	complete_step(u);
	go_on(u, s);
}

static void after_meetings(ob_sim *s)
{
	ob_universe *u = s->u;
	const bool met = ob_universe_step_data(u)->count->late;
	if (ob_universe_step_data(u)->count->stage != OB_STAGE_SOLVED) {
		go_on(u, s);
		return;
	}
	s->counters.island_merges += met;
	*ob_worker_counters(u, s->worker) = s->counters; // before anybody may look
	if (met) {
		ob_islands_merge(u);
		open_islands(u);
		return;
	}
	ob_results_commit(s);
	if (!open_adopters(u))
		finish_step(u, s);
}

static void open_meetings(ob_sim *s, uint32_t stage)
{
	enum { MANY = 4 * OB_LATE_CONTACTS_BATCH }; // pairs: for fewer the gate would cost more
	ob_universe *u = s->u;
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t pairs = ex->count->pairs;
	if (pairs >= MANY && ob_universe_workers(u) > 1 && !own_worker_each(u)) {
		open_checks(u, stage);
		return;
	}
	ex->count->stage = stage;
	ob_late_contacts_begin(u, stage == OB_STAGE_SOLVED);
	ob_late_contacts_check(s, 0, pairs, stage == OB_STAGE_SOLVED);
	after_meetings(s);
}

void ob_schedule_next_phase(ob_sim *s, ob_phase finished)
{
	ob_universe *u = s->u;
	uint32_t asked, stage = ob_universe_step_data(u)->count->stage;
	ob_phase_close(u);
	ob_universe_step_data(u)->count->scheduler = s->worker;
	if (finished == OB_PHASE_ISLANDS) {
		ob_requery_list(u, &asked);
		if (ob_universe_settings(u)->monolith)
			finish_step(u, s);
		else if (asked)
			open_perceivers(u, OB_STAGE_SOLVED);
		else
			open_meetings(s, OB_STAGE_SOLVED);
	} else if (finished == OB_PHASE_LATE_CONTACTS) {
		after_meetings(s);
	} else if (stage == OB_STAGE_COPY) {
		finish_step(u, s);
	} else {
		ob_pairs_merge(u, ob_step_count(u) + (stage == OB_STAGE_SOLVED));
		open_meetings(s, stage);
	}
}

void ob_sim_resume(ob_universe *u)
{
	uint32_t asked;
	ob_step_begin(u);
	count_awake(u);
	ob_universe_step_data(u)->count->next_check = 0; // the host may have changed anything
	ob_requery_list(u, &asked);
	if (ob_universe_settings(u)->monolith)
		ob_requery_reset(u); // one world finds its own neighbours
	else if (asked) {
		open_perceivers(u, OB_STAGE_START);
		return;
	}
	go_on(u, NULL);
}

const char *ob_sim_failure(const ob_universe *u)
{
	switch (ob_universe_step_data(u)->count->failure) {
	case OB_STEP_PAIRS_FULL:
		return "more pairs of neighbours than the universe has room for: the objects lie too close together";
	case OB_STEP_NEIGHBOURS_FULL:
		return "objects perceive more neighbours than the universe has room for: they lie too close together";
	case OB_STEP_DIVERGED:
		return "a state is no longer a number: the run diverged; try more substeps or a smaller step";
	default:
		return NULL;
	}
}
