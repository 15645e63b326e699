// A worker's turn: it waits at the gate and arrives there, by itself or, as a contained simulator, through its outbox.
#include "table/layout.h"
#include "table/outbox.h"

ob_phase ob_turn_wait(ob_universe *u, uint32_t worker)
{
	if (!ob_universe_contained(u))
		return ob_gate_wait(u, worker, __atomic_load_n(&u->gate_cell[worker].done, __ATOMIC_RELAXED), true);
	const ob_phase phase = ob_gate_wait(u, worker, ob_outbox_turns_done(u), false);
	if (phase != OB_PHASE_STOP)
		ob_outbox_begin(u);
	return phase;
}

bool ob_turn_arrive(ob_universe *u, uint32_t worker)
{
	if (!ob_universe_contained(u))
		return ob_gate_arrive(u, worker);
	ob_outbox_arrive(u);
	return false;
}
