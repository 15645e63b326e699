// Coupling by a ledger: the lower id of a pair computes the impulse, once, and mails it.
//
//   a (lower id)                               b (higher id)
//   solves the contact with b's mass           is moved by mail alone, as by a force
//   account "b": deposited so far  ─────────>  reads what is new since its own account
//   reads what is under way        <─────────  account "a": consumed so far
//
// Each publishes its accounts and its motion as one version (table/free.h), so a kill loses or doubles no impulse, and
// momentum with the mail under way is kept to rounding: sum of m v, plus deposited less consumed.
//
// Rate: a load that lasts goes on beyond the time of its deposit, at the rate that two steps had in common, or at the
// rate that holds b against all else that acts on it. So b is supported between a's publications from the first step
// on, and an impulse of a hit is not repeated. b takes back what was too much with the next deposit. Where publications
// are delayed, two steps are too few: a load of one millisecond would go on for ten, and swing up from body to body. So
// beyond what holds b, a load goes on only as far as its mean over twice the delay reached. It then brings no more than it
// has brought before, however short the steps are.
//
// Energy of the lag: an impulse P was computed for a partner at the velocity v. If that is v + u when P arrives, the pair
// gains P u. Each simulator sums its side of this (ob_free_counts): work of the mail that it consumed, and work of the mail
// that it sent, on its partners as it saw them.
//
// Under way: a sees b with all of its own deposits, consumed or not. So a hit is not computed twice, however late b is.
//
// Epochs: an account is closed when the two part, and dropped by a when b has consumed all of it, then by b. A new contact
// has a new epoch, in which sums begin at 0.
//
// Shares: a body's mass is shared among all that solve its contacts. Several that correct the same body at once, each as if
// alone, would correct it too far: it swings from step to step, and creeps wherever friction lets it.
//
// Shift: the positions of overlapping bodies are corrected. b's part is mailed as a displacement; it bears no momentum.
#ifndef OB_FREE_LEDGER_H
#define OB_FREE_LEDGER_H

#include "free/simulator.h"

// Rate, rad/s, that belongs to an angular momentum about the centre, N m s.
ob_vec3 ob_ledger_rate(const ob_passport *p, ob_quat q, ob_vec3 spin);
// Begins a step: sums of mail are 0.
void ob_ledger_begin(ob_free_sim *s);
// Consumes the mail of a neighbour with a lower id, if there is any, and copies its motion. false: it cannot be read.
bool ob_ledger_receive(ob_free_sim *s, const ob_free_scratch *x, const ob_free_neighbour *n, double h, ob_motion *m);
// Reads a neighbour with a higher id, with all deposits. false: it cannot be read.
bool ob_ledger_look(ob_free_sim *s, const ob_free_scratch *x, const ob_free_neighbour *n, ob_free_seen *seen);
// Moves the object by its mail's displacements.
void ob_ledger_shift(const ob_free_sim *s, ob_state *own);
// Deposits what a step of length h (s) has done to a higher neighbour. end: its motion in the island; NULL: it was not
// there. false: there is no room for an account.
bool ob_ledger_deposit(ob_free_sim *s, const ob_free_scratch *x, ob_free_neighbour *n, const ob_free_seen *seen,
		       const ob_motion *end, double h);
// Ends a step: the acceleration and the torque that go on beyond it. own: state at the step's begin.
void ob_ledger_end(ob_free_sim *s, const ob_free_scratch *x, const ob_state *own, double h, ob_motion *end);

#endif
