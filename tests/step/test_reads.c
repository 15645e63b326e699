// A solve reads only its permitted data: before the simulators solve their islands, all other data are hidden from
// them, filled with 0xff or unmapped, and the universe ends in the same bits. Each keeps
//
//   settings, the step's counts, the plan of its own islands, passports, hulls, and all bodies that no simulator
//   solves; all data of its own islands' members; the keys of their pairs, and the pairs' records from before the step.
//
// So a remote solver of an island needs no more than that. The simulators are contained: processes that hand over their
// results (table/outbox.h), so that data hidden from one are still there for all others.
#include "check.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "little_universe.h"
#include "motion/random.h"
#include "ode/ode_body.h"
#include "table/layout.h"
#include "table/outbox.h"

enum { SIMULATORS = 3, STEPS = 240 };

typedef enum hidden {
	NOTHING,
	REST,
	TOO_MUCH, // also the records of their pairs, which they need
} hidden;

// Elements that a simulator's islands need.
typedef struct needed {
	bool *object, *mine, *pair, *record, *island, *place, *pair_place; // mine: those of object that are members
} needed;

// Number of moving objects hidden from a simulator with an island to solve, over all steps; shared by all.
static uint64_t *hidden_objects;

// ---- hidden data

static uint64_t end_of(const ob_universe *u, ob_area area)
{
	return area + 1 < OB_AREAS ? u->header.area[area + 1] : u->header.bytes;
}

// Maps an area anew: private to this process, unreadable, or shared again.
static void map(const ob_universe *u, ob_area area, int protection, int flags)
{
	const uint64_t at = u->header.area[area], bytes = end_of(u, area) - at;
	if (bytes && mmap(u->base + at, bytes, protection, flags | MAP_FIXED, u->fd, (off_t)at) == MAP_FAILED)
		abort();
}

static void fill(const ob_universe *u, ob_area area, uint32_t elements, const bool *but)
{
	const uint64_t each = ob_layout_element(area);
	map(u, area, PROT_READ | PROT_WRITE, MAP_PRIVATE);
	for (uint64_t i = 0; i < elements; i++)
		if (!but[i])
			memset(u->base + u->header.area[area] + i * each, 0xff, each);
}

// Keeps only the version from before the step of each needed record.
static void fill_versions(const ob_universe *u, const needed *n, hidden what)
{
	const ob_step_data *data = &u->step_data;
	for (uint32_t i = 0; i < data->count->records_used; i++) {
		ob_pair_record *r = &data->record[i];
		const ob_pair_state *before = n->record[i] ? ob_pair_before(r, ob_step_count(u)) : NULL;
		for (int k = 0; k < 2; k++)
			if (&r->version[k] != before || what == TOO_MUCH)
				memset(&r->version[k], 0xff, sizeof r->version[k]);
	}
}

static void need_island(const ob_universe *u, uint32_t island, needed *n)
{
	const ob_step_data *data = &u->step_data;
	const ob_island *is = &data->island[island];
	n->island[island] = true;
	for (uint32_t i = is->first_member; i < is->first_member + is->members; i++)
		n->place[i] = n->mine[data->member[i]] = n->object[data->member[i]] = true;
	for (uint32_t i = is->first_pair; i < is->first_pair + is->pairs; i++) {
		const ob_pair_key *key = &data->pair[data->island_pair[i]];
		n->pair_place[i] = n->pair[data->island_pair[i]] = true;
		if (key->record != OB_NO_RECORD)
			n->record[key->record] = true;
	}
}

// true: it has an island to solve.
static bool need(const ob_universe *u, uint32_t simulator, needed *n)
{
	const ob_step_data *data = &u->step_data;
	bool any = false;
	for (uint32_t id = 0; id < ob_universe_ids(u); id++)
		n->object[id] = data->schedule[id].state < OB_SCHEDULE_AWAKE;
	for (uint32_t chunk = 0; chunk < data->count->chunks; chunk++)
		for (uint32_t i = data->chunk[chunk];
		     ob_task_owner(chunk, ob_task_workers(u)) == simulator && i < data->chunk[chunk + 1]; i++) {
			need_island(u, i, n);
			any = true;
		}
	return any;
}

static void count_hidden(const ob_universe *u, const needed *n)
{
	uint64_t moving = 0;
	for (uint32_t id = 0; id < ob_universe_ids(u); id++)
		moving += !n->object[id];
	__atomic_fetch_add(hidden_objects, moving, __ATOMIC_RELAXED);
}

static const ob_area unread[] = { OB_AREA_REQUERY,     OB_AREA_REQUERY_BIT, OB_AREA_RESULT,     OB_AREA_NEIGHBOUR_ID,
				  OB_AREA_CELL,        OB_AREA_BUCKET,      OB_AREA_PAIR_LINKS, OB_AREA_FIRST_PAIR,
				  OB_AREA_SOLVE,       OB_AREA_SOLVE_64,    OB_AREA_SOLVE_4096, OB_AREA_LOOK,
				  OB_AREA_LOOK_64,     OB_AREA_LOOK_4096,   OB_AREA_CHECK,      OB_AREA_IMPULSE_B,
				  OB_AREA_RECORD_FREE, OB_AREA_SCRATCH,     OB_AREA_OCCUPIED };
static const ob_area partly[] = { OB_AREA_SLOT,          OB_AREA_SCHEDULE,   OB_AREA_BOUNDS,     OB_AREA_EFFORT,
				  OB_AREA_RESULT_ISLAND, OB_AREA_NEIGHBOURS, OB_AREA_PAIR,       OB_AREA_RECORD,
				  OB_AREA_ISLAND,        OB_AREA_MEMBER,     OB_AREA_ISLAND_PAIR };

static void hide(const ob_universe *u, const needed *n, hidden what)
{
	const ob_step_data *data = &u->step_data;
	const uint32_t ids = ob_universe_ids(u);
	fill(u, OB_AREA_SLOT, ids, n->object);
	fill(u, OB_AREA_SCHEDULE, ids, n->object);
	fill(u, OB_AREA_BOUNDS, ids, n->mine);
	fill(u, OB_AREA_EFFORT, ids, n->mine);
	fill(u, OB_AREA_RESULT_ISLAND, ids, n->mine);
	fill(u, OB_AREA_NEIGHBOURS, ids, n->mine);
	fill(u, OB_AREA_PAIR, data->count->pairs, n->pair);
	fill(u, OB_AREA_RECORD, data->count->records_used, n->record);
	fill_versions(u, n, what);
	fill(u, OB_AREA_ISLAND, data->count->islands, n->island);
	fill(u, OB_AREA_MEMBER, data->objects_max, n->place);
	fill(u, OB_AREA_ISLAND_PAIR, data->count->island_pairs, n->pair_place);
	for (size_t i = 0; i < sizeof unread / sizeof *unread; i++)
		map(u, unread[i], PROT_NONE, MAP_PRIVATE);
}

static void show(const ob_universe *u)
{
	for (size_t i = 0; i < sizeof partly / sizeof *partly; i++)
		map(u, partly[i], PROT_READ | PROT_WRITE, MAP_SHARED);
	for (size_t i = 0; i < sizeof unread / sizeof *unread; i++)
		map(u, unread[i], PROT_READ | PROT_WRITE, MAP_SHARED);
}

// ---- hidden data of each simulator

static bool *flags(uint32_t n)
{
	bool *made = calloc((size_t)n + 1, sizeof *made);
	if (!made)
		abort();
	return made;
}

// A simulator that solves with the rest hidden. false: the run is over.
static bool step_blindly(ob_sim *s, ob_universe *u, uint32_t simulator, hidden what)
{
	const ob_step_data *data = &u->step_data;
	if (ob_turn_wait(u, simulator) != OB_PHASE_ISLANDS || what == NOTHING)
		return ob_step(s);
	needed n = { flags(data->objects_max), flags(data->objects_max), flags(data->pairs_max), flags(data->pairs_max),
		     flags(data->objects_max), flags(data->objects_max), flags(data->pairs_max) };
	if (need(u, simulator, &n))
		count_hidden(u, &n);
	hide(u, &n, what);
	const bool goes_on = ob_step(s);
	show(u);
	bool *const all[] = { n.object, n.mine, n.pair, n.record, n.island, n.place, n.pair_place };
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		free(all[i]);
	return goes_on;
}

_Noreturn static void live(ob_universe *u, uint32_t simulator, hidden what)
{
	ob_error e;
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	ob_ode_thread_init();
	ob_sim *s = ob_sim_create(u, simulator, &e);
	if (!s || !ob_outbox_enter(u, simulator))
		abort();
	while (step_blindly(s, u, simulator, what))
		;
	ob_sim_destroy(s);
	ob_ode_thread_finish();
	_exit(0);
}

// Ends the arranger, which would wait for the dead simulator.
static void on_death(int signal)
{
	static const char text[] = "a simulator has died: it has read what was hidden from it\n";
	ssize_t ignored = write(STDERR_FILENO, text, sizeof text - 1);
	(void)ignored;
	(void)signal;
	_exit(1);
}

// The hash after a number of steps, with three simulators in processes of their own.
static uint64_t run_apart(little_scene *s, hidden what)
{
	ob_error e;
	s->harden = 1 << OB_HARDEN_OUTBOX;
	little_universe l = { .scene = s, .u = little_populate(s, SIMULATORS + 1) };
	ob_universe_unlink(l.u); // no other process opens it, and it may end in any way
	signal(SIGCHLD, on_death);
	fflush(NULL);
	for (uint32_t w = 0; w < SIMULATORS; w++)
		if (fork() == 0)
			live(l.u, w, what);
	ob_ode_thread_init();
	l.sim = ob_sim_create(l.u, SIMULATORS, &e); // the arranger
	CHECK(l.sim);
	little_run(&l, STEPS);
	const uint64_t hash = ob_measure_hash(&l.now);
	signal(SIGCHLD, SIG_DFL);
	ob_gate_stop(l.u);
	while (wait(NULL) > 0)
		;
	little_close(&l);
	s->harden = 0;
	return hash;
}

// Runs in a process: true if it ends in that hash. With too much hidden, it may end in any way.
static bool ends_in(little_scene *s, hidden what, uint64_t hash)
{
	int status = -1;
	fflush(NULL);
	const pid_t pid = fork();
	if (pid == 0) {
		if (what == TOO_MUCH && !freopen("/dev/null", "w", stderr))
			abort();
		_exit(run_apart(s, what) != hash);
	}
	CHECK(pid > 0 && waitpid(pid, &status, 0) == pid);
	return status == 0;
}

// Boxes and balls that fall on each other and on moving and static bodies, and a few that fly alone.
static little_scene *heap(void)
{
	uint64_t seed = 1;
	little_scene *s = little_scene_new();
	s->run.sleeping = 1;
	s->run.tolerance = 1e-3;
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 0, ob_v3(1, 1, .3), ob_v3(0, 0, .3));
	for (int i = 0; i < 40; i++) {
		const ob_vec3 p = ob_add(random_vector(&seed, .1),
					 ob_v3(i % 4 * 1.1 - 1.6, i / 4 % 4 * 1.1 - 1.6, 1.2 + i / 16 * 1.1)),
			      half = ob_add(ob_v3(.3, .3, .3), random_vector(&seed, .1));
		ob_world_body o =
			i % 5 == 0 ? ob_world_sphere(&s->world, 10, .3, p) : ob_world_box(&s->world, 20, half, p);
		o.passport->restitution = i % 3 ? 0 : .5;
		o.state->pose.q = random_attitude(&seed);
	}
	for (int i = 0; i < 6; i++)
		ob_world_sphere(&s->world, 1, .2, ob_v3(20 + 3 * i, 0, 1 + i)).passport->restitution = .8;
	return s;
}

int main(void)
{
	little_scene *s = heap();
	little_universe l;
	hidden_objects = mmap(NULL, sizeof *hidden_objects, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	CHECK(hidden_objects != MAP_FAILED);
	little_open(&l, s);
	little_run(&l, STEPS);
	const uint64_t hash = ob_measure_hash(&l.now);
	little_close(&l);
	CHECK(ends_in(s, NOTHING, hash));
	CHECK(*hidden_objects == 0);
	CHECK(ends_in(s, REST, hash));
	CHECK(*hidden_objects > 20 * STEPS);
	CHECK(!ends_in(s, TOO_MUCH, hash));
	free(s);
	return check_end();
}
