#include "cluster/cluster.h"

#include <stdlib.h>
#include <string.h>

#include "schedule/calendar.h"
#include "schedule/involved.h"
#include "schedule/pair_checks.h"
#include "table/home.h"

bool ob_cluster_create(const ob_universe *u, ob_cluster **out)
{
	*out = NULL;
	if (ob_universe_ranks(u) < 2)
		return true;
	ob_cluster *c = *out = calloc(1, sizeof *c);
	if (!c)
		return false;
	c->parts = (ob_rank_parts){ ob_halo_create(u), ob_holdings_create(u), ob_regions_create(u) };
	c->islands = ob_rank_islands_create(u, &c->parts);
	return c->parts.halo && c->parts.holdings && c->parts.regions && c->islands;
}

void ob_cluster_destroy(ob_cluster *c)
{
	if (!c)
		return;
	ob_mail_finish(&c->parted);
	ob_mail_finish(&c->checked);
	ob_mail_finish(&c->links_across);
	ob_mail_finish(&c->linked);
	ob_mail_finish(&c->links);
	ob_holdings_destroy(c->parts.holdings);
	ob_halo_destroy(c->parts.halo);
	ob_regions_destroy(c->parts.regions);
	ob_rank_islands_destroy(c->islands);
	free(c);
}

// ---- pairs of two ranks' bodies

void ob_cluster_note(ob_universe *u, ob_mail *list, uint32_t pair)
{
	ob_mail_append(list, &pair, sizeof pair);
	if (list->lost)
		ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
}

static bool take_last(ob_mail *list, uint32_t *pair)
{
	if (!list->used)
		return false;
	list->used -= sizeof *pair;
	memcpy(pair, list->bytes + list->used, sizeof *pair);
	return true;
}

static uint32_t pair_at(const ob_mail *list, size_t i)
{
	uint32_t pair;
	memcpy(&pair, list->bytes + i * sizeof pair, sizeof pair);
	return pair;
}

// Lists the pairs among links_across that still link two ranks' bodies: late contacts, or else pairs that are expected
// to touch. false: the step has failed.
static bool list_links(ob_cluster *c, ob_universe *u, bool late)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const size_t all = c->links_across.used / sizeof(uint32_t);
	ob_mail_clear(&c->linked);
	for (size_t i = 0; i < all; i++) {
		const uint32_t pair = pair_at(&c->links_across, i);
		const ob_pair_key *k = &data->pair[pair];
		if ((late ? k->late : k->expected) && ob_pair_is_across(u, k))
			ob_cluster_note(u, &c->linked, pair);
	}
	return !c->linked.lost;
}

// Finds pairs that are expected to touch and link two ranks' bodies, after bodies got their homes. All ranks know these
// pairs from a checkpoint.
static void find_links(ob_cluster *c, ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	ob_mail_clear(&c->links_across);
	for (uint32_t i = 0; i < ob_pairs_end(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		if (k->expected && ob_object_in_range(data, k->a) && ob_object_in_range(data, k->b) &&
		    ob_pair_is_across(u, k))
			ob_cluster_note(u, &c->links_across, i);
	}
}

// Clears links between ranks after islands have been shared out. Late contacts are merged, so no longer late. A pair
// that is now another rank's alone is no longer expected: this rank receives no more checks of it. If it becomes a pair
// of two ranks again, its owner has checked it before, and sent the result to all.
static void forget_links(const ob_cluster *c, const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	for (size_t i = 0; i < c->links_across.used / sizeof(uint32_t); i++) {
		ob_pair_key *k = &data->pair[pair_at(&c->links_across, i)];
		k->late = 0;
		if (!ob_pair_is_across(u, k) && !ob_pair_is_known_here(u, k))
			k->expected = 0;
	}
}

static void note_link(ob_cluster *c, ob_universe *u, uint32_t a, uint32_t b)
{
	const ob_rank_link link = { a, b };
	ob_mail_append(&c->links, &link, sizeof link);
	if (c->links.lost)
		ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
}

// Lists pairs and joints that link two ranks' bodies. When islands are merged, each has all bodies that joints hold
// together. false: the step has failed.
static bool list_all_links(ob_cluster *c, ob_universe *u, bool late)
{
	const ob_step_data *data = ob_universe_step_data(u);
	ob_mail_clear(&c->links);
	if (!list_links(c, u, late))
		return false;
	for (size_t i = 0; i < c->linked.used / sizeof(uint32_t); i++) {
		const ob_pair_key *k = &data->pair[pair_at(&c->linked, i)];
		note_link(c, u, k->a, k->b);
	}
	for (uint32_t i = 0; !late && i < ob_joints_end(data); i++)
		if (ob_joint_is_across(u, &data->joint[i]))
			note_link(c, u, data->joint[i].object[0], data->joint[i].object[1]);
	return !c->links.lost;
}

// ---- in the order of a step

void ob_cluster_settle(ob_cluster *c, ob_universe *u)
{
	if (!c)
		return;
	if (ob_regions_settle(c->parts.regions, u))
		find_links(c, u);
	ob_halo_settle(c->parts.halo, u);
}

void ob_cluster_follow(ob_cluster *c, ob_universe *u)
{
	if (c)
		ob_regions_follow(c->parts.regions, u);
}

bool ob_cluster_meet(ob_cluster *c, ob_universe *u)
{
	return !c || ob_halo_meet(c->parts.halo, u, &c->peers);
}

bool ob_cluster_is_due(const ob_cluster *c, const ob_universe *u)
{
	const uint64_t step = ob_step_count(u);
	const ob_calendar solve = ob_calendar_of_objects(u), look = ob_calendar_of_pairs(u);
	if (c)
		return ob_universe_step_data(u)->count->next_due <= step;
	return ob_calendar_is_due(&solve, step) || ob_calendar_is_due(&look, step);
}

bool ob_cluster_is_whole(const ob_cluster *c)
{
	return !c || !ob_halo_is_partial(c->parts.halo);
}

uint64_t ob_cluster_begin(ob_cluster *c, ob_universe *u)
{
	const uint64_t move = c ? c->peers.move : ob_move_take(u);
	if (c)
		c->peers.islands = 0, c->peers.move = 0;
	return move;
}

void ob_cluster_end_contacts(ob_cluster *c, ob_universe *u)
{
	ob_pair_key *key = ob_universe_step_data(u)->pair;
	for (uint32_t pair; c && take_last(&c->parted, &pair);)
		if (!key[pair].active)
			ob_pair_release_record(u, &key[pair]);
}

void ob_cluster_involve_links(ob_cluster *c, ob_universe *u)
{
	if (!c || !list_all_links(c, u, false))
		return;
	const ob_mail those = c->links_across; // from now on complete
	c->links_across = c->linked;
	c->linked = those;
	const ob_rank_link *link = (const ob_rank_link *)(const void *)c->links.bytes;
	for (size_t i = 0; i < c->links.used / sizeof *link; i++)
		for (int side = 0; side < 2; side++) {
			const uint32_t id = side ? link[i].b : link[i].a;
			if (ob_home_rank(u, id) == ob_universe_rank(u))
				ob_involve_due(u, id);
		}
}

bool ob_cluster_share_islands(ob_cluster *c, ob_universe *u, bool *elsewhere)
{
	*elsewhere = false;
	if (!c)
		return true;
	if (!list_all_links(c, u, ob_universe_step_data(u)->count->merged))
		return false;
	const ob_rank_link *link = (const ob_rank_link *)(const void *)c->links.bytes;
	if (!ob_rank_islands_share(c->islands, u, &c->peers, link, (uint32_t)(c->links.used / sizeof *link), elsewhere))
		return false;
	forget_links(c, u);
	return true;
}

bool ob_cluster_take_checked(ob_cluster *c, uint32_t *pair)
{
	return c && take_last(&c->checked, pair);
}

uint32_t ob_cluster_islands(const ob_cluster *c, const ob_universe *u)
{
	return c ? c->peers.islands : ob_universe_step_data(u)->count->islands;
}

bool ob_cluster_gather(ob_cluster *c, ob_universe *u)
{
	const uint64_t step = ob_step_count(u);
	if (!c)
		return true;
	if (c->peers.look <= step && ob_halo_is_partial(c->parts.halo) && !ob_halo_gather(c->parts.halo, u, &c->peers))
		return false;
	return ob_contacts_wanted(u) != step || (ob_holdings_gather(c->parts.holdings, u, &c->peers) &&
						 ob_halo_share_pairs(c->parts.halo, u, &c->peers));
}
