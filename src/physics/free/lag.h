// The bound of the lag (Lubachevsky 1989): a simulator may begin a step when its time is at most every neighbour's plus
// the bound.
//
//   time  a ────────────●            a may step: b + bound is ahead
//         b ─────────●───────┤       b may step: it is the earliest
//         c ──────────────────●      c waits for b alone, at its futex word
//
// Two that are not near are no neighbours yet, and may be farther apart in time: without a clock up to the lead, the
// host's window (common.c). So fat AABBs hold the objects for a lead before and after their own times, and two are
// neighbours before either can depend on it.
//
// The earliest of all never waits, so nobody waits in a circle. Static, kinematic and removed objects never block. Near
// contact the bound is half of the time in which the gap can close, at least 1 ms, or the length of the next step
// while that is shorter.
#ifndef OB_FREE_LAG_H
#define OB_FREE_LAG_H

#include "free/simulator.h"

// True if the simulator may begin a step. Else it notes its blocker.
bool ob_free_lag_allows(ob_free_sim *s, const ob_free_scratch *x);
// True if the noted blocker blocks no more.
bool ob_free_lag_is_over(const ob_free_sim *s, const ob_universe *u);
// Own time, s, until which the object and a neighbour that goes on as it is seen cannot touch. outer,
// theirs: accelerations of the two, m/s^2.
double ob_free_apart(const ob_free_sim *s, const ob_free_neighbour *n, const ob_state *other, ob_vec3 outer,
		     ob_vec3 theirs);
// Bound (s) for a neighbour that is apart in the coming step, by gap and closing speed.
double ob_free_lag_apart(const ob_free_sim *s, const ob_free_neighbour *n, const ob_state *other);

#endif
