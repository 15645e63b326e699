// What workers find in a phase, and how it comes into the universe.
//
// A worker that can write the universe writes what it has found in place, at once. A contained simulator
// (table/outbox.h) cannot: it hands the same over as a record, and when all have arrived the arranger checks each, and
// writes it:
//
//   - it is what this phase brings, and of an object, island or pair that this simulator was given;
//   - no object's result comes twice, and none is missing;
//   - ids and indices are in their ranges, numbers are finite, what is counted is not more than there can be.
//
// A simulator that hands over anything else is to blame (ob_step_blame): nothing that the phase has brought is
// followed, and all are restarted from the checkpoint. What is within these bounds and yet wrong, because a simulator
// has miscalculated, no check can tell.
#ifndef OB_SIM_COMMIT_H
#define OB_SIM_COMMIT_H

#include "sim/halo.h"
#include "sim/peers.h"
#include "sim/state.h"
#include "table/outbox.h"

// An object's motion after the step; state, due: as ob_schedule.
typedef struct ob_found_result {
	uint32_t id, state, due, reserved;
	ob_motion motion;
} ob_found_result;

// A contact as its island's solver leaves it. kept: it touches or has touched, and state is worth keeping.
typedef struct ob_found_contact {
	uint32_t pair; // index
	uint8_t active, kept, two_sided, reserved; // two_sided: impulse_b holds
	double limit;
	ob_pair_state state;
	double impulse_b[OB_PAIR_ROWS];
} ob_found_contact;

enum { OB_LATE_CONTACTS_BATCH = 256 }; // pairs that a worker checks at a time

// ---- by whoever has found it, in phase ..

void ob_commit_result(ob_sim *s, const ob_found_result *r); // ISLANDS
void ob_commit_bounds(ob_universe *u, uint32_t id, const float box[6]); // ISLANDS; and by the host
void ob_commit_effort(ob_sim *s, uint32_t island, uint32_t share); // ISLANDS: of each of its members
void ob_commit_contact(ob_sim *s, const ob_found_contact *c); // ISLANDS
// The object's script is to be told that it has begun to touch another, with so much more of a normal impulse (N s), at
// this point (m); other OB_NO_OBJECT: that what it was to be told of the step is void.
void ob_commit_touch(ob_universe *u, uint32_t id, uint32_t other, double impulse, ob_vec3 point); // ISLANDS, BASELINE
// By a contained simulator alone: others have run the script in place.
void ob_hand_over_script(ob_sim *s, uint32_t cell, const ob_script_turn *turn, const ob_script_cell *c); // SCRIPTS
void ob_commit_check(ob_universe *u, uint32_t check, const ob_pair_key *k); // FORECAST, LATE_CONTACTS
// So many neighbours, and what that changes of its pairs (ob_step_data.neighbour_id).
void ob_commit_neighbours(ob_universe *u, uint32_t id, uint32_t neighbours, const uint32_t *changes,
			  uint32_t count); // BROADPHASE

// With a worker per object: does the island's leader leave the object's motion in ob_step_data.result, not in its slot?
bool ob_is_left_in_result(const ob_universe *u, uint32_t id);

// ---- by the arranger

typedef struct ob_committer ob_committer;
ob_committer *ob_committer_create(const ob_universe *u); // NULL: no memory
void ob_committer_destroy(ob_committer *c);
// Waits until all simulators that are here have arrived, and collects what they have handed over. false: STOP.
bool ob_commit_collect(ob_committer *c, ob_universe *u, ob_phase phase);
// Checks what is in the mail, which is of all that take part in the phase, and writes it.
void ob_commit_mail(ob_committer *c, ob_universe *u, ob_phase phase);

// ---- by the arranger of one of several ranks; but where it says otherwise false: the step has failed

// The next of the pairs that simulators of other ranks have said of that they touch no more, or that they have checked,
// each said of once. false: that was all.
bool ob_commit_take_parted(ob_committer *c, uint32_t *pair);
bool ob_commit_take_checked(ob_committer *c, uint32_t *pair);
// When bodies have got their homes: pairs that are expected to touch may be of two ranks' bodies, all of which know
// them, from a checkpoint.
void ob_commit_find_links_across(ob_committer *c, ob_universe *u);
// Before islands are linked: those of its bodies that meet other ranks' are in islands.
void ob_commit_involve_links_across(ob_committer *c, ob_universe *u);
// Before their members are listed: each rank has those that it is to solve (rank_islands.h). islands: as there
bool ob_commit_share_islands(ob_committer *c, ob_universe *u, ob_peers *p, bool *islands);
// Puts what the other ranks' simulators have handed over to what was collected. digest: ob_peers_digest.
bool ob_commit_exchange(ob_committer *c, ob_universe *u, ob_peers *p, ob_phase phase, uint64_t digest);
// Which motions this rank has; NULL: there is but one.
ob_halo *ob_commit_halo(const ob_committer *c);
// Whose region bodies are in; likewise.
struct ob_regions *ob_commit_regions(const ob_committer *c);
// Between two steps: all ranks have what all pairs keep, and what is known of them, for a checkpoint.
bool ob_commit_share(ob_committer *c, ob_universe *u, ob_peers *p);

#endif
