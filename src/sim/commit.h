// Results that workers find in a phase, and their commit to the universe.
//
// A worker that can write the universe writes its results in place, at once. A contained simulator (table/outbox.h)
// cannot: it hands them over as records. When all have arrived, the arranger checks each record, and writes it:
//
//   - it belongs to this phase, and to an object, island or pair that this simulator was given;
//   - no object's result comes twice, and none is missing;
//   - ids and indices are in their ranges, numbers are finite, what is counted is not more than there can be.
//
// A simulator that hands over anything else is to blame (ob_step_blame): nothing of the phase is used, and all
// simulators are restarted from the checkpoint. These checks cannot detect a miscalculated result that is within the
// bounds.
#ifndef OB_SIM_COMMIT_H
#define OB_SIM_COMMIT_H

#include "sim/halo.h"
#include "sim/peers.h"
#include "sim/state.h"
#include "table/outbox.h"

// Motion of an object after the step; state, due: as in ob_schedule.
typedef struct ob_found_result {
	uint32_t id, state, due, reserved;
	ob_motion motion;
} ob_found_result;

// Contact as the solver of its island leaves it. kept: it touches or has touched, so its state is worth keeping.
typedef struct ob_found_contact {
	uint32_t pair; // index
	uint8_t active, kept, two_sided, reserved; // two_sided: impulse_b is valid
	double limit;
	ob_pair_state state;
	double impulse_b[OB_PAIR_ROWS];
} ob_found_contact;

enum { OB_LATE_CONTACTS_BATCH = 256 }; // pairs that a worker checks at a time

// ---- by the worker that found the result, in phase ..

void ob_commit_result(ob_sim *s, const ob_found_result *r); // ISLANDS
void ob_commit_bounds(ob_universe *u, uint32_t id, const float box[6]); // ISLANDS; and by the host
void ob_commit_effort(ob_sim *s, uint32_t island, uint32_t share); // ISLANDS; share: each member's
void ob_commit_contact(ob_sim *s, const ob_found_contact *c); // ISLANDS
// Notes for the object's script that it has begun to touch another, and adds a normal impulse (N s) at this point (m).
// other OB_NO_OBJECT: drops the notes of this step.
void ob_commit_touch(ob_universe *u, uint32_t id, uint32_t other, double impulse, ob_vec3 point); // ISLANDS, BASELINE
// Hands over a script's result. Only for contained simulators: other workers have run the script in place.
void ob_hand_over_script(ob_sim *s, uint32_t cell, const ob_script_turn *turn, const ob_script_cell *c); // SCRIPTS
void ob_commit_check(ob_universe *u, uint32_t check, const ob_pair_key *k); // FORECAST, LATE_CONTACTS
// Commits the number of an object's neighbours, and the changes to its pairs (ob_step_data.neighbour_id).
void ob_commit_neighbours(ob_universe *u, uint32_t id, uint32_t neighbours, const uint32_t *changes,
			  uint32_t count); // BROADPHASE

// True if the island's leader leaves the object's motion in ob_step_data.result, not in its slot: with a worker per
// object.
bool ob_is_left_in_result(const ob_universe *u, uint32_t id);

// ---- by the arranger

typedef struct ob_committer ob_committer;
ob_committer *ob_committer_create(const ob_universe *u); // NULL: no memory
void ob_committer_destroy(ob_committer *c);
// Waits until all local simulators have arrived, and collects their records. Returns false on STOP.
bool ob_commit_collect(ob_committer *c, ob_universe *u, ob_phase phase);
// Checks the collected records of all ranks that take part in the phase, and writes them.
void ob_commit_mail(ob_committer *c, ob_universe *u, ob_phase phase);

// ---- by the arranger of one of several ranks. false: the step has failed, unless stated otherwise

// Take the next pair that simulators of other ranks reported separated, or have checked; each report once. false: none
// left.
bool ob_commit_take_parted(ob_committer *c, uint32_t *pair);
bool ob_commit_take_checked(ob_committer *c, uint32_t *pair);
// Finds pairs that are expected to touch and link two ranks' bodies, after bodies got their homes. All ranks know these
// pairs from a checkpoint.
void ob_commit_find_links_across(ob_committer *c, ob_universe *u);
// Puts this rank's bodies that are linked to other ranks' into islands, before islands are linked.
void ob_commit_involve_links_across(ob_committer *c, ob_universe *u);
// Shares the islands among ranks before their members are listed; then each rank has those that it must solve. islands:
// as in rank_islands.h.
bool ob_commit_share_islands(ob_committer *c, ob_universe *u, ob_peers *p, bool *islands);
// Adds the records of the other ranks' simulators to those collected here. digest: ob_peers_digest.
bool ob_commit_exchange(ob_committer *c, ob_universe *u, ob_peers *p, ob_phase phase, uint64_t digest);
// Returns the halo: the motions that this rank has. NULL with a single rank.
ob_halo *ob_commit_halo(const ob_committer *c);
// Returns the regions of the ranks, in which bodies lie. NULL with a single rank.
struct ob_regions *ob_commit_regions(const ob_committer *c);
// Gathers the kept states and the checks of all pairs on all ranks, between two steps, for a checkpoint.
bool ob_commit_share(ob_committer *c, ob_universe *u, ob_peers *p);

#endif
