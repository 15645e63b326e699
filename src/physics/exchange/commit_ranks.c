// Exchange of simulators' results among the arrangers of several ranks.
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "cluster/digest.h"
#include "exchange/committer.h"
#include "schedule/pair_checks.h"
#include "table/home.h"

bool ob_committer_share(ob_committer *c)
{
	c->dealt = calloc(c->ranks, sizeof *c->dealt);
	c->to = calloc(c->ranks, sizeof *c->to);
	c->sent = calloc(c->ranks, sizeof *c->sent);
	c->received = calloc(c->ranks, sizeof *c->received);
	return c->dealt && c->to && c->sent && c->received;
}

void ob_committer_finish_shared(ob_committer *c)
{
	ob_mail_finish(&c->out);
	for (uint32_t r = 0; c->dealt && r < c->ranks; r++)
		ob_mail_finish(&c->dealt[r]);
	free(c->dealt);
	free(c->to);
	free(c->sent);
	free(c->received);
}

// True if the others already know all that they would be sent of a contact: its existence, and the rank that keeps its
// state.
static bool is_known(const ob_committer *c, const ob_universe *u, const ob_found_contact *found)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_pair_key *k = found->pair < ob_pairs_end(data) ? &data->pair[found->pair] : NULL;
	return k && k->active && found->active && k->record != OB_NO_RECORD &&
	       ob_holdings_here_alone(c->cluster->parts.holdings, u, k->record);
}

// Returns the bytes of a contact's record to send to the others. Only its existence is sent, unless its state is wanted
// everywhere. 0: nothing new.
static uint32_t contact_bytes_for_others(const ob_committer *c, const ob_universe *u, const ob_mail_record *r)
{
	if (ob_universe_shares_contacts(u) || r->bytes < offsetof(ob_found_contact, state))
		return r->bytes;
	return is_known(c, u, r->data) ? 0 : (uint32_t)offsetof(ob_found_contact, state);
}

// Appends a result to the mails of other ranks. all: of every rank; else of those that have neighbours of the body.
static void put_result(ob_committer *c, const ob_universe *u, const ob_mail_record *r, bool all)
{
	ob_found_result whole;
	ob_mail_record restored = { .worker = r->worker, .kind = OB_RECORD_RESTORED, .bytes = sizeof whole };
	const ob_found_result *found = r->data; // valid up to its motion, in both layouts
	if (!ob_committer_is_result(u, r) || !ob_is_sound_state(found->state)) // the commit will report it
		return;
	const bool restores = ob_halo_address(c->cluster->parts.halo, u, found->id, all, c->to);
	if (restores)
		restored.data = ob_committer_result_of(u, r, &whole);
	bool kept; // not used: the commit here tests the motion itself
	for (uint32_t to = 0; to < c->ranks; to++) {
		if (to == c->rank || !c->to[to])
			continue;
		if (!restores)
			c->sent[to] = ob_committer_digest_before(c, u, found->id, c->sent[to], &kept);
		ob_mail_append_record(&c->dealt[to], restores ? &restored : r);
	}
}

// Finds the ranks that need the result of a check of two ranks' bodies: all, if the pair links them or did; else the
// home ranks of both. No rank needs that of other checks.
static void find_concerned(ob_committer *c, const ob_universe *u, const ob_mail_record *r)
{
	const ob_check_record *found = r->data;
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_pair_key *k =
		r->bytes == sizeof *found && found->pair < ob_pairs_end(data) ? &data->pair[found->pair] : NULL;
	const bool across = k && ob_pair_is_across(u, k),
		   all = across && (k->expected || k->late || found->expected || found->late);
	memset(c->to, all, c->ranks * sizeof *c->to);
	for (int side = 0; across && side < 2; side++)
		c->to[ob_home_rank(u, side ? k->b : k->a)] = true;
}

static void put_for_each(ob_committer *c, const ob_universe *u, const ob_mail_record *r, bool all)
{
	ob_mail_record copy = *r;
	if (r->kind == OB_RECORD_RESULT) {
		put_result(c, u, r, all);
		return;
	}
	if (r->kind == OB_RECORD_EFFORT) // it concerns an island, which no other rank has
		return;
	if (r->kind == OB_RECORD_CHECK)
		find_concerned(c, u, r);
	if (r->kind == OB_RECORD_CONTACT && !(copy.bytes = contact_bytes_for_others(c, u, r)))
		return;
	for (uint32_t to = 0; to < c->ranks; to++)
		if (to != c->rank && (r->kind != OB_RECORD_CHECK || c->to[to]))
			ob_mail_append_record(&c->dealt[to], &copy);
}

// Sends each rank the records that it needs: results and checks concern ranks nearby.
static const char *deal_records(ob_committer *c, ob_universe *u, ob_peers_head head)
{
	const bool all = c->cluster->peers.look <= ob_step_count(u) + 1; // a reader needs all motions after this step
	const uint64_t nothing = 0;
	ob_record_reader own = { .mail = ob_committer_mail_of(c, c->rank) };
	ob_mail_record r;
	for (uint32_t to = 0; to < c->ranks; to++) {
		ob_peers_begin(&c->dealt[to]);
		ob_mail_append(&c->dealt[to], &nothing, sizeof nothing);
	}
	memset(c->sent, 0, c->ranks * sizeof *c->sent);
	memset(c->received, 0, c->ranks * sizeof *c->received);
	while (ob_committer_next(c, u, &own, &r))
		put_for_each(c, u, &r, all);
	for (uint32_t to = 0; to < c->ranks; to++)
		if (!c->dealt[to].lost)
			memcpy(c->dealt[to].bytes + sizeof head, &c->sent[to], sizeof *c->sent);
	if (!all && head.phase == OB_PHASE_ISLANDS)
		ob_halo_part(c->cluster->parts.halo);
	c->ahead = sizeof head + sizeof *c->sent;
	return ob_peers_exchange(&c->cluster->peers, u, head, c->dealt, true, &c->at);
}

static const char *say_to_all(ob_committer *c, ob_universe *u, ob_peers_head head)
{
	ob_mail own = ob_committer_mail_of(c, c->rank);
	ob_mail_record r;
	ob_peers_begin(&c->out);
	while (ob_mail_next(u, &own, &r))
		ob_mail_append_record(&c->out, &r);
	c->ahead = sizeof head;
	return ob_peers_exchange(&c->cluster->peers, u, head, &c->out, false, &c->at);
}

bool ob_committer_exchange(ob_committer *c, ob_universe *u, ob_phase phase, uint64_t digest)
{
	const bool islands = phase == OB_PHASE_ISLANDS;
	const uint32_t damaged = islands ? ob_holdings_damaged(c->cluster->parts.holdings, u) : OB_NO_OBJECT;
	const ob_peers_head head = { .phase = phase,
				     .digest = digest,
				     .damaged = damaged != OB_NO_OBJECT ? 1 + damaged : c->damaged,
				     .differs = c->differs,
				     .woken = c->woken };
	c->woken = 0;
	c->dealt_to_each = islands || phase == OB_PHASE_FORECAST || phase == OB_PHASE_LATE_CONTACTS;
	c->all = c->dealt_to_each ? deal_records(c, u, head) : say_to_all(c, u, head);
	return c->all;
}
