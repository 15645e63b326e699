// Messages between the schedulers of several ranks: the mail of all in their order; rank, step and object of a
// difference; and notices of leaving. The test plays the other rank.
#include "check.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "cluster/peers.h"
#include "step/little_universe.h"

enum { CRATE = 1, DIGEST_OF_CRATE = 1 + (2 * CRATE + 1) * sizeof(uint64_t) }; // 1 + the place of a byte of it

// Sends as rank 1 what rank 0 sends, except for one bit.
typedef struct echo {
	size_t wrong[2]; // byte of each message in turn, 1 + its place; 0: none
	bool leaves; // instead
	unsigned calls;
	char all[1 << 16];
	size_t at[3];
} echo;

static const char *gather(void *wire, const void *mine, size_t n, const size_t **at)
{
	echo *w = wire;
	const size_t wrong = w->calls < 2 ? w->wrong[w->calls] : 0;
	w->calls++;
	CHECK(2 * n <= sizeof w->all && wrong <= n);
	memcpy(w->all, mine, n);
	memcpy(w->all + n, mine, n);
	if (wrong)
		w->all[n + wrong - 1] ^= 1;
	if (w->leaves) // like ob_peers_leave
		memset(w->all + n + sizeof(uint64_t), 0xff, sizeof(uint64_t));
	w->at[1] = n;
	w->at[2] = 2 * n;
	*at = w->at;
	return w->all;
}

static void open_two(little_scene **s, little_universe *l)
{
	*s = little_scene_new();
	ob_world_ground(&(*s)->world);
	snprintf(ob_world_box(&(*s)->world, 1, ob_v3(.5, .5, .5), ob_v3(0, 0, .5)).passport->name, OB_NAME_MAX,
		 "crate");
	ob_world_sphere(&(*s)->world, 1, .5, ob_v3(3, 0, .6));
	little_open(l, *s);
	little_run(l, 5);
}

static void close_two(little_scene *s, little_universe *l)
{
	little_close(l);
	free(s);
}

static const uint64_t words[3] = { 1, 2, 3 };

static const char *exchange(ob_peers *p, ob_universe *u, ob_mail *mail)
{
	const size_t *at;
	ob_peers_begin(mail);
	ob_mail_append(mail, words, sizeof words);
	const ob_peers_head head = { .phase = OB_PHASE_ISLANDS, .digest = ob_peers_digest(u) };
	const char *all = ob_peers_exchange(p, u, head, mail, false, &at);
	for (int r = 0; all && r < 2; r++)
		CHECK(at[r + 1] - at[r] == sizeof head + sizeof words &&
		      memcmp(all + at[r] + sizeof head, words, sizeof words) == 0);
	return all;
}

static void check_mail(void)
{
	little_scene *s;
	little_universe l;
	echo wire = { .calls = 0 };
	ob_peers p = { .ranks = 2, .gather = gather, .wire = &wire };
	ob_mail mail = { 0 };
	open_two(&s, &l);
	CHECK(exchange(&p, l.u, &mail));
	CHECK(ob_step_failed(l.u, NULL) == OB_STEP_OK && wire.calls == 1);
	ob_mail_finish(&mail);
	close_two(s, &l);
}

// A mail that memory did not suffice for is not sent.
static void check_lost(void)
{
	little_scene *s;
	little_universe l;
	echo wire = { .calls = 0 };
	ob_peers p = { .ranks = 2, .gather = gather, .wire = &wire };
	const size_t *at;
	ob_mail mail = { 0 };
	open_two(&s, &l);
	ob_peers_begin(&mail);
	mail.lost = true;
	ob_mail_append(&mail, words, sizeof words);
	CHECK(!ob_peers_exchange(&p, l.u, (ob_peers_head){ .phase = OB_PEERS_CUT }, &mail, false, &at) &&
	      wire.calls == 0);
	CHECK(ob_step_failed(l.u, NULL) == OB_STEP_MEMORY_FULL);
	ob_mail_clear(&mail);
	CHECK(!mail.lost);
	ob_mail_finish(&mail);
	close_two(s, &l);
}

static bool count(void *with, ob_universe *u, const char *parcel, const ob_parcel *head, uint32_t from)
{
	unsigned *taken = with;
	CHECK(from == 1 && head->kind == OB_PARCEL_COST && head->bytes == 16 &&
	      memcmp(parcel, head, sizeof *head) == 0);
	return ++*taken < 3;
}

// Parcels of 16 bytes come from the other rank. The last gives its size as `last`; `more` bytes follow it. Wrong are a
// size below that of a head, or beyond the message, an end within a head, and a parcel that is refused.
static void check_parcels(uint32_t parcels, uint32_t last, size_t more, unsigned taken, bool sound)
{
	little_scene *s;
	little_universe l;
	echo wire = { .calls = 0 };
	ob_peers p = { .ranks = 2, .gather = gather, .wire = &wire };
	ob_mail mail = { 0 };
	unsigned found = 0;
	open_two(&s, &l);
	ob_peers_begin(&mail);
	for (uint32_t i = 0; i < parcels; i++) {
		const struct {
			ob_parcel head;
			uint64_t word;
		} one = { { OB_PARCEL_COST, i + 1 < parcels ? 16 : last }, i };
		ob_mail_append(&mail, &one, sizeof one);
	}
	ob_mail_append(&mail, words, more);
	CHECK(ob_parcels_exchange(&p, l.u, OB_PEERS_CUT, &mail, false, count, &found) == sound && found == taken);
	CHECK(ob_step_failed(l.u, NULL) == (sound ? OB_STEP_OK : OB_STEP_DAMAGED));
	ob_mail_finish(&mail);
	close_two(s, &l);
}

// A digest that differs, then the object in which the ranks differ: each sends the digests and steps of all objects.
// first: byte of the head, likewise.
static void check_difference(size_t first, size_t place, const char *named)
{
	little_scene *s;
	little_universe l;
	echo wire = { .wrong = { first, place } };
	ob_peers p = { .ranks = 2, .gather = gather, .wire = &wire };
	ob_mail mail = { 0 };
	open_two(&s, &l);
	CHECK(!exchange(&p, l.u, &mail) && ob_step_failed(l.u, NULL) == OB_STEP_DAMAGED);
	const char *text = ob_universe_step_data(l.u)->count->blamed_for;
	CHECK(strstr(text, "rank 1") && strstr(text, "step 6") && strstr(text, named));
	ob_mail_finish(&mail);
	close_two(s, &l);
}

static void check_digest(void)
{
	little_scene *s;
	little_universe l;
	open_two(&s, &l);
	const uint64_t before = ob_peers_digest(l.u);
	CHECK(ob_universe_step_data(l.u)->count->pairs > 0 && ob_peers_digest(l.u) == before);
	ob_requery_append(l.u, CRATE);
	const uint64_t asked = ob_peers_digest(l.u);
	ob_requery_reset(l.u);
	ob_requery_append(l.u, CRATE + 1);
	CHECK(asked != before && ob_peers_digest(l.u) != asked && ob_peers_digest(l.u) != before);
	ob_requery_reset(l.u);
	ob_universe_step_data(l.u)->count->pairs++;
	CHECK(ob_peers_digest(l.u) != before);
	ob_universe_step_data(l.u)->count->pairs--;
	close_two(s, &l);
}

// A leaving rank sends one notice; a rank that receives it leaves, too, and sends nothing more.
static void check_leaving(void)
{
	little_scene *s;
	little_universe l;
	echo wire = { .calls = 0 };
	ob_peers p = { .ranks = 2, .gather = gather, .wire = &wire };
	ob_mail mail = { 0 };
	open_two(&s, &l);
	ob_peers_leave(&p);
	ob_peers_leave(&p);
	CHECK(wire.calls == 1);
	wire = (echo){ .leaves = true };
	p.parted = false;
	CHECK(!exchange(&p, l.u, &mail) && ob_step_failed(l.u, NULL) == OB_STEP_LEFT && p.parted);
	ob_peers_leave(&p);
	CHECK(wire.calls == 1);
	ob_mail_finish(&mail);
	close_two(s, &l);
}

static void check_joining(void)
{
	little_scene *s;
	little_universe l;
	ob_error e;
	echo same = { .calls = 0 };
	ob_peers p = { .ranks = 2, .gather = gather, .wire = &same };
	open_two(&s, &l);
	CHECK(ob_peers_join(&p, l.u, &e) && !p.parted);
	static const char *const wrong[] = { "version", "workers", "settings", "scene", "bits" };
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		echo other = { .wrong = { 1 + i * sizeof(uint64_t) } };
		p = (ob_peers){ .ranks = 2, .gather = gather, .wire = &other };
		CHECK(!ob_peers_join(&p, l.u, &e) && strstr(e.text, "rank 1") && strstr(e.text, wrong[i]) && p.parted);
	}
	close_two(s, &l);
}

int main(void)
{
	check_mail();
	check_lost();
	check_parcels(0, 16, 0, 0, true);
	check_parcels(2, 16, 0, 2, true);
	check_parcels(3, 16, 0, 3, false);
	check_parcels(2, 24, 0, 1, false);
	check_parcels(2, 4, 0, 1, false);
	check_parcels(1, 0, 0, 0, false);
	check_parcels(1, 16, 4, 1, false);
	check_difference(1 + offsetof(ob_peers_head, digest), DIGEST_OF_CRATE, "object \"crate\"");
	check_difference(1 + offsetof(ob_peers_head, digest), 0, "otherwise");
	check_difference(1 + offsetof(ob_peers_head, phase), 0, "otherwise");
	check_difference(1 + offsetof(ob_peers_head, differs), DIGEST_OF_CRATE, "object \"crate\"");
	// A digest of another step may differ.
	check_difference(1 + offsetof(ob_peers_head, digest), DIGEST_OF_CRATE - sizeof(uint64_t), "otherwise");
	check_difference(1 + offsetof(ob_peers_head, damaged), 0, "of a contact of object");
	check_difference(1 + offsetof(ob_peers_head, damaged) + sizeof(uint64_t) - 1, 0, "");
	check_digest();
	check_leaving();
	check_joining();
	return check_end();
}
