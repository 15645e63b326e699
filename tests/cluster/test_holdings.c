// Pair records of several ranks: each goes to the rank that needs it next and to no other, whole; damage is detected.
// The test plays the other rank.
#include "check.h"

#include <stdlib.h>
#include <string.h>

#include "cluster/holdings.h"
#include "ode/ode_body.h"
#include "step/little_universe.h"
#include "table/home.h"
#include "table/layout.h"

// The wire of rank 1: sends nothing of its own when all is gathered.
typedef struct other {
	unsigned calls;
	char all[1 << 13];
	size_t said, at[3]; // said: bytes of parcels, by rank 0
} other;

static const char *gather(void *wire, const void *mine, size_t n, const size_t **at)
{
	other *w = wire;
	const size_t head = sizeof(ob_peers_head);
	w->calls++;
	CHECK(n >= head && n + head <= sizeof w->all);
	memcpy(w->all, mine, n);
	memcpy(w->all + n, mine, head);
	w->at[1] = n;
	w->at[2] = n + head;
	w->said = n - head;
	*at = w->at;
	return w->all;
}

typedef struct fixture {
	little_scene *s;
	little_universe l;
	ob_holdings *h;
	other wire;
	ob_peers p;
	ob_mail mail; // sent to the other rank
	uint32_t record;
	int version;
	ob_pair_state *state;
} fixture;

enum { CRATE = 1 };

// Sets the simulator that solves the crate: the one of the rank with that number.
static void give_crate_to(fixture *f, uint32_t simulator)
{
	ob_task_reset_from(f->l.u, 1, simulator, 1);
	ob_home_set(f->l.u, CRATE, simulator);
}

// A crate on the ground, about to be solved again by the first of two simulators, one of each rank.
static void open_crate(fixture *f)
{
	ob_error e;
	f->s = little_scene_new();
	ob_world_ground(&f->s->world);
	ob_world_box(&f->s->world, 1, ob_v3(.5, .5, .5), ob_v3(0, 0, .5));
	f->l = (little_universe){ .scene = f->s, .u = little_populate(f->s, 2) };
	ob_ode_thread_init();
	f->l.sim = ob_sim_create(f->l.u, 0, &e);
	CHECK(f->l.sim);
	little_run(&f->l, 5);
	f->l.u->ranks = 2;
	const ob_step_data *data = ob_universe_step_data(f->l.u);
	const ob_pair_key *key = &data->pair[data->island_pair[data->island[0].first_pair]];
	CHECK(data->count->chunks == 1 && key->active);
	f->record = key->record;
	f->version = ob_pair_newest(&data->record[f->record], ob_step_count(f->l.u));
	f->state = &data->record[f->record].version[f->version];
	data->result_island[CRATE] = 0;
	f->h = ob_holdings_create(f->l.u);
	f->wire = (other){ .calls = 0 };
	f->mail = (ob_mail){ 0 };
	f->p = (ob_peers){ .ranks = 2, .gather = gather, .wire = &f->wire };
	give_crate_to(f, 0);
}

static ob_pair_state *kept_state(const fixture *f)
{
	ob_pair_record *r = &ob_universe_step_data(f->l.u)->record[f->record];
	const int newest = ob_pair_newest(r, ob_step_count(f->l.u));
	return newest < 0 ? NULL : &r->version[newest];
}

static void close_crate(fixture *f)
{
	ob_holdings_destroy(f->h);
	ob_mail_finish(&f->mail);
	little_close(&f->l);
	free(f->s);
}

// Returns the number of bytes sent to the other rank.
static size_t move(fixture *f)
{
	ob_mail_clear(&f->mail);
	ob_holdings_give(f->h, f->l.u, CRATE, &f->mail);
	return f->mail.used;
}

static void check_damage(void)
{
	fixture f;
	open_crate(&f);
	CHECK(ob_holdings_damaged(f.h, f.l.u) == OB_NO_OBJECT);
	ob_holdings_note(f.h, f.l.u, f.record, f.version, f.state, 0);
	CHECK(ob_holdings_damaged(f.h, f.l.u) == OB_NO_OBJECT);
	f.state->impulse[0] = nextafter(f.state->impulse[0], 1);
	CHECK(ob_holdings_damaged(f.h, f.l.u) == 0); // the ground, the first of the two
	ob_holdings_note(f.h, f.l.u, f.record, -1, NULL, 1); // the record belongs to the other rank
	CHECK(ob_holdings_damaged(f.h, f.l.u) == OB_NO_OBJECT);
	close_crate(&f);
}

// To all, once; then to another rank, and from there back to this one, once each.
static void check_ways(void)
{
	fixture f;
	char parcel[512];
	open_crate(&f);
	const ob_pair_state before = *f.state;
	give_crate_to(&f, 1);
	CHECK(move(&f) == 0); // all have it
	give_crate_to(&f, 0);
	ob_holdings_note(f.h, f.l.u, f.record, f.version, f.state, 0);
	CHECK(ob_holdings_here_alone(f.h, f.l.u, f.record));
	CHECK(ob_holdings_gather(f.h, f.l.u, &f.p) && f.wire.calls == 1 && f.wire.said > sizeof before);
	CHECK(!ob_holdings_here_alone(f.h, f.l.u, f.record));
	ob_holdings_note(f.h, f.l.u, f.record, f.version, f.state, 0);
	give_crate_to(&f, 1);
	const size_t bytes = move(&f);
	CHECK(bytes > sizeof before && bytes <= sizeof parcel);
	memcpy(parcel, f.mail.bytes, bytes);
	CHECK(!kept_state(&f) && !ob_holdings_here_alone(f.h, f.l.u, f.record));
	CHECK(move(&f) == 0);
	CHECK(!ob_holdings_take(f.h, f.l.u, parcel, bytes)); // the other rank owns it now
	give_crate_to(&f, 0);
	CHECK(!ob_holdings_take(f.h, f.l.u, parcel, bytes - 8));
	CHECK(ob_holdings_take(f.h, f.l.u, parcel, bytes));
	f.state = kept_state(&f);
	CHECK(f.state && memcmp(f.state, &before, sizeof before) == 0);
	CHECK(ob_holdings_here_alone(f.h, f.l.u, f.record));
	CHECK(f.wire.calls == 1);
	f.state->gap[0] = nextafter(f.state->gap[0], 1);
	CHECK(ob_holdings_damaged(f.h, f.l.u) == 0);
	close_crate(&f);
}

int main(void)
{
	check_damage();
	check_ways();
	return check_end();
}
