#include "table/free.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "table/futex.h"
#include "table/layout.h"

enum { NEIGHBOUR_WAIT_MS = 100, HOST_WAIT_MS = 200 };
static const uint64_t nobody = UINT64_MAX; // waits

const ob_free_settings *ob_free_settings_of(const ob_universe *u)
{
	return u->header.sizes.history ? &u->free.control->settings : NULL;
}

uint32_t ob_free_depth(const ob_universe *u)
{
	return u->header.sizes.history;
}

// ---- versions

static ob_free_cell *cell_of(const ob_universe *u, uint32_t id)
{
	return &u->free.cell[id];
}

static ob_motion *place(const ob_universe *u, uint32_t id, uint64_t version)
{
	const uint32_t depth = u->header.sizes.history;
	return &u->free.ring[(uint64_t)id * depth + version % depth];
}

uint64_t ob_free_version(const ob_universe *u, uint32_t id)
{
	return __atomic_load_n(&cell_of(u, id)->version, __ATOMIC_SEQ_CST);
}

// True if a place of a ring was not written meanwhile: see the proof in free.h.
static bool is_whole(const ob_universe *u, uint32_t id, uint64_t version, uint32_t depth)
{
	return __atomic_load_n(&cell_of(u, id)->version, __ATOMIC_RELAXED) + 2 <= version + depth;
}

static double time_at(const ob_universe *u, uint32_t id, uint64_t version)
{
	double t;
	ob_words_get(&t, &place(u, id, version)->t0, sizeof t);
	return t;
}

// Returns the newest of versions low .. high that is not after t, or low. Times of versions ascend.
static uint64_t find_version(const ob_universe *u, uint32_t id, uint64_t low, uint64_t high, double t)
{
	if (time_at(u, id, high) <= t)
		return high;
	while (low < high) {
		const uint64_t middle = (low + high + 1) / 2;
		if (time_at(u, id, middle) <= t)
			low = middle;
		else
			high = middle - 1;
	}
	return low;
}

uint64_t ob_free_read(const ob_universe *u, uint32_t id, double t, ob_motion *out, ob_motion *next)
{
	const uint32_t depth = u->header.sizes.history;
	for (int i = 0; i < OB_RING_TRIES; i++) {
		const uint64_t newest = ob_free_version(u, id), kept = newest < depth - 1 ? newest : depth - 1;
		if (newest == 0)
			return 0;
		const uint64_t v = find_version(u, id, newest - kept + 1, newest, t);
		ob_words_get(out, place(u, id, v), sizeof *out);
		if (next && v < newest)
			ob_words_get(next, place(u, id, v + 1), sizeof *next);
		else if (next)
			next->t0 = NAN;
		if (is_whole(u, id, v, depth))
			return v;
	}
	return 0;
}

// Bits of a time that is not negative: they are ordered as times are.
static uint64_t bits_of(double t)
{
	uint64_t bits;
	memcpy(&bits, &t, sizeof bits);
	return bits;
}

static double time_of(uint64_t bits)
{
	double t;
	memcpy(&t, &bits, sizeof t);
	return t;
}

// Wakes those who wait for an own time that the object has reached. In one order with the waiter's store of `awaited` and its
// load of the time: one of the two sees the other's.
static void wake_waiting(ob_free_cell *c, uint64_t time)
{
	if (__atomic_load_n(&c->awaited, __ATOMIC_SEQ_CST) > time)
		return;
	__atomic_store_n(&c->awaited, nobody, __ATOMIC_SEQ_CST);
	__atomic_fetch_add(&c->moved, 1, __ATOMIC_SEQ_CST);
	ob_futex_wake(&c->moved, ~0u);
}

static void advance(ob_universe *u, uint32_t id, double t)
{
	ob_free_cell *c = cell_of(u, id);
	__atomic_store_n(&c->time, bits_of(t), __ATOMIC_SEQ_CST);
	wake_waiting(c, bits_of(t));
}

void ob_free_publish(ob_universe *u, uint32_t id, const ob_motion *m)
{
	ob_free_cell *c = cell_of(u, id);
	const uint64_t next = __atomic_load_n(&c->version, __ATOMIC_ACQUIRE) + 1;
	ob_words_put(place(u, id, next), m, sizeof *m);
	__atomic_store_n(&c->version, next, __ATOMIC_SEQ_CST);
	advance(u, id, m->t0);
}

// Own time, s, of a flight that holds until then.
static double flight_time(const ob_universe *u, double holds)
{
	const ob_free_control *c = u->free.control;
	const double until = __atomic_load_n(&c->until, __ATOMIC_SEQ_CST) * u->header.run.step_length,
		     t = ob_min(holds, until);
	double stands, pace;
	__atomic_load(&c->pace, &pace, __ATOMIC_ACQUIRE);
	if (isinf(pace))
		return t;
	__atomic_load(&c->stands, &stands, __ATOMIC_ACQUIRE);
	const uint64_t since = ob_clock_ns() - __atomic_load_n(&c->begun_ns, __ATOMIC_ACQUIRE);
	return ob_min(t, ob_min(stands, 1e-9 * (double)since * pace));
}

double ob_free_holds(const ob_universe *u, uint32_t id)
{
	return time_of(__atomic_load_n(&cell_of(u, id)->holds, __ATOMIC_SEQ_CST));
}

double ob_free_time(const ob_universe *u, uint32_t id)
{
	const ob_free_cell *c = cell_of(u, id);
	if (u->header.sizes.grouped)
		return ob_group_step(u, id) * u->header.run.step_length;
	for (;;) {
		const uint64_t holds = __atomic_load_n(&c->holds, __ATOMIC_SEQ_CST),
			       time = __atomic_load_n(&c->time, __ATOMIC_SEQ_CST);
		if (__atomic_load_n(&c->holds, __ATOMIC_SEQ_CST) == holds)
			return holds ? ob_max(time_of(time), flight_time(u, time_of(holds))) : time_of(time);
	}
}

double ob_free_rate(const ob_universe *u, uint32_t id)
{
	float f;
	__atomic_load(&cell_of(u, id)->update_rate, &f, __ATOMIC_RELAXED);
	return f > 0 ? (double)f : u->free.control->settings.update_rate;
}

ob_free_kind ob_free_kind_of(const ob_universe *u, uint32_t id, uint32_t *generation)
{
	const ob_free_cell *c = cell_of(u, id);
	const uint32_t kind = __atomic_load_n(&c->kind, __ATOMIC_ACQUIRE);
	if (generation)
		*generation = __atomic_load_n(&c->generation, __ATOMIC_RELAXED);
	return (ob_free_kind)kind;
}

// ---- bounds

static void note_change(ob_universe *u, uint32_t id)
{
	ob_free_group *g = &u->free.group[id / OB_FREE_GROUP];
	const uint32_t number = __atomic_fetch_add(&g->moved, 1, __ATOMIC_SEQ_CST);
	__atomic_store_n(&g->change[number % OB_FREE_CHANGES], (uint64_t)(number + 1) << 32 | id, __ATOMIC_RELEASE);
}

void ob_free_publish_bounds(ob_universe *u, uint32_t id, const float box[6])
{
	ob_word words[3];
	memcpy(words, box, sizeof words);
	ob_words_put(u->step_data.bounds[id], words, sizeof words);
	note_change(u, id);
}

uint32_t ob_free_moved(const ob_universe *u, uint32_t group)
{
	return __atomic_load_n(&u->free.group[group].moved, __ATOMIC_SEQ_CST);
}

uint32_t ob_free_changed(const ob_universe *u, uint32_t group, uint32_t number)
{
	const uint64_t change =
		__atomic_load_n(&u->free.group[group].change[number % OB_FREE_CHANGES], __ATOMIC_ACQUIRE);
	return change >> 32 == number + 1 ? (uint32_t)change : OB_NO_OBJECT;
}

void ob_free_get_bounds(const ob_universe *u, uint32_t id, float box[6])
{
	ob_word words[3];
	ob_words_get(words, u->step_data.bounds[id], sizeof words);
	memcpy(box, words, sizeof words);
}

bool ob_free_overlaps(const ob_universe *u, uint32_t id, const float box[6])
{
	const ob_word *words = (const ob_word *)u->step_data.bounds[id];
	const ob_word first = __atomic_load_n(words, __ATOMIC_ACQUIRE);
	float other[6];
	memcpy(other, &first, sizeof first);
	if (other[0] > box[3] || other[1] > box[4])
		return false; // so are most
	const ob_word rest[2] = { __atomic_load_n(words + 1, __ATOMIC_ACQUIRE),
				  __atomic_load_n(words + 2, __ATOMIC_ACQUIRE) };
	memcpy(other + 2, rest, sizeof rest);
	return other[2] <= box[5] && other[3] >= box[0] && other[4] >= box[1] && other[5] >= box[2];
}

// ---- counters

void ob_free_put_counts(ob_universe *u, uint32_t id, const ob_free_counts *counts)
{
	ob_free_counts *to = &cell_of(u, id)->counts;
	for (size_t i = 0; i < sizeof *to / sizeof(ob_word); i++)
		__atomic_store_n((ob_word *)to + i, ((const ob_word *)counts)[i], __ATOMIC_RELAXED);
}

// Updates at the simulator's rate from the begin of a flight until now.
static uint64_t saved_by_flight(const ob_universe *u, uint32_t id)
{
	double began;
	__atomic_load((double *)&cell_of(u, id)->time, &began, __ATOMIC_RELAXED);
	return ob_free_holds(u, id) > 0 ? (uint64_t)rint((ob_free_time(u, id) - began) * ob_free_rate(u, id)) : 0;
}

void ob_free_get_counts(const ob_universe *u, uint32_t id, ob_free_counts *out)
{
	const ob_free_counts *from = &cell_of(u, id)->counts;
	for (size_t i = 0; i < sizeof *from / sizeof(ob_word); i++)
		((ob_word *)out)[i] = __atomic_load_n((const ob_word *)from + i, __ATOMIC_RELAXED);
	out->updates += saved_by_flight(u, id);
}

// ---- waiting

uint32_t ob_free_word(const ob_universe *u, uint32_t worker)
{
	return __atomic_load_n(&u->free.bed[worker].word, __ATOMIC_SEQ_CST);
}

// Gives a worker a reason to look again.
static void rouse(ob_universe *u, uint32_t worker)
{
	ob_free_bed *b = &u->free.bed[worker];
	__atomic_fetch_add(&b->word, 1, __ATOMIC_SEQ_CST);
	const uint32_t at = __atomic_load_n(&b->at, __ATOMIC_SEQ_CST);
	if (at == OB_FREE_OWN_WORD) {
		ob_futex_wake(&b->word, ~0u);
	} else if (at > 0 && at <= u->header.sizes.capacity) {
		__atomic_fetch_add(&cell_of(u, at - 1)->moved, 1, __ATOMIC_SEQ_CST);
		ob_futex_wake(&cell_of(u, at - 1)->moved, ~0u);
	}
}

uint64_t ob_free_wait_for(ob_universe *u, uint32_t worker, uint32_t seen, uint32_t id, uint32_t neighbour, double time)
{
	ob_free_cell *c = cell_of(u, neighbour);
	ob_free_bed *b = &u->free.bed[worker];
	const uint64_t began = ob_clock_ns(), needed = bits_of(time);
	__atomic_store_n(&cell_of(u, id)->blocker, 1 + neighbour, __ATOMIC_RELAXED);
	uint64_t least = __atomic_load_n(&c->awaited, __ATOMIC_SEQ_CST);
	while (needed < least &&
	       !__atomic_compare_exchange_n(&c->awaited, &least, needed, false, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST))
		;
	const uint32_t moved = __atomic_load_n(&c->moved, __ATOMIC_SEQ_CST);
	__atomic_store_n(&b->at, 1 + neighbour, __ATOMIC_SEQ_CST);
	if (ob_free_time(u, neighbour) < time && __atomic_load_n(&c->awaited, __ATOMIC_SEQ_CST) <= needed &&
	    ob_free_word(u, worker) == seen)
		ob_futex_wait_ms(&c->moved, moved, NEIGHBOUR_WAIT_MS);
	__atomic_store_n(&b->at, 0, __ATOMIC_RELAXED);
	return ob_clock_ns() - began;
}

void ob_free_end_wait(ob_universe *u, uint32_t id)
{
	__atomic_store_n(&cell_of(u, id)->blocker, 0, __ATOMIC_RELAXED);
}

bool ob_free_blocker(const ob_universe *u, uint32_t id, uint32_t *blocker)
{
	const uint32_t found = __atomic_load_n(&cell_of(u, id)->blocker, __ATOMIC_RELAXED);
	*blocker = found - 1;
	return found;
}

void ob_free_idle(ob_universe *u, uint32_t worker, uint32_t seen, uint32_t step, double next, uint64_t ns)
{
	static const uint64_t most = HOST_WAIT_MS * UINT64_C(1000000);
	ob_free_bed *b = &u->free.bed[worker];
	const struct timespec t = { .tv_nsec = (long)(ns < most ? ns : most) };
	__atomic_store(&b->next, &(uint64_t){ bits_of(next) }, __ATOMIC_RELAXED);
	__atomic_store_n(&b->at, OB_FREE_OWN_WORD, __ATOMIC_SEQ_CST);
	if (__atomic_load_n(&u->free.control->until, __ATOMIC_SEQ_CST) == step && ob_free_word(u, worker) == seen)
		ob_futex_wait_for(&b->word, seen, &t);
	__atomic_store_n(&b->at, 0, __ATOMIC_RELAXED);
}

// ---- flights

void ob_free_take_off(ob_universe *u, uint32_t id, double holds)
{
	ob_free_cell *c = cell_of(u, id);
	__atomic_store_n(&c->holds, bits_of(holds), __ATOMIC_SEQ_CST);
	wake_waiting(c, bits_of(holds));
}

double ob_free_land(ob_universe *u, uint32_t id, double within, ob_free_counts *counts)
{
	ob_free_cell *c = cell_of(u, id);
	const double until = ob_free_until(u) * u->header.run.step_length, now = ob_free_time(u, id),
		     t = until - now < within ? until : now;
	if (!__atomic_load_n(&c->holds, __ATOMIC_SEQ_CST))
		return now;
	if (counts)
		counts->updates += saved_by_flight(u, id);
	advance(u, id, t); // who lowers the flight from now on is too late
	__atomic_store_n(&c->holds, 0, __ATOMIC_SEQ_CST);
	return t;
}

uint32_t ob_free_worker_of(const ob_universe *u, uint32_t id)
{
	const uint32_t workers = u->header.sizes.workers, capacity = u->header.sizes.capacity;
	const uint32_t most = u->free.control->settings.objects;
	if (u->header.run.one_per_object || workers >= capacity)
		return id;
	return id < most ? (uint32_t)((uint64_t)id * workers / most) : id % workers;
}

void ob_free_lower(ob_universe *u, uint32_t id, double t)
{
	ob_free_cell *c = cell_of(u, id);
	const uint64_t bits = bits_of(ob_max(t, DBL_MIN)); // 0: no flight
	uint64_t holds = __atomic_load_n(&c->holds, __ATOMIC_SEQ_CST);
	while (bits < holds &&
	       !__atomic_compare_exchange_n(&c->holds, &holds, bits, false, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST))
		;
	if (bits >= holds)
		return;
	__atomic_fetch_add(&u->free.control->lowerings, 1, __ATOMIC_SEQ_CST);
	__atomic_fetch_or(&u->free.group[id / OB_FREE_GROUP].lowered, UINT64_C(1) << id % OB_FREE_GROUP,
			  __ATOMIC_SEQ_CST);
	rouse(u, ob_free_worker_of(u, id));
}

uint64_t ob_free_lowerings(const ob_universe *u)
{
	return __atomic_load_n(&u->free.control->lowerings, __ATOMIC_SEQ_CST);
}

uint64_t ob_free_take_lowered(ob_universe *u, uint32_t group, uint64_t mask)
{
	uint64_t *lowered = &u->free.group[group].lowered;
	return __atomic_load_n(lowered, __ATOMIC_SEQ_CST) & mask
		       ? __atomic_fetch_and(lowered, ~mask, __ATOMIC_SEQ_CST) & mask
		       : 0;
}

// ---- host

void ob_free_enter(ob_universe *u, uint32_t id, ob_free_kind kind, uint32_t generation, const ob_motion *m)
{
	ob_free_cell *c = cell_of(u, id);
	if (!ob_free_version(u, id))
		__atomic_store_n(&c->awaited, nobody, __ATOMIC_RELAXED);
	__atomic_store_n(&c->holds, 0, __ATOMIC_SEQ_CST);
	if (kind == OB_FREE_SIMULATED && !u->header.sizes.grouped)
		ob_free_publish(u, id, m);
	__atomic_store_n(&c->generation, generation, __ATOMIC_RELAXED);
	__atomic_store_n(&c->kind, kind, __ATOMIC_RELEASE);
	note_change(u, id);
}

void ob_free_set_rate(ob_universe *u, uint32_t id, double rate)
{
	float f = (float)rate; // not const: clang asks so
	__atomic_store(&cell_of(u, id)->update_rate, &f, __ATOMIC_RELAXED);
}

void ob_free_note_entered(ob_universe *u, uint64_t passports)
{
	const double until = ob_free_until(u) * u->header.run.step_length;
	for (uint32_t id = 0; id < u->header.sizes.capacity; id++)
		ob_free_lower(u, id, until);
	__atomic_store_n(&u->free.control->passports, passports, __ATOMIC_RELAXED);
	__atomic_fetch_add(&u->free.control->entered, 1, __ATOMIC_SEQ_CST);
	ob_free_stop(u);
}

uint64_t ob_free_passports(const ob_universe *u)
{
	return __atomic_load_n(&u->free.control->passports, __ATOMIC_RELAXED);
}

uint32_t ob_free_entered(const ob_universe *u)
{
	return __atomic_load_n(&u->free.control->entered, __ATOMIC_SEQ_CST);
}

void ob_free_stop(ob_universe *u)
{
	for (uint32_t w = 0; w < u->header.sizes.workers; w++)
		rouse(u, w);
}

void ob_free_run_until(ob_universe *u, uint64_t step)
{
	ob_free_control *c = u->free.control;
	if (c->begun_ns == 0 && step > 0)
		ob_free_set_clock(u, 0, c->settings.pace, INFINITY);
	if (__atomic_load_n(&c->until, __ATOMIC_RELAXED) == (uint32_t)step)
		return;
	__atomic_store_n(&c->until, (uint32_t)step, __ATOMIC_SEQ_CST);
	const uint64_t until = bits_of((double)step * u->header.run.step_length);
	for (uint32_t w = 0; w < u->header.sizes.workers; w++) {
		const ob_free_bed *b = &u->free.bed[w];
		if (__atomic_load_n(&b->at, __ATOMIC_SEQ_CST) == OB_FREE_OWN_WORD &&
		    __atomic_load_n(&b->next, __ATOMIC_RELAXED) < until)
			rouse(u, w);
	}
}

void ob_free_looked(ob_universe *u)
{
	__atomic_add_fetch(&u->free.control->looks, 1, __ATOMIC_RELEASE);
}

uint32_t ob_free_looks(const ob_universe *u)
{
	return __atomic_load_n(&u->free.control->looks, __ATOMIC_ACQUIRE);
}

uint32_t ob_free_until(const ob_universe *u)
{
	return __atomic_load_n(&u->free.control->until, __ATOMIC_ACQUIRE);
}

void ob_free_set_clock(ob_universe *u, double t, double pace, double stands)
{
	ob_free_control *c = u->free.control;
	__atomic_store(&c->stands, &stands, __ATOMIC_RELEASE);
	__atomic_store(&c->pace, &pace, __ATOMIC_RELEASE);
	__atomic_store_n(&c->begun_ns, ob_clock_ns() - (uint64_t)(1e9 * t / pace), __ATOMIC_RELEASE);
	ob_free_stop(u);
}

uint64_t ob_free_due_ns(const ob_universe *u, double t)
{
	const ob_free_control *c = u->free.control;
	double pace, stands;
	__atomic_load(&c->stands, &stands, __ATOMIC_ACQUIRE);
	__atomic_load(&c->pace, &pace, __ATOMIC_ACQUIRE);
	return t < stands ? __atomic_load_n(&c->begun_ns, __ATOMIC_ACQUIRE) + (uint64_t)(1e9 * t / pace) : UINT64_MAX;
}
