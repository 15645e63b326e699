#include "table/home.h"

#include "table/layout.h"

// A move in one word: 1 + worker, object.
bool ob_move_ask(ob_universe *u, uint32_t object, uint32_t worker)
{
	uint64_t none = 0;
	return __atomic_compare_exchange_n(&u->control->move, &none, (uint64_t)(1 + worker) << 32 | object, false,
					   __ATOMIC_RELAXED, __ATOMIC_RELAXED);
}

uint64_t ob_move_take(ob_universe *u)
{
	return __atomic_load_n(&u->control->move, __ATOMIC_RELAXED)
		       ? __atomic_exchange_n(&u->control->move, 0, __ATOMIC_RELAXED)
		       : 0;
}

void ob_move_make(ob_universe *u, uint64_t move)
{
	const uint32_t object = (uint32_t)move, pin = (uint32_t)(move >> 32);
	ob_passport p;
	if (pin == 0 || !ob_universe_get_passport(u, object, &p)) // the object may have been removed since
		return;
	u->control->pins += u->step_data.pin[object] == 0;
	u->step_data.pin[object] = pin;
	// on several ranks, the home also determines which rank has the object (cluster/halo.h): it changes when that rank
	// solves it
	if (u->ranks == 1)
		ob_home_set(u, object, pin - 1);
}

bool ob_moves_were_made(const ob_universe *u)
{
	return u->control->pins > 0;
}

void ob_pin_drop(ob_universe *u, uint32_t object)
{
	u->control->pins -= u->step_data.pin[object] != 0;
	u->step_data.pin[object] = 0;
}

uint32_t ob_home_of(const ob_universe *u, uint32_t object)
{
	const uint32_t all = ob_universe_simulators(u), home = u->step_data.home[object] - 1;
	return home < all ? home : (uint32_t)((uint64_t)object * all / ob_universe_ids(u));
}

uint32_t ob_home_rank(const ob_universe *u, uint32_t object)
{
	return ob_universe_rank_of(u, ob_home_of(u, object));
}

// Atomic, as readers read it at any time.
void ob_home_set(ob_universe *u, uint32_t object, uint32_t worker)
{
	__atomic_store_n(&u->step_data.home[object], 1 + worker, __ATOMIC_RELAXED);
}
