// Properties of a universe, and how the host marks its state.
#include "table/layout.h"
#include "table/segment.h"

const ob_run_settings *ob_universe_settings(const ob_universe *u)
{
	return &u->header.run;
}
uint32_t ob_universe_capacity(const ob_universe *u)
{
	return u->header.sizes.capacity;
}

uint32_t ob_universe_hulls(const ob_universe *u)
{
	return u->header.sizes.hulls;
}
uint32_t ob_universe_workers(const ob_universe *u)
{
	return u->header.sizes.workers;
}
uint32_t ob_universe_simulators(const ob_universe *u)
{
	return u->header.sizes.workers - (ob_universe_contains(u) ? 1 : 0);
}
uint32_t ob_universe_version(void)
{
	return OB_LAYOUT_VERSION;
}
uint32_t ob_universe_rank(const ob_universe *u)
{
	return u->rank;
}
uint32_t ob_universe_ranks(const ob_universe *u)
{
	return u->ranks;
}
bool ob_worker_is_here(const ob_universe *u, uint32_t worker)
{
	const uint32_t simulators = ob_universe_simulators(u);
	return worker >= simulators || ob_universe_rank_of(u, worker) == u->rank;
}
uint32_t ob_universe_rank_of(const ob_universe *u, uint32_t simulator)
{
	return simulator / (ob_universe_simulators(u) / u->ranks);
}
uint32_t ob_universe_simulators_here(const ob_universe *u, uint32_t *first)
{
	const uint32_t each = ob_universe_simulators(u) / u->ranks;
	*first = u->rank * each;
	return each;
}
void ob_universe_look_for_readers(ob_universe *u)
{
	__atomic_store_n(&u->control->is_read, ob_segment_is_read(u->fd), __ATOMIC_RELAXED);
}
bool ob_universe_is_read(const ob_universe *u)
{
	return __atomic_load_n(&u->control->is_read, __ATOMIC_RELAXED);
}
bool ob_universe_shares_contacts(const ob_universe *u)
{
	return u->shares_contacts;
}
void ob_contacts_want(ob_universe *u, uint64_t step)
{
	__atomic_store_n(&u->control->contacts_step, step, __ATOMIC_RELAXED);
}
uint64_t ob_contacts_wanted(const ob_universe *u)
{
	return __atomic_load_n(&u->control->contacts_step, __ATOMIC_RELAXED);
}
bool ob_universe_checked(const ob_universe *u)
{
	return u->header.checked;
}

bool ob_universe_unshared(const ob_universe *u)
{
	return u->unshared;
}

uint32_t ob_universe_harden(const ob_universe *u)
{
	return u->header.harden;
}
bool ob_universe_contains(const ob_universe *u)
{
	return u->header.sizes.outbox_bytes > 0;
}
const char *ob_universe_name(const ob_universe *u)
{
	return u->header.name;
}
ob_step_data *ob_universe_step_data(const ob_universe *u)
{
	return (ob_step_data *)&u->step_data;
}

void ob_universe_set_state(ob_universe *u, ob_universe_state s)
{
	__atomic_store_n(&u->control->state, s, __ATOMIC_RELEASE);
}

// Byte by byte, as a reader may read at the same time: it may get a mix of both texts, and no more than that.
void ob_universe_note_death(ob_universe *u, const char *what)
{
	ob_control *c = u->control;
	for (size_t i = 0; i < sizeof c->last_death; i++) {
		const char letter = i + 1 < sizeof c->last_death ? *what : 0;
		__atomic_store_n(&c->last_death[i], letter, __ATOMIC_RELAXED);
		what += *what != 0;
	}
	__atomic_fetch_add(&c->deaths, 1, __ATOMIC_RELEASE);
}

void ob_universe_note_frozen(ob_universe *u, uint32_t objects)
{
	__atomic_fetch_add(&u->control->frozen, objects, __ATOMIC_RELEASE);
}

uint32_t ob_universe_ids(const ob_universe *u)
{
	const uint32_t ids = __atomic_load_n(&u->control->ids, __ATOMIC_ACQUIRE), most = u->header.sizes.capacity;
	return ids < most ? ids : most;
}

uint64_t ob_step_count(const ob_universe *u)
{
	return __atomic_load_n(&u->control->step, __ATOMIC_ACQUIRE);
}
