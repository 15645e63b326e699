// What arrangers of several ranks tell each other of what their simulators have handed over.
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "sim/committer.h"
#include "sim/digest.h"
#include "sim/pairs.h"
#include "sim/regions.h"
#include "table/home.h"

bool ob_committer_share(ob_committer *c, const ob_universe *u)
{
	c->holdings = ob_holdings_create(u);
	c->halo = ob_halo_create(u);
	c->regions = ob_regions_create(u);
	c->dealt = calloc(c->ranks, sizeof *c->dealt);
	c->solved_for = calloc(c->ranks, sizeof *c->solved_for);
	c->to = calloc(c->ranks, sizeof *c->to);
	c->told = calloc(c->ranks, sizeof *c->told);
	c->heard = calloc(c->ranks, sizeof *c->heard);
	return c->holdings && c->halo && c->regions && c->dealt && c->solved_for && c->to && c->told && c->heard;
}

void ob_committer_finish_shared(ob_committer *c)
{
	ob_mail_finish(&c->out);
	ob_mail_finish(&c->parted);
	ob_mail_finish(&c->checked);
	ob_holdings_destroy(c->holdings);
	ob_halo_destroy(c->halo);
	ob_regions_destroy(c->regions);
	for (uint32_t r = 0; c->dealt && r < c->ranks; r++)
		ob_mail_finish(&c->dealt[r]);
	free(c->dealt);
	free(c->solved_for);
	free(c->to);
	free(c->told);
	free(c->heard);
}

uint64_t ob_committer_digest_before(const ob_committer *c, const ob_universe *u, uint32_t id, uint64_t sum, bool *whole)
{
	uint64_t digest;
	*whole = ob_halo_digest(c->halo, u, id, &digest);
	return ob_digest_word(sum + id, digest);
}

void ob_committer_compare_before(ob_committer *c)
{
	uint64_t told;
	for (uint32_t rank = 0; rank < c->ranks; rank++) {
		memcpy(&told, c->all + c->at[rank] + sizeof(ob_peers_head), sizeof told);
		c->differs |= rank != c->rank && told != c->heard[rank];
	}
}

// Whether the others know of a contact what they will be told: that it touches, and which rank keeps the rest of it.
static bool is_known(const ob_committer *c, const ob_universe *u, const ob_found_contact *found)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_pair_key *k = found->pair < ob_pairs_end(data) ? &data->pair[found->pair] : NULL;
	return k && k->active && found->active && k->record != OB_NO_RECORD &&
	       ob_holdings_here_alone(c->holdings, u, k->record);
}

// What the others get of a contact: no more than that it is there, unless what is kept of them is wanted everywhere.
static uint32_t contact_bytes_for_others(const ob_committer *c, const ob_universe *u, const ob_mail_record *r)
{
	if (ob_universe_shares_contacts(u) || r->bytes < offsetof(ob_found_contact, state))
		return r->bytes;
	return is_known(c, u, r->data) ? 0 : (uint32_t)offsetof(ob_found_contact, state);
}

static bool flush_solved(ob_committer *c, uint32_t worker, uint32_t to)
{
	ob_solved_bodies *s = &c->solved_for[to];
	const ob_mail_record r = { worker, OB_RECORD_SOLVED, s->n * (uint32_t)sizeof *s->record.body, &s->record };
	const bool fits = !s->n || ob_mail_append_record(&c->dealt[to], &r);
	s->n = 0;
	return fits;
}

static bool put_solved(ob_committer *c, uint32_t worker, uint32_t to, const ob_found_result *r)
{
	ob_solved_bodies *s = &c->solved_for[to];
	s->record.body[s->n].id = r->id | (r->state - OB_SCHEDULE_AWAKE) << OB_SOLVED_ID_BITS;
	s->record.body[s->n].due = r->due;
	return ++s->n < OB_SOLVED_AT_ONCE || flush_solved(c, worker, to);
}

// all: everybody is told the motion; else those who have neighbours of the body.
static bool put_result(ob_committer *c, const ob_universe *u, const ob_mail_record *r, bool all)
{
	ob_found_result whole;
	ob_mail_record restored = { .worker = r->worker, .kind = OB_RECORD_RESTORED, .bytes = sizeof whole };
	const ob_found_result *found = r->data; // as far as its motion, whether that is whole or not
	if (!ob_committer_is_result(u, r) || !ob_is_sound_state(found->state)) // who commits it finds out
		return true;
	const bool restores = ob_halo_tell(c->halo, u, found->id, all, c->to);
	if (restores)
		restored.data = ob_committer_result_of(u, r, &whole);
	bool fits = true, kept; // whether it is what it was this rank finds out when it commits it
	for (uint32_t to = 0; to < c->ranks; to++) {
		if (to == c->rank)
			continue;
		if (!c->to[to]) {
			fits &= put_solved(c, r->worker, to, found);
			continue;
		}
		if (!restores)
			c->told[to] = ob_committer_digest_before(c, u, found->id, c->told[to], &kept);
		fits &= ob_mail_append_record(&c->dealt[to], restores ? &restored : r);
	}
	return fits;
}

// Who must know what has come of a check: all, if it says whom the pair links; else who has one of its objects.
static void find_concerned(ob_committer *c, const ob_universe *u, const ob_mail_record *r)
{
	const ob_check_record *found = r->data;
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_pair_key *k =
		r->bytes == sizeof *found && found->pair < ob_pairs_end(data) ? &data->pair[found->pair] : NULL;
	const bool all = !k || k->active || k->expected || k->late || found->expected || found->late;
	memset(c->to, all, c->ranks * sizeof *c->to);
	for (int side = 0; !all && side < 2; side++) {
		const uint32_t id = side ? k->b : k->a;
		if (ob_schedule_is_dynamic(&data->schedule[id]))
			c->to[ob_home_rank(u, id)] = true;
	}
}

static bool put_for_each(ob_committer *c, const ob_universe *u, const ob_mail_record *r, bool all)
{
	ob_mail_record told = *r;
	bool fits = true;
	if (r->kind == OB_RECORD_RESULT)
		return put_result(c, u, r, all);
	if (r->kind == OB_RECORD_CHECK)
		find_concerned(c, u, r);
	if (r->kind == OB_RECORD_CONTACT && !(told.bytes = contact_bytes_for_others(c, u, r)))
		return true;
	for (uint32_t to = 0; to < c->ranks; to++) {
		if (to == c->rank || (r->kind == OB_RECORD_CHECK && !c->to[to]))
			continue;
		if (r->kind == OB_RECORD_END)
			fits &= flush_solved(c, r->worker, to);
		fits &= ob_mail_append_record(&c->dealt[to], &told);
	}
	return fits;
}

// To each what it needs: what is solved and checked concerns who is near.
static const char *deal_records(ob_committer *c, ob_universe *u, ob_peers *p, ob_peers_head head)
{
	const bool all = p->look <= ob_step_count(u) + 1; // somebody looks at motions when the step is complete
	const uint64_t nothing = 0;
	ob_record_reader own = { .mail = ob_committer_mail_of(c, c->rank) };
	ob_mail_record r;
	bool fits = true;
	for (uint32_t to = 0; to < c->ranks; to++)
		fits &= ob_peers_begin(&c->dealt[to]) && ob_mail_append(&c->dealt[to], &nothing, sizeof nothing);
	memset(c->told, 0, c->ranks * sizeof *c->told);
	memset(c->heard, 0, c->ranks * sizeof *c->heard);
	while (fits && ob_committer_next(c, u, &own, &r))
		fits = put_for_each(c, u, &r, all);
	if (!fits) {
		ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
		return NULL;
	}
	for (uint32_t to = 0; to < c->ranks; to++)
		memcpy(c->dealt[to].bytes + sizeof head, &c->told[to], sizeof *c->told);
	if (!all && head.phase == OB_PHASE_ISLANDS)
		ob_halo_part(c->halo);
	c->ahead = sizeof head + sizeof *c->told;
	return ob_peers_deal(p, u, head, c->dealt, &c->at);
}

static const char *say_to_all(ob_committer *c, ob_universe *u, ob_peers *p, ob_peers_head head)
{
	ob_mail own = ob_committer_mail_of(c, c->rank);
	ob_mail_record r;
	bool fits = ob_peers_begin(&c->out);
	while (fits && ob_mail_next(u, &own, &r))
		fits = ob_mail_append_record(&c->out, &r);
	if (!fits) {
		ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
		return NULL;
	}
	c->ahead = sizeof head;
	return ob_peers_exchange(p, u, head, &c->out, &c->at);
}

bool ob_commit_exchange(ob_committer *c, ob_universe *u, ob_peers *p, ob_phase phase, uint64_t digest)
{
	const bool islands = phase == OB_PHASE_ISLANDS;
	const uint32_t damaged = islands ? ob_holdings_damaged(c->holdings, u) : OB_NO_OBJECT;
	const ob_peers_head head = { .phase = phase,
				     .digest = digest,
				     .damaged = damaged != OB_NO_OBJECT ? 1 + damaged : c->damaged,
				     .differs = c->differs };
	c->dealt_to_each = islands || phase == OB_PHASE_FORECAST || phase == OB_PHASE_LATE_CONTACTS;
	c->all = c->dealt_to_each ? deal_records(c, u, p, head) : say_to_all(c, u, p, head);
	return c->all;
}

static bool take_last(ob_mail *list, uint32_t *pair)
{
	if (!list->used)
		return false;
	list->used -= sizeof *pair;
	memcpy(pair, list->bytes + list->used, sizeof *pair);
	return true;
}

bool ob_commit_take_parted(ob_committer *c, uint32_t *pair)
{
	return take_last(&c->parted, pair);
}

bool ob_commit_take_checked(ob_committer *c, uint32_t *pair)
{
	return take_last(&c->checked, pair);
}

// false: they make no sense.
static bool take_parcels(ob_committer *c, ob_universe *u, const char *from, size_t bytes)
{
	const char *parcel;
	ob_parcel head;
	bool sound = true;
	while (sound && (parcel = ob_parcel_next(&from, &bytes, &head, &sound)))
		sound = head.kind == OB_PARCEL_KEPT ? ob_holdings_take(c->holdings, u, parcel, head.bytes)
						    : ob_halo_take(c->halo, u, parcel, &head);
	return sound;
}

bool ob_commit_give(ob_committer *c, ob_universe *u, ob_peers *p)
{
	const size_t *at;
	uint32_t fliers;
	const uint32_t *flier = ob_regions_settle_fliers(c->regions, u, &fliers);
	bool moved = false, fits = true;
	for (uint32_t to = 0; to < c->ranks; to++)
		fits &= ob_peers_begin(&c->dealt[to]);
	fits = fits && ob_holdings_move(c->holdings, u, c->dealt) &&
	       ob_halo_move(c->halo, u, flier, fliers, c->dealt, &moved);
	for (uint32_t i = 0; i < fliers; i++)
		ob_pairs_look(u, flier[i]); // who checks them has changed
	if (!fits)
		ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
	if (!fits || !moved)
		return fits;
	const char *all = ob_peers_deal(p, u, (ob_peers_head){ .phase = OB_PEERS_MOVE }, c->dealt, &at);
	for (uint32_t r = 0; all && r < c->ranks; r++)
		if (r != c->rank && !take_parcels(c, u, all + at[r] + sizeof(ob_peers_head),
						  at[r + 1] - at[r] - sizeof(ob_peers_head))) {
			ob_peers_blame(p, u, r);
			return false;
		}
	return all;
}

ob_halo *ob_commit_halo(const ob_committer *c)
{
	return c->halo;
}

ob_regions *ob_commit_regions(const ob_committer *c)
{
	return c->regions;
}

bool ob_commit_share(ob_committer *c, ob_universe *u, ob_peers *p)
{
	return ob_holdings_gather(c->holdings, u, p) && ob_halo_share_pairs(c->halo, u, p);
}
