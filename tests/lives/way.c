#include "way.h"

#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/random.h"
#include "checkpoint/saved_run.h"
#include "deeds.h"
#include "free_way.h"
#include "measure/measure.h"
#include "reader.h"
#include "things.h"

// A life takes some tens of ms. It hangs if one of its processes takes so much CPU, on however busy a machine, or if all wait.
enum { CPU_S = 300, WALL_S = 10 * CPU_S };

// ---- events

// An object that exists, any of them. false: none does.
bool draw_object(const run *r, uint64_t *seed, ob_passport *p)
{
	const uint32_t ids = ob_universe_ids(universe(r));
	uint32_t n = 0, which;
	for (uint32_t id = 0; id < ids; id++)
		n += ob_universe_get_passport(universe(r), id, p);
	which = (uint32_t)(ob_splitmix(seed) % (n ? n : 1));
	for (uint32_t id = 0; id < ids; id++)
		if (ob_universe_get_passport(universe(r), id, p) && which-- == 0)
			return true;
	return false;
}

static void create(run *r, uint64_t *seed)
{
	static const ob_shape shapes[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
	ob_object_def d = { .dies = INFINITY };
	ob_passport *p = &d.passport;
	const uint64_t kind = ob_splitmix(seed);
	p->shape = shapes[kind % 4];
	p->size.x = ob_splitmix_within(seed, .03, .3);
	p->size.y = p->shape == OB_SHAPE_SPHERE ? 0 : ob_splitmix_within(seed, .03, .3);
	p->size.z = p->shape == OB_SHAPE_BOX ? ob_splitmix_within(seed, .03, .3) : 0;
	p->friction = .5;
	p->restitution = ob_splitmix_within(seed, 0, .8);
	p->flags = kind / 4 % 8 == 0 ? OB_OBJECT_STATIC : kind / 4 % 8 == 1 ? OB_OBJECT_KINEMATIC : 0;
	p->mass = p->flags ? 0 : ob_splitmix_within(seed, .1, 50);
	d.state.pose = (ob_pose){ ob_splitmix_vector(seed, 1), ob_quat_identity() };
	d.state.pose.p.z += 1.5;
	if (!(p->flags & OB_OBJECT_STATIC))
		d.state.v = ob_splitmix_vector(seed, 3);
	ob_host_request(r->h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = d }, &r->e);
}

static void remove_any(run *r, uint64_t *seed)
{
	ob_passport p;
	if (draw_object(r, seed, &p))
		ob_host_request_remove(r->h, p.id, p.generation);
}

// Removes the object that was created just now: it has the lowest free slots, and a generation not yet published.
static void remove_created(run *r)
{
	enum { GENERATIONS = 12, SLOTS = 3 };
	ob_passport p;
	uint32_t found = 0;
	for (uint32_t id = 0; id < ob_universe_capacity(universe(r)) && found < SLOTS; id++) {
		if (ob_universe_get_passport(universe(r), id, &p))
			continue;
		found++;
		for (uint32_t generation = 1; generation < GENERATIONS; generation++)
			ob_host_request_remove(r->h, id, generation);
	}
}

static void say(run *r, uint64_t *seed, ob_request_kind kind)
{
	ob_passport p;
	ob_request q = { .kind = kind, .colour = { .5, .25, .75, 1 } };
	if (!draw_object(r, seed, &p) || (kind == OB_REQUEST_MESSAGE && !ob_script_turn_of(universe(r), p.id)))
		return;
	q.id = p.id, q.generation = p.generation;
	ob_scene_put_value("1", q.values, &q.bytes, sizeof q.values);
	ob_host_request(r->h, &q, &r->e);
}

// Freezes one as a simulator's failure would, before or after the scripts of the coming step.
static void freeze_any(run *r, uint64_t *seed)
{
	ob_restart_state *x = &r->h->restart;
	ob_passport p;
	if (!draw_object(r, seed, &p))
		return;
	const bool scripts = ob_universe_step_data(universe(r))->script_counts;
	const ob_journal_place place = { ob_step_count(universe(r)), scripts && ob_splitmix(seed) % 2 };
	if (x->freezes == x->freezes_max)
		x->freeze = realloc(x->freeze, (x->freezes_max = 2 * x->freezes_max + 4) * sizeof *x->freeze);
	x->freeze[x->freezes++] = (ob_freeze){ place, p.id, p.generation };
}

bool stand_at(run *r, uint64_t step)
{
	ob_host_go(r->h, step);
	return ob_host_wait(r->h, &r->e);
}

// Ends a simulator, or in a free run stops it for a while, half of the time.
static void stop_or_kill(const run *r, int pid, uint64_t seed)
{
	const bool stops = r->way == WAY_FREE && ob_splitmix(&seed) % 2;
	kill(pid, stops ? SIGSTOP : SIGKILL);
	if (!stops)
		return;
	nanosleep(&(struct timespec){ .tv_nsec = (long)(ob_splitmix(&seed) % 40000000) }, NULL);
	kill(pid, SIGCONT);
}

// True if the event leaves a closed life closed, or a free run takes it.
static bool may_happen(const run *r, uint32_t kind)
{
	if (r->l->closed)
		return kind == LIFE_KILL || kind == LIFE_PAUSE || kind == LIFE_COLOUR;
	return r->way != WAY_FREE || (kind != LIFE_FREEZE && kind != LIFE_RESUME && kind != LIFE_RETURN);
}

// Kills one while the run stands, or some time after it goes on.
static bool kill_any(run *r, uint64_t *seed)
{
	ob_worker_info info;
	const uint32_t worker = (uint32_t)(ob_splitmix(seed) % r->h->workers);
	const uint64_t step = ob_step_count(universe(r));
	const uint64_t until = step + ob_splitmix(seed) % 2;
	if (ob_splitmix(seed) % 2)
		r->h->restart.cost = 1e9; // no checkpoint for a while
	ob_host_go(r->h, until < LIFE_STEPS ? until : LIFE_STEPS);
	if (r->config.isolation == OB_ISOLATION_THREAD)
		return ob_host_wait(r->h, &r->e);
	nanosleep(&(struct timespec){ .tv_nsec = (long)(ob_splitmix(seed) % 2000000) }, NULL);
	if (ob_universe_get_worker(universe(r), worker, &info) && info.pid > 0)
		stop_or_kill(r, info.pid, *seed);
	return ob_host_wait(r->h, &r->e);
}

static bool start(run *r, const ob_saved_host *from)
{
	r->config.from = from;
	r->h = ob_host_start(r->scene, &r->config, &r->e);
	if (r->h && r->l->reader)
		r->reader = reader_start(ob_universe_name(universe(r)));
	return r->h;
}

// false: a reader has found what makes no sense.
static bool stop(run *r)
{
	ob_host_times times = { 0 };
	const bool fine = reader_stop(r->reader, &r->e);
	r->reader = NULL;
	if (r->h) {
		ob_host_get_times(r->h, &times);
		ob_host_stop(r->h);
	}
	r->deaths += times.deaths;
	r->h = NULL;
	return fine;
}

static bool put_down_and_resume(run *r)
{
	ob_checkpoint_file f = { 0 }, read = { 0 };
	ob_saved_run made = { .scene = "life.lua",
			      .text = r->l->text,
			      .text_size = strlen(r->l->text),
			      .duration = LIFE_STEPS / 60.,
			      .settings = r->scene->run },
		     saved;
	const bool stands = stand_at(r, ob_step_count(universe(r))); // requests that wait are no part of a saved run
	if (r->way != WAY_ONE_THREAD || !stands)
		return stands;
	bool fine = ob_saved_run_make(&made, &f, r->h, "", &r->e);
	if (fine) {
		fine = stop(r);
		ob_checkpoint_seal(&f);
		fine = fine && ob_saved_run_parse(&saved, &read, f.bytes, f.size, "life", &r->e);
		if (fine) {
			fine = start(r, &saved.host);
			ob_saved_run_close(&saved, &read);
		}
	}
	ob_checkpoint_finish(&f);
	return fine;
}

// ---- a life

static bool happen(run *r, const life_event *event)
{
	uint64_t seed = event->seed;
	switch ((life_event_kind)event->kind) {
	case LIFE_CREATE:
		create(r, &seed);
		return true;
	case LIFE_REMOVE:
		remove_any(r, &seed);
		return true;
	case LIFE_CREATE_REMOVE:
		create(r, &seed);
		remove_created(r);
		return true;
	case LIFE_REPLACE:
		remove_any(r, &seed);
		create(r, &seed);
		return true;
	case LIFE_MESSAGE:
		say(r, &seed, OB_REQUEST_MESSAGE);
		return true;
	case LIFE_COLOUR:
		say(r, &seed, OB_REQUEST_COLOUR);
		return true;
	case LIFE_FREEZE:
		freeze_any(r, &seed);
		return true;
	case LIFE_PAUSE:
		return stand_at(r, ob_step_count(universe(r)));
	case LIFE_KILL:
		return kill_any(r, &seed);
	case LIFE_RESUME:
		return put_down_and_resume(r);
	default:
		return deed_happen(r, event);
	}
}

static bool live(run *r)
{
	if (!start(r, NULL) || !stand_at(r, r->way == WAY_FREE ? 1 : 0))
		return false;
	const free_sums begin = r->way == WAY_FREE ? free_way_measure(r) : (free_sums){ .energy = 0 };
	for (uint32_t i = 0; i < r->l->events; i++)
		if ((r->l->event[i].step > ob_step_count(universe(r)) && !stand_at(r, r->l->event[i].step)) ||
		    (may_happen(r, r->l->event[i].kind) && !happen(r, &r->l->event[i])))
			return false;
	return stand_at(r, LIFE_STEPS) && (r->way != WAY_FREE || free_way_check(r, &begin));
}

static uint64_t hash_of(run *r, uint32_t *objects)
{
	const ob_universe *u = universe(r);
	const ob_step_data *data = ob_universe_step_data(u);
	ob_snapshot now = { 0 };
	uint64_t hash = OB_HASH_BEGIN;
	if (ob_snapshot_take(&now, u, 0, &r->e)) {
		const uint64_t motions = ob_measure_hash(&now);
		hash = ob_hash_on(hash, &motions, sizeof motions);
	}
	ob_snapshot_finish(&now);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		ob_passport p;
		if (!ob_universe_get_passport(u, id, &p))
			continue;
		hash = ob_hash_on(hash, &p, sizeof p);
		++*objects;
	}
	for (uint32_t i = 0; i < data->script_cells; i++) {
		const ob_script_cell *c = &data->script_cell[i];
		if (!data->script_turn[i].script)
			continue;
		hash = ob_hash_on(hash, &data->script_turn[i], sizeof *data->script_turn);
		hash = ob_hash_on(hash, c->state, c->state_bytes);
		hash = ob_hash_on(hash, c->inbox, c->inbox_bytes);
		hash = ob_hash_on(hash, c->random, sizeof c->random);
	}
	return hash;
}

static outcome live_here(const life *l, way w)
{
	char path[300];
	run r = { .l = l, .way = w, .e = { "" } };
	outcome o = { 0 };
	snprintf(path, sizeof path, "%s/life.lua", things_folder());
	r.scene = ob_scene_load_text(path, l->text, strlen(l->text), NULL, &r.e);
	bool fine = r.scene && ob_run_settings_resolve(&r.scene->run, NULL, &r.e);
	if (fine) {
		r.config =
			(ob_host_config){ .isolation = w < WAY_PROCESSES ? OB_ISOLATION_THREAD : OB_ISOLATION_PROCESS,
					  .workers = w == WAY_ONE_THREAD ? 1 : 2,
					  .harden = w == WAY_HARDENED ? OB_HARDEN_ALL : 0,
					  .on_death = l->keeps ? OB_ON_DEATH_KEEP : OB_ON_DEATH_RESTART,
					  .check = true,
					  .returns = true,
					  .run = r.scene->run };
		r.config.run.freezes = l->keeps;
		if (w == WAY_FREE)
			free_way_settings(&r);
		fine = live(&r);
	}
	if (fine)
		o.hash = hash_of(&r, &o.objects);
	o.broken = !r.scene || r.broken || (r.h && ob_host_broke_invariant(r.h));
	if (!stop(&r))
		fine = false, o.broken = true;
	o.failed = !fine;
	snprintf(o.text, sizeof o.text, "%.390s", fine ? "" : r.e.text);
	o.deaths = r.deaths;
	ob_scene_free(r.scene);
	return o;
}

outcome way_run(const life *l, way w)
{
	outcome o = { .failed = true, .broken = true };
	int ends[2], status = 0;
	fflush(NULL);
	if (pipe(ends) != 0)
		abort();
	const pid_t pid = fork();
	if (pid == 0) {
		close(ends[0]);
		setrlimit(RLIMIT_CPU, &(struct rlimit){ CPU_S, CPU_S + 1 });
		const outcome mine = live_here(l, w);
		const ssize_t written = write(ends[1], &mine, sizeof mine);
		_exit(written != sizeof mine);
	}
	close(ends[1]);
	struct pollfd answer = { .fd = ends[0], .events = POLLIN };
	const bool ends_in_time = poll(&answer, 1, 1000 * WALL_S) == 1;
	outcome found;
	if (ends_in_time && read(ends[0], &found, sizeof found) == sizeof found)
		o = found;
	else
		snprintf(o.text, sizeof o.text, ends_in_time ? "the host died" : "hangs");
	if (!ends_in_time)
		kill(pid, SIGKILL);
	close(ends[0]);
	waitpid(pid, &status, 0);
	if (status && !o.broken) {
		o.failed = o.broken = true;
		snprintf(o.text, sizeof o.text, "the host ended with status %x", (unsigned)status);
	}
	return o;
}

bool outcomes_agree(way w, const outcome *a, const outcome *b)
{
	if (w == WAY_FREE && !a->failed && !a->objects)
		return !b->failed;
	if (a->broken || b->broken || a->failed != b->failed)
		return false;
	return a->failed ? strcmp(a->text, b->text) == 0 : a->hash == b->hash && a->objects == b->objects;
}
