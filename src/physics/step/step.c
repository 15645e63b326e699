// The step: its phases, in order, and the workers that take part in each.
//
//   host: objects placed or removed
//     │
//   BROADPHASE_START             ┌─────── merge the islands that a late contact joins ───────┐
//     │                          v                                                           │
//   SCRIPTS     ┌─> LINKS ──> LISTS ──(deal)──> ISLANDS ──> BROADPHASE ──(merge pairs)──> LATE_CONTACTS
//     │         │                                                                            │
//   FORECAST ───┘                                                                         (commit)
//     ^                                                                                      v
//     └──────(begin)─────────── COMPLETE <───── SENSE <─────────────────────────────────── COPY
//                               │      ^
//                       host <── PAUSE  └── no object is due, and no pair comes near: the step is complete as it begins
//
// Phases run in parallel between two openings of the gate (table/gate.h). The last worker to arrive, the scheduling
// worker, alone does the parts in brackets and chooses the next phase. Tasks of a phase are claimed by any free worker;
// with a worker per object each does its own.
//
// Contained simulators (table/outbox.h) write nothing in place: the arranger, always the last to arrive, writes the
// results that they hand over (commit.h), and needs no COPY. There the host resumes the run by RESUME, in which the
// arranger alone takes part.
//
//   phase             task of a worker          reads                             writes
//   BROADPHASE_START  objects whose fat AABB    index, fat AABBs, pairs           pairs of theirs that end, and that
//   BROADPHASE          has changed                                                 begin
//   SCRIPTS           an object's script        motions, passports                its cell
//   FORECAST          256 pairs                 schedule records, motions         expected, limit of those pairs, and
//                                                                                   their entries in the calendar
//   LINKS             64 due bodies, and        pairs, schedule records           bodies involved; the forest of them
//                       bodies linked to them                                       (table/forest.h)
//   LISTS             32 islands                pairs, schedule records,          their lists of pairs; for these,
//                                                 members of all islands            in_island, limit, calendar entries
//   ISLANDS           a chunk of islands        motions and contacts              staged motions, fat AABBs, schedule
//                                                 before the step                   records, their entries in the
//                                                                                   calendar, contacts after the step
//   LATE_CONTACTS     256 pairs                 schedule records, motions         likewise, and late
//                                                 before the step and staged
//   COPY              32 islands                staged motions                    slots; no object is in an island
//                     (worker per object) the   result of its island's solver     its own slot
//                       worker's own object
//   SENSE             a sensor                  motions before the step and its   its samples
//                     (worker per object) the     own, contacts, joints
//                       worker's own
//   BASELINE          (ODE's world) all objects all of it                         all of it
//
// A phase without work is skipped. The scheduling worker itself checks few pairs, and finds the islands of few bodies,
// of contained simulators, and where each object has a worker; there it publishes, too: see the open_ functions.
#include "baseline/ode_baseline.h"
#include "exchange/commit.h"
#include "exchange/results.h"
#include "sensor/sensor.h"
#include "step/broadphase.h"
#include "step/budget.h"
#include "step/fault.h"
#include "step/invariants.h"
#include "step/island_builder.h"
#include "step/islands.h"
#include "step/late_contacts.h"
#include "step/pairs.h"
#include "step/prefetch.h"
#include "step/profile.h"
#include "step/publish.h"
#include "step/scripts.h"
#include "step/sim.h"
#include "step/state.h"
#include "table/home.h"

enum {
	QUERIES_PER_WORKER = 16, // for fewer the gate costs more than another worker gains
	SCRIPTS_PER_WORKER = 16, // likewise
	SENSED_PER_WORKER = 4096, // likewise: numbers that the universe keeps of sensors
	PARALLEL_PAIRS = 4 * OB_LATE_CONTACTS_BATCH, // checked by all workers from here on, for the same reason
};

// Data of the serial parts.
typedef struct scheduler {
	ob_universe *u;
	ob_sim *sim; // the scheduling worker's; NULL: the host resumes the run
	ob_cluster *cluster; // NULL: this is the only rank
	ob_step_data *data;
	const ob_run_settings *settings;
} scheduler;

typedef struct step_phase {
	// Opens the gate to the participants. false: the phase is over already, as there was no work, or the scheduling
	// worker has done it. NULL: a serial part alone.
	bool (*open)(const scheduler *c, ob_phase phase);
	void (*work)(ob_sim *s); // a participant's share
	ob_phase (*next)(const scheduler *c); // the serial part after it; returns the next phase
	ob_profile_section section; // section for a participant's time, unless it names another
	ob_trace_kind span;
	uint32_t per_worker; // tasks for each worker that takes part; 0: all workers do
} step_phase;

// ---- participants

// Opens tasks 0 .. tasks-1 to so many workers, the scheduling worker first: it need not be woken.
static void open_tasks(const scheduler *c, ob_phase phase, uint32_t tasks, uint32_t workers)
{
	const uint32_t all = ob_universe_simulators(c->u),
		       first = ob_universe_contains(c->u) ? 0 : ob_step_scheduler(c->u);
	uint32_t *who = c->data->scratch;
	ob_task_reset(c->u, tasks, workers < all ? workers : all);
	if (workers >= all) {
		ob_gate_open(c->u, phase, NULL, 0);
		return;
	}
	for (uint32_t i = 0; i < workers; i++)
		who[i] = (first + i) % all;
	for (uint32_t i = workers; i < all && phase == OB_PHASE_ISLANDS; i++)
		ob_worker_set_objects(c->u, (first + i) % all, 0);
	ob_gate_open(c->u, phase, who, workers);
}

static bool open_broadphase(const scheduler *c, ob_phase phase)
{
	uint32_t count;
	const uint32_t *list = ob_requery_list(c->u, &count);
	if (!count)
		return false;
	for (uint32_t i = 0; i < count; i++) {
		ob_index_prefetch(c->u, list, i, count);
		if (ob_object_in_range(c->data, list[i]))
			ob_index_put(c->u, list[i]);
	}
	if (c->settings->one_per_object)
		ob_gate_open(c->u, phase, list, count);
	else
		open_tasks(c, phase, count, 1 + count / QUERIES_PER_WORKER);
	return true;
}

static bool open_scripts(const scheduler *c, ob_phase phase)
{
	const ob_step_data *data = c->data;
	const uint32_t due = data->script_counts->due;
	if (!due)
		return false;
	if (!c->settings->one_per_object) {
		open_tasks(c, phase, due, 1 + due / SCRIPTS_PER_WORKER);
		return true;
	}
	for (uint32_t i = 0; i < due; i++)
		data->scratch[i] = data->script_turn[data->script_due[i]].object;
	ob_gate_open(c->u, phase, data->scratch, due);
	return true;
}

// Opens the gate to n simulators on this rank. With none, the gate still has to wait for other ranks.
static void open_gate_here(const scheduler *c, ob_phase phase, uint32_t *who, uint32_t n)
{
	uint32_t first;
	const uint32_t each = ob_universe_simulators_here(c->u, &first);
	if (!n)
		who[0] = (first + each) % ob_universe_simulators(c->u); // a simulator elsewhere
	ob_gate_open(c->u, phase, who, n ? n : 1);
}

// Opens one chunk to each simulator; it may be empty (island_builder.h).
static bool open_shares(const scheduler *c, ob_phase phase)
{
	const ob_step_data *data = c->data;
	const uint32_t all = data->count->chunks;
	uint32_t n = 0;
	ob_task_reset(c->u, all, all);
	if (c->cluster)
		ob_islands_list_dealt_pairs(c->u, ob_cluster_halo(c->cluster));
	for (uint32_t w = 0; w < all; w++)
		if (data->chunk[w] < data->chunk[w + 1])
			data->scratch[n++] = w;
		else
			ob_worker_set_objects(c->u, w, 0);
	open_gate_here(c, phase, data->scratch, n);
	return true;
}

// True if so much is solved in this step that all workers arrange it, and they can write each other's data.
static bool is_arranged_together(const scheduler *c)
{
	const bool alone = ob_universe_simulators(c->u) == 1 && !c->settings->timed;
	return c->data->count->rooted && !alone && !c->settings->one_per_object && !ob_universe_contains(c->u);
}

// Opens the phase to all workers, or has the scheduling worker do it at once.
static bool open_arranging(const scheduler *c, ob_phase phase)
{
	const bool links = phase == OB_PHASE_LINKS;
	const uint32_t tasks = links ? ob_islands_link_tasks(c->u) : ob_islands_list_tasks(c->u);
	if (is_arranged_together(c)) {
		open_tasks(c, phase, tasks, ob_universe_simulators(c->u));
		return true;
	}
	for (uint32_t i = 0; i < tasks; i++)
		if (links)
			ob_islands_link(c->u, i);
		else
			ob_islands_list_pairs(c->u, i);
	return false;
}

static bool open_islands(const scheduler *c, ob_phase phase)
{
	const ob_step_data *data = c->data;
	uint32_t n = 0;
	if (data->count->shared)
		return open_shares(c, phase);
	if (!c->settings->one_per_object) {
		open_tasks(c, phase, data->count->chunks, data->count->chunks);
		return true;
	}
	for (uint32_t i = 0; i < data->chunk[data->count->chunks]; i++) // the worker of the first member solves it
		data->scratch[n++] = data->member[data->island[i].first_member];
	ob_gate_open(c->u, phase, data->scratch, n);
	return true;
}

// Opens the check of a rank's own pairs. Every rank runs this phase, even without pairs: it exchanges results.
static bool open_own_pairs(const scheduler *c, ob_phase phase)
{
	uint32_t first;
	ob_late_contacts_leave_to_others(c->u);
	const uint32_t each = ob_universe_simulators_here(c->u, &first), pairs = ob_checks_count(c->data),
		       tasks = (pairs + OB_LATE_CONTACTS_BATCH - 1) / OB_LATE_CONTACTS_BATCH,
		       workers = tasks < each ? tasks : each;
	uint32_t *who = c->data->scratch;
	ob_task_reset_from(c->u, tasks, first, workers);
	for (uint32_t i = 0; i < workers; i++)
		who[i] = first + i;
	open_gate_here(c, phase, who, workers);
	return true;
}

// Opens the check of pairs; few of them the scheduling worker checks at once.
static bool open_pairs(const scheduler *c, ob_phase phase)
{
	const bool solved = phase == OB_PHASE_LATE_CONTACTS;
	const uint32_t all = ob_universe_simulators(c->u);
	ob_late_contacts_begin(c->u, solved);
	const uint32_t pairs = ob_checks_count(c->data);
	if (c->cluster)
		return open_own_pairs(c, phase);
	const bool alone = all == 1 && !c->settings->timed; // in timed runs the parallel part is measured apart
	const bool serial = pairs < PARALLEL_PAIRS || alone || c->settings->one_per_object;
	if (!pairs)
		return false;
	if (serial && c->sim) {
		ob_late_contacts_check(c->sim, 0, pairs, solved);
		ob_worker_set_object(c->u, c->sim->worker, OB_NO_OBJECT);
		return false;
	}
	ob_task_reset(c->u, (pairs + OB_LATE_CONTACTS_BATCH - 1) / OB_LATE_CONTACTS_BATCH, all);
	if (!c->settings->one_per_object) {
		ob_gate_open(c->u, phase, NULL, 0);
		return true;
	}
	uint32_t first = 0;
	const uint32_t last = all - 1;
	while (first < last &&
	       !ob_schedule_is_dynamic(&c->data->schedule[first])) // pairs are checked by a worker with a dynamic
		// object
		first++;
	ob_gate_open(c->u, phase, &first, 1);
	return true;
}

// Opens the copy of results. With a worker per object: to objects solved by another one's worker. Else few islands are
// published at once.
static bool open_copy(const scheduler *c, ob_phase phase)
{
	const ob_step_data *data = c->data;
	const uint32_t islands = data->count->islands;
	uint32_t n = 0;
	if (is_arranged_together(c)) {
		open_tasks(c, phase, (islands + OB_ISLANDS_AT_ONCE - 1) / OB_ISLANDS_AT_ONCE,
			   ob_universe_simulators(c->u));
		return true;
	}
	ob_results_commit(c->sim, 0, islands);
	if (!c->settings->one_per_object || ob_universe_contains(c->u))
		return false;
	for (uint32_t i = 0; i < data->count->islands; i++)
		for (uint32_t k = 1; k < data->island[i].members; k++)
			data->scratch[n++] = data->member[data->island[i].first_member + k];
	if (n)
		ob_gate_open(c->u, phase, data->scratch, n);
	return n;
}

// Opens the phase to the workers of objects with sensors, or to enough workers of a pool; few sensors, and those of contained
// simulators, the scheduling worker reads at once.
static bool open_sense(const scheduler *c, ob_phase phase)
{
	const ob_step_data *data = c->data;
	uint32_t *who = data->scratch, *listed = data->scratch + data->objects_max, n = 0;
	if (!data->sensors)
		return false;
	const uint32_t workers = 1 + (uint32_t)(ob_sensors_numbers(c->u) / SENSED_PER_WORKER);
	const bool each = c->settings->one_per_object && !ob_universe_contains(c->u);
	if (!each && (workers == 1 || ob_universe_simulators(c->u) == 1 || ob_universe_contains(c->u))) {
		for (uint32_t i = 0; i < data->sensors; i++)
			ob_sensor_sample(c->u, i);
		return false;
	}
	if (!each) {
		open_tasks(c, phase, data->sensors, workers);
		return true;
	}
	for (uint32_t i = 0; i < data->sensors; i++)
		if (ob_object_in_range(data, data->sensor[i].object))
			listed[data->sensor[i].object] = 0;
	if (data->count->failure)
		return false;
	for (uint32_t i = 0; i < data->sensors; i++)
		if (!listed[data->sensor[i].object]++)
			who[n++] = data->sensor[i].object;
	ob_gate_open(c->u, phase, who, n);
	return true;
}

static bool open_baseline(const scheduler *c, ob_phase phase)
{
	ob_gate_open(c->u, phase, NULL, 0);
	return true;
}

static bool open_pause(const scheduler *c, ob_phase phase)
{
	ob_gate_pause(c->u);
	return true;
}

// ---- work of a participant

static void do_nothing(ob_sim *s)
{
	(void)s;
}

static void query(ob_sim *s, uint32_t id)
{
	enum { TESTS_PER_WORK = 16 };
	const uint64_t tests = s->solver.counters.box_tests;
	ob_budget_begin_share(s, id);
	ob_pairs_query(s->u, id, &s->solver.counters.box_tests);
	ob_budget_note(&s->solver, (s->solver.counters.box_tests - tests) / TESTS_PER_WORK);
	ob_budget_spent(&s->solver);
}

static void query_neighbours(ob_sim *s)
{
	enum { QUERIES_AHEAD = 3 };
	uint32_t count, i;
	const uint32_t *list = ob_requery_list(s->u, &count);
	if (s->settings->one_per_object)
		query(s, s->worker);
	else
		while (ob_task_claim(s->u, &i) && (s->settings->freezes || ob_step_failed(s->u, NULL) == OB_STEP_OK)) {
			if (i + QUERIES_AHEAD < count)
				ob_prefetch_query(s->u, list[i + QUERIES_AHEAD]);
			ob_prefetch_lists(s->u, list, i, count);
			query(s, list[i]);
			ob_profile_task_done(s, i);
		}
}

static void check_pairs(ob_sim *s, bool solved)
{
	const uint32_t pairs = ob_checks_count(s->data);
	uint32_t i;
	while (ob_task_claim(s->u, &i)) {
		uint32_t first = i * OB_LATE_CONTACTS_BATCH, end = first + OB_LATE_CONTACTS_BATCH;
		ob_late_contacts_check(s, first, end < pairs ? end : pairs, solved);
		ob_profile_task_done(s, i);
	}
}

static void forecast_contacts(ob_sim *s)
{
	check_pairs(s, false);
}

static void find_late_contacts(ob_sim *s)
{
	check_pairs(s, true);
}

static void arrange_by(ob_sim *s, void (*work)(ob_universe *u, uint32_t task))
{
	uint32_t i;
	while (ob_task_claim(s->u, &i)) {
		work(s->u, i);
		ob_profile_task_done(s, i);
	}
}

static void link_bodies(ob_sim *s)
{
	arrange_by(s, ob_islands_link);
}

static void list_pairs(ob_sim *s)
{
	arrange_by(s, ob_islands_list_pairs);
}

// Solves n islands of a chunk, side by side where they fly; begins: they are its first.
static void solve_abreast(ob_sim *s, uint32_t first, uint32_t n, bool begins)
{
	bool flown[OB_ISLANDS_ABREAST];
	bool shown = ob_span_island_begin(s, first, begins);
	ob_islands_fly(s, first, n, flown);
	for (uint32_t k = 0; k < n; k++) {
		if (k)
			shown = ob_span_island_begin(s, first + k, false);
		if (!flown[k])
			ob_island_advance(s, first + k);
		if (shown)
			ob_span_island_end(s, first + k);
		ob_fault_chance(s);
		ob_profile_task_done(s, first + k);
	}
}

// Returns the next chunk: the worker's own if chunks are shared out, else one that it claims. Contained simulators
// claim so that chunk w is worker w's.
static bool next_chunk(const ob_sim *s, uint32_t *chunks, uint32_t *chunk)
{
	if (!s->data->count->shared || ob_universe_contains(s->u))
		return ob_task_claim(s->u, chunk);
	*chunk = s->worker;
	return (*chunks)++ == 0 && s->worker < s->data->count->chunks;
}

static void note_home(const ob_sim *s, uint32_t island)
{
	const ob_island *is = &s->data->island[island];
	for (uint32_t k = 0; k < is->members; k++)
		ob_home_set(s->u, s->data->member[is->first_member + k], s->worker);
}

// Prefetches the data of n islands from the first on, which lie anywhere.
static void prefetch_islands(ob_sim *s, uint32_t first, uint32_t n)
{
	for (uint32_t k = 0; k < n; k++)
		ob_prefetch_island(s, first + k);
}

static void solve_islands(ob_sim *s)
{
	const ob_step_data *data = s->data;
	// else they are noted when islands are dealt
	const bool notes = !data->count->shared && !ob_universe_contains(s->u);
	// an object may fail there, with a budget of its own
	const uint32_t most = s->settings->freezes ? 1 : OB_ISLANDS_ABREAST;
	uint32_t chunk, chunks = 0, objects = 0;
	if (s->settings->one_per_object) {
		solve_abreast(s, data->result_island[s->worker], 1, true);
		return;
	}
	while (next_chunk(s, &chunks, &chunk)) {
		const uint32_t first = data->chunk[chunk], end = data->chunk[chunk + 1];
		ob_span_chunk_begin(s);
		for (uint32_t i = first, n; i < end; i += n) {
			n = end - i < most ? end - i : most;
			prefetch_islands(s, i, n);
			// Another worker writes the data beyond the chunk.
			for (uint32_t k = i + n; k < i + 2 * n && k < end; k++)
				ob_prefetch_members(s->u, k);
			solve_abreast(s, i, n, i == first);
			for (uint32_t k = i; k < i + n; k++) {
				if (notes)
					note_home(s, k);
				objects += data->island[k].members;
			}
		}
		ob_span_chunk_end(s, chunk);
	}
	ob_worker_set_objects(s->u, s->worker, objects);
}

static void publish_results(ob_sim *s)
{
	const uint32_t islands = s->data->count->islands;
	uint32_t i;
	if (s->settings->one_per_object) {
		ob_result_copy(s, s->worker);
		return;
	}
	while (ob_task_claim(s->u, &i)) {
		const uint32_t first = i * OB_ISLANDS_AT_ONCE, end = first + OB_ISLANDS_AT_ONCE;
		ob_results_commit(s, first, end < islands ? end : islands);
		ob_profile_task_done(s, i);
	}
}

static void read_sensors(ob_sim *s)
{
	uint32_t i;
	for (i = 0; s->settings->one_per_object && i < s->data->sensors; i++)
		if (s->data->sensor[i].object == s->worker)
			ob_sensor_sample(s->u, i);
	while (!s->settings->one_per_object && ob_task_claim(s->u, &i)) {
		ob_sensor_sample(s->u, i);
		ob_profile_task_done(s, i);
	}
}

static void step_baseline(ob_sim *s)
{
	ob_ode_baseline_step(s->baseline);
	s->solver.counters.box_tests = ob_ode_baseline_box_tests(s->baseline);
}

// ---- the serial parts

// True if the run pauses here. The host may request a pause at a step that has just passed: then it is the next one.
// Other ranks' motions may be missing here if the request came late: they come when the others receive it.
static bool must_pause(const scheduler *c)
{
	return ob_step_count(c->u) >= ob_gate_pause_step(c->u) &&
	       (ob_cluster_is_whole(c->cluster) || ob_gate_stopped(c->u));
}

static ob_phase build_islands(const scheduler *c)
{
	c->data->count->islands = 0;
	ob_move_make(c->u, ob_cluster_begin(c->cluster, c->u));
	if (!ob_cluster_is_due(c->cluster, c->u))
		return OB_PHASE_SENSE;
	ob_cluster_end_contacts(c->cluster, c->u);
	ob_islands_begin(c->u);
	ob_cluster_involve_links(c->cluster, c->u);
	return OB_PHASE_LINKS;
}

static ob_phase after_links(const scheduler *c)
{
	bool elsewhere;
	if (!ob_cluster_share_islands(c->cluster, c->u, &elsewhere))
		return OB_PHASE_PAUSE;
	ob_islands_list_members(c->u);
	return elsewhere || c->data->count->islands ? OB_PHASE_LISTS : OB_PHASE_SENSE;
}

static ob_phase after_lists(const scheduler *c)
{
	ob_islands_deal(c->u, ob_cluster_regions(c->cluster));
	return OB_PHASE_ISLANDS;
}

static ob_phase begin_step(const scheduler *c)
{
	struct ob_step_counts *count = c->data->count;
	const uint64_t step = ob_step_count(c->u);
	if (must_pause(c))
		return OB_PHASE_PAUSE;
	if (ob_scripts_due(c->u))
		return OB_PHASE_SCRIPTS;
	if (c->settings->monolith)
		return OB_PHASE_BASELINE;
	return count->checked != step && ob_cluster_is_due(c->cluster, c->u) ? OB_PHASE_FORECAST : build_islands(c);
}

// Counts awake and kinematic objects, after any have been changed.
static void count_awake(const scheduler *c)
{
	const uint32_t ids = ob_universe_ids(c->u);
	const ob_schedule *object = c->data->schedule;
	uint32_t n = 0, kinematic = 0;
	for (uint32_t id = 0; id < ids; id++) {
		const uint32_t state = object[id].state;
		kinematic += state == OB_SCHEDULE_KINEMATIC;
		n += state == OB_SCHEDULE_AWAKE || state == OB_SCHEDULE_EQUILIBRIUM;
	}
	c->data->count->awake = n;
	c->data->count->kinematic = kinematic;
}

static ob_phase after_resume(const scheduler *c)
{
	count_awake(c);
	if (c->settings->monolith)
		ob_requery_reset(c->u); // ODE's world finds its own neighbours
	ob_cluster_settle(c->cluster, c->u);
	return OB_PHASE_BROADPHASE_START;
}

// Merges the changes of pairs. next: the phase after it; if it checks new pairs, it measures their distances, too, but
// contained simulators would have to hand them over. false: the step has failed.
static bool merge_pairs(const scheduler *c, uint64_t steps, ob_phase next)
{
	const bool checked = next == OB_PHASE_FORECAST || next == OB_PHASE_LATE_CONTACTS;
	ob_cluster_follow(c->cluster, c->u);
	ob_pairs_merge(c->u, steps);
	if (!ob_cluster_meet(c->cluster, c->u))
		return false;
	if (!checked || ob_universe_contains(c->u))
		ob_pairs_measure(c->u, steps);
	return ob_invariants_check(c->u, OB_INVARIANTS_AFTER_MERGE);
}

static ob_phase after_broadphase_start(const scheduler *c)
{
	uint32_t queries;
	ob_requery_list(c->u, &queries);
	if (!queries)
		return begin_step(c);
	const bool had_run = ob_scripts_had_run(c->u);
	const ob_phase next = !must_pause(c) && ob_scripts_due(c->u) ? OB_PHASE_SCRIPTS : OB_PHASE_FORECAST;
	const bool merged = merge_pairs(c, ob_step_count(c->u), next);
	if (!had_run && ob_step_failed(c->u, NULL) != OB_STEP_OK)
		ob_scripts_forget(c->u);
	return merged ? next : OB_PHASE_PAUSE;
}

// Queries the neighbours of objects whose motion has changed. The host creates and removes objects at once. Where it resumes,
// and no script is due, it comes here itself, as no simulator.
static ob_phase after_scripts(const scheduler *c)
{
	uint32_t queries;
	if (c->data->script_counts->due && ob_scripts_carry_out(c->sim))
		count_awake(c);
	ob_cluster_settle(c->cluster, c->u); // for motions that scripts have changed
	if (ob_scripts_have_requests(c->u))
		return OB_PHASE_PAUSE;
	if (c->settings->monolith)
		return OB_PHASE_BASELINE;
	ob_requery_list(c->u, &queries);
	return queries ? OB_PHASE_BROADPHASE_START : OB_PHASE_FORECAST;
}

static ob_phase after_forecast(const scheduler *c)
{
	ob_late_contacts_end(c->u);
	return must_pause(c) ? OB_PHASE_PAUSE : build_islands(c);
}

static ob_phase after_islands(const scheduler *c)
{
	return OB_PHASE_BROADPHASE;
}

static ob_phase after_broadphase(const scheduler *c)
{
	const ob_phase next = OB_PHASE_LATE_CONTACTS;
	return merge_pairs(c, ob_step_count(c->u) + 1, next) ? next : OB_PHASE_PAUSE;
}

static ob_phase after_late_contacts(const scheduler *c)
{
	const bool late = c->data->count->late;
	ob_late_contacts_end(c->u);
	c->sim->solver.counters.island_merges += late;
	*ob_worker_counters(c->u, c->sim->worker) = c->sim->solver.counters; // before any reader may look
	if (late) {
		ob_islands_merge(c->u);
		return after_links(c);
	}
	return OB_PHASE_COPY;
}

static ob_phase after_copy(const scheduler *c)
{
	return OB_PHASE_SENSE;
}

static ob_phase after_sense(const scheduler *c)
{
	return OB_PHASE_COMPLETE;
}

static ob_phase after_baseline(const scheduler *c)
{
	count_awake(c);
	return OB_PHASE_SENSE;
}

// Looks for contacts of objects whose joint has broken in the step that is complete. Returns true if there are any.
static bool free_broken(const scheduler *c)
{
	const ob_step_data *data = c->data;
	const uint32_t end = ob_universe_settings(c->u)->monolith ? 0 : ob_joints_end(data);
	bool any = false;
	for (uint32_t i = 0; i < end; i++)
		for (int side = 0; ob_joint_broke_now(c->u, i) && side < 2; side++) {
			const uint32_t id = data->joint[i].object[side];
			if (id >= data->objects_max || !ob_schedule_is_dynamic(&data->schedule[id]))
				continue;
			ob_pairs_requery(c->u, id);
			any = true;
		}
	return any;
}

static ob_phase complete_step(const scheduler *c)
{
	struct ob_step_counts *count = c->data->count;
	count->merged = 0; // queries between steps end pairs as they do after a resume
	ob_step_complete(c->u, count->awake, count->pairs - count->pairs_idle, ob_cluster_islands(c->cluster, c->u));
	ob_step_work_reset(c->u);
	if (!ob_cluster_gather(c->cluster, c->u) || !ob_invariants_check(c->u, OB_INVARIANTS_AFTER_STEP))
		return OB_PHASE_PAUSE;
	return free_broken(c) ? OB_PHASE_BROADPHASE_START : begin_step(c);
}

// ---- the step

// clang-format off
static const step_phase phases[] = {
	[OB_PHASE_RESUME]           = { NULL,            do_nothing,         after_resume,           OB_PROFILE_SCHEDULE,   OB_TRACE_SCHEDULE, 0 },
	[OB_PHASE_BROADPHASE_START] = { open_broadphase, query_neighbours,   after_broadphase_start, OB_PROFILE_BROADPHASE, OB_TRACE_OBJECTS, QUERIES_PER_WORKER },
	[OB_PHASE_SCRIPTS]          = { open_scripts,    ob_scripts_run,     after_scripts,          OB_PROFILE_SCRIPTS,    OB_TRACE_OBJECTS, SCRIPTS_PER_WORKER },
	[OB_PHASE_FORECAST]         = { open_pairs,      forecast_contacts,  after_forecast,         OB_PROFILE_BROADPHASE, OB_TRACE_OBJECTS, 0 },
	[OB_PHASE_LINKS]            = { open_arranging,  link_bodies,        after_links,            OB_PROFILE_SCHEDULE,   OB_TRACE_SCHEDULE, 0 },
	[OB_PHASE_LISTS]            = { open_arranging,  list_pairs,         after_lists,            OB_PROFILE_SCHEDULE,   OB_TRACE_SCHEDULE, 0 },
	[OB_PHASE_ISLANDS]          = { open_islands,    solve_islands,      after_islands,          OB_PROFILE_LOAD,       OB_TRACE_SOLVE, 0 },
	[OB_PHASE_BROADPHASE]       = { open_broadphase, query_neighbours,   after_broadphase,       OB_PROFILE_BROADPHASE, OB_TRACE_OBJECTS, QUERIES_PER_WORKER },
	[OB_PHASE_LATE_CONTACTS]    = { open_pairs,      find_late_contacts, after_late_contacts,    OB_PROFILE_BROADPHASE, OB_TRACE_OBJECTS, 0 },
	[OB_PHASE_COPY]             = { open_copy,       publish_results,    after_copy,             OB_PROFILE_PUBLISH,    OB_TRACE_OBJECTS, 0 },
	[OB_PHASE_SENSE]            = { open_sense,      read_sensors,       after_sense,            OB_PROFILE_PUBLISH,      OB_TRACE_OBJECTS, 0 },
	[OB_PHASE_COMPLETE]         = { NULL,            NULL,               complete_step,          OB_PROFILE_SCHEDULE,   OB_TRACE_SCHEDULE, 0 },
	[OB_PHASE_BASELINE]         = { open_baseline,   step_baseline,      after_baseline,         OB_PROFILE_SOLVE,      OB_TRACE_SOLVE, 0 },
	[OB_PHASE_PAUSE]            = { open_pause,      NULL,               NULL,                   OB_PROFILE_SCHEDULE,   OB_TRACE_SCHEDULE, 0 },
};
// clang-format on

// Returns the phase that follows. A failed step publishes nothing more: the universe stays at the step before.
static ob_phase next_phase(const scheduler *c, ob_phase finished)
{
	if (c->settings->freezes)
		ob_crowd_limit_work(c->u, finished == OB_PHASE_ISLANDS);
	return ob_step_failed(c->u, NULL) == OB_STEP_OK ? phases[finished].next(c) : OB_PHASE_PAUSE;
}

// Runs from this phase to the first for which the gate opens, or to a pause. Returns which.
static ob_phase open_from(const scheduler *c, ob_phase phase)
{
	while (!phases[phase].open || !phases[phase].open(c, phase))
		phase = next_phase(c, phase);
	return phase;
}

// Chooses the next phase; the last worker to arrive alone calls it. Returns the phase of the open gate, or PAUSE.
static ob_phase schedule(ob_sim *s, ob_phase finished)
{
	const scheduler c = { s->u, s, s->cluster, s->data, s->settings };
	ob_critical_path_close(s->u, finished, phases[finished].per_worker);
	ob_profile_begin(s, OB_PROFILE_SCHEDULE);
	ob_step_set_scheduler(s->u, s->worker);
	const ob_phase due = next_phase(&c, finished);
	ob_fault_chance(s);
	const ob_phase next = open_from(&c, due);
	ob_critical_add_alone(s->u, ob_profile_end(s));
	return next;
}

// Runs the arranger: commits results at the end of each phase, and schedules the next, until the host takes over.
// false: STOP.
static bool arrange(ob_sim *s, ob_phase phase)
{
	while (phase != OB_PHASE_PAUSE) {
		if (!ob_commit(s->committer, s->u, phase))
			return false;
		for (uint32_t pair; ob_cluster_take_checked(s->cluster, &pair);)
			ob_late_contacts_take(s->u, pair);
		phase = schedule(s, phase);
	}
	return true;
}

bool ob_step(ob_sim *s)
{
	ob_span_turn(s, OB_TRACE_WAIT);
	ob_phase phase = ob_turn_wait(s->u, s->worker);
	if (phase == OB_PHASE_STOP) {
		ob_span_turn(s, OB_TRACE_NONE);
		return false;
	}
	ob_span_turn(s, phases[phase].span);
	ob_profile_begin(s, phases[phase].section);
	phases[phase].work(s);
	ob_worker_set_object(s->u, s->worker, OB_NO_OBJECT);
	ob_fault_chance(s);
	const uint64_t worked = ob_profile_end(s);
	ob_phase_worked(s->u, worked, ob_profile_beside(s, worked));
	if (ob_universe_contained(s->u))
		ob_outbox_end_of(s->u)->counters = s->solver.counters;
	else
		*ob_worker_counters(s->u, s->worker) = s->solver.counters;
	if (ob_turn_arrive(s->u, s->worker)) {
		ob_span_turn(s, OB_TRACE_SCHEDULE);
		phase = schedule(s, phase);
		if (s->committer)
			return arrange(s, phase);
	}
	return true;
}

void ob_sim_resume(ob_universe *u)
{
	const scheduler c = { u, NULL, NULL, ob_universe_step_data(u), ob_universe_settings(u) };
	const uint32_t arranger = ob_universe_simulators(u);
	if (!ob_invariants_check(u, OB_INVARIANTS_AT_RESUME)) // it stays paused, and ob_sim_failure gives the reason
		return;
	ob_step_begin(u);
	if (ob_universe_contains(u))
		ob_gate_open(u, OB_PHASE_RESUME, &arranger, 1);
	else
		open_from(&c, after_resume(&c));
}
