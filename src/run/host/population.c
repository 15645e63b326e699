#include "host/population.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "exchange/results.h"
#include "free/free.h"
#include "host/request_log.h"
#include "host/joining.h"
#include "host/script_log.h"
#include "scene/object_limits.h"
#include "scene/random.h"
#include "shape/shape.h"
#include "step/publish.h"
#include "step/sim.h"

// An entry of the timetable.
typedef struct event {
	uint64_t step;
	uint32_t id;
	bool add; // else remove
} event;

// Reserved: the slot is empty, but the timetable has another event for it.
typedef enum slot_use { SLOT_FREE, SLOT_RESERVED, SLOT_PRESENT } slot_use; // saved as these numbers

typedef struct slot {
	uint32_t generation; // its latest object's
	unsigned char use; // slot_use
	bool removal_scheduled : 1; // the timetable will remove its object
	bool created : 1; // by a script
	bool driven : 1; // by its path or time-dependent force, those of the scene's object of this id
	bool kinematic : 1; // counted as kinematic, whatever its passport, which others can write, says now
	uint32_t born; // step
	uint32_t origin; // connection whose request has added it; 0: none
} slot;
static_assert(sizeof(slot) == 16, "all objects have one, and what is kept of it");

struct ob_population {
	ob_universe *u;
	ob_roster *roster;
	const ob_scene *scene;
	slot *slots; // [capacity]
	event *events; // the timetable: ascending by step; at one step removals first
	size_t event_count, next;
	uint32_t kinematic, pushed; // numbers of objects; pushed: with a time-dependent force
	uint64_t next_prescribed; // step of the next change of their prescribed motion
	bool changed;
	uint32_t first_free; // no slot below it is free
	uint32_t created; // existing objects that scripts have created
	ob_hulls hulls;
	ob_pulls pulls;
	ob_given_paths paths;
	uint64_t pulled; // step at whose beginning they have acted, and at whose end they will; 0: none
	ob_journal journal; // requests since the population was kept
	uint64_t reached; // steps that were complete before a restart
	ob_request_log *log; // NULL: none
	ob_kept_population *kept; // for a restart; NULL: none
};

struct ob_kept_population {
	slot *slots; // [capacity]
	size_t next;
	uint32_t first_free, created, kinematic, pushed, hulls;
	ob_pulls pulls;
	ob_given_paths paths;
	uint64_t pulled, roster; // roster: its number
};

// ---- checks

bool ob_population_find_look(const ob_population *p, ob_object_def *def, ob_error *e)
{
	uint32_t i = 0;
	def->passport.mesh = 0;
	if (!def->look)
		return true;
	while (i < p->scene->meshes && p->scene->mesh[i].key != def->look)
		i++;
	if (i == p->scene->meshes)
		return ob_fail(
			e, "mesh: expected one that an object of the scene has, with the same scale, rotation, place "
			   "and, if any, hull");
	def->passport.mesh = (uint8_t)(i + 1);
	return true;
}

// Checks references to hulls of the universe and meshes of the scene.
static bool check_parts(const ob_population *p, const ob_passport *pass, ob_error *e)
{
	const ob_hull *h = ob_hull_of(p->u, pass);
	if (pass->mesh > p->scene->meshes)
		return ob_fail(e, "object \"%s\": its mesh is not one of its scene", pass->name);
	if (ob_shape_is(pass->shape, OB_SURFACED) && !ob_terrain_of(p->u, pass))
		return ob_fail(e, "object \"%s\": it has no terrain of this universe", pass->name);
	if (!ob_shape_is(pass->shape, OB_HULLED) ||
	    (h && pass->size.x == h->radius && pass->size.y == .5 * h->thickness && pass->size.z == h->inner))
		return true;
	return ob_fail(e, "object \"%s\": it has no hull of this universe", pass->name);
}

// Principal moments (kg m^2); 0 where no force moves it.
static ob_vec3 inertia_of(const ob_population *p, const ob_passport *pass)
{
	if (pass->flags & OB_OBJECT_PRESCRIBED)
		return ob_v3(0, 0, 0);
	if (pass->inertia.x > 0) // as it was given
		return pass->inertia;
	return ob_shape_inertia((ob_shape)pass->shape, pass->size, ob_hull_of(p->u, pass), pass->mass);
}

// ---- changes

// Gives each object its own random numbers, also when it reuses a slot.
static void seed_random(const ob_population *p, uint32_t id, uint64_t random[4])
{
	ob_random r;
	ob_random_seed(&r, p->scene->seed ^ (((uint64_t)p->slots[id].generation << 32 | id) + 1) * 0x9e3779b97f4a7c15u);
	memcpy(random, r.s, sizeof r.s);
}

static void give_script(ob_population *p, uint32_t id, const ob_object_def *def, const unsigned char *state)
{
	uint64_t random[4];
	if (!def->script)
		return;
	seed_random(p, id, random);
	if (!ob_script_take_cell(p->u, id, def->script - 1, state, def->state_bytes, random))
		ob_log_warn("object \"%s\" has no script: no room for it", def->passport.name);
}

// state: the script's, def->state_bytes
static void add_object(ob_population *p, uint32_t id, const ob_object_def *def, const unsigned char *state,
		       uint32_t origin)
{
	ob_passport pass = def->passport;
	pass.id = id;
	pass.generation = ++p->slots[id].generation;
	pass.flags &= ~(uint32_t)OB_OBJECT_PRESENT;
	if (pass.flags & OB_OBJECT_PRESCRIBED)
		pass.mass = 0;
	pass.inertia = inertia_of(p, &pass);
	ob_write_passport(p->u, id, &pass);
	ob_sim_place(p->u, id, &def->state);
	pass.flags |= OB_OBJECT_PRESENT; // to readers once it has a motion
	ob_write_passport(p->u, id, &pass);
	if (ob_free_settings_of(p->u))
		ob_free_set_rate(p->u, id, def->update_rate);
	p->slots[id].use = SLOT_PRESENT;
	p->slots[id].created = false;
	p->slots[id].origin = origin;
	p->slots[id].kinematic = pass.flags & OB_OBJECT_KINEMATIC;
	p->kinematic += p->slots[id].kinematic;
	p->pushed += def->force != NULL;
	p->slots[id].driven = def->path || def->force;
	p->slots[id].born = (uint32_t)ob_step_count(p->u);
	p->changed = true;
	give_script(p, id, def, state);
}

// The path that the object follows, and the step at which it begins: one that a request has given, or the scene's.
static bool find_path(const ob_population *p, uint32_t id, ob_path *path, uint32_t *born)
{
	if (ob_given_paths_find(&p->paths, id, path, born))
		return true;
	*born = p->slots[id].born;
	if (!p->slots[id].driven || !p->scene->object[id].path)
		return false;
	*path = *p->scene->object[id].path;
	return true;
}

static const ob_force *force_of(const ob_population *p, uint32_t id)
{
	return p->slots[id].driven ? p->scene->object[id].force : NULL;
}

// Ends what the scene or a request has planned for the object's motion.
static void end_plan(ob_population *p, uint32_t id)
{
	ob_given_paths_drop(&p->paths, id);
	p->pushed -= force_of(p, id) != NULL;
	p->slots[id].driven = false;
}

static void remove_object(ob_population *p, uint32_t id)
{
	slot *s = &p->slots[id];
	if (s->use != SLOT_PRESENT)
		return;
	p->kinematic -= s->kinematic;
	s->kinematic = false;
	ob_script_free_cell(p->u, id);
	end_plan(p, id);
	ob_pulls_drop(&p->pulls, id);
	ob_sim_remove(p->u, id);
	ob_joints_remove_of(p->u, id);
	p->created -= s->created;
	s->created = false, s->origin = 0;
	p->first_free = id < p->first_free ? id : p->first_free;
	s->use = s->removal_scheduled ? SLOT_RESERVED
				      : SLOT_FREE; // else the timetable would remove the slot's next object
	p->changed = true;
}

static void remove_scheduled(ob_population *p, uint32_t id)
{
	p->slots[id].removal_scheduled = false;
	remove_object(p, id);
	p->slots[id].use = SLOT_FREE;
	p->first_free = id < p->first_free ? id : p->first_free;
}

// Adds an object in the lowest free slot, which it returns; UINT32_MAX: there is none, and a warning is logged.
static uint32_t add_on_request(ob_population *p, const ob_object_def *def, const unsigned char *state, uint32_t origin)
{
	const uint32_t capacity = ob_universe_capacity(p->u);
	uint32_t id = p->first_free;
	ob_error e;
	if (!check_parts(p, &def->passport, &e)) {
		ob_log_warn("%s", e.text);
		return UINT32_MAX;
	}
	while (id < capacity && p->slots[id].use != SLOT_FREE)
		id++;
	p->first_free = id;
	if (id == capacity) {
		ob_log_warn("object \"%s\" was not added: all %u slots are taken", def->passport.name, capacity);
		return UINT32_MAX;
	}
	if (!ob_universe_reserve(p->u, id + 1, &e)) {
		ob_log_warn("object \"%s\" was not added: %s", def->passport.name, e.text);
		return UINT32_MAX;
	}
	ob_object_def named = *def;
	char *name = named.passport.name;
	const size_t n = strnlen(name, OB_NAME_MAX);
	if (n > 0 && n < OB_NAME_MAX - 12 && name[n - 1] == '#') // a script's name: it does not know the id
		snprintf(name + n, OB_NAME_MAX - n, "%u", id);
	add_object(p, id, &named, state, origin);
	return id;
}

// ---- requests of scripts

// Builds the hull, if any. The rest of the post is its corners.
static bool take_hull(ob_population *p, ob_object_def *def, const ob_script_post *post, ob_error *e)
{
	const size_t before = sizeof *def + def->state_bytes, bytes = post->used - before;
	ob_hull_corners corners = { .count = (uint32_t)(bytes / sizeof *corners.at) };
	if (!ob_shape_is(def->passport.shape, OB_HULLED))
		return true;
	if (bytes > sizeof corners.at)
		return ob_fail(e, "hull: its corners make no sense");
	memcpy(corners.at, (const unsigned char *)(post + 1) + before, bytes);
	return ob_hulls_give(&p->hulls, &corners, &def->passport, e);
}

// Creates an object for a script. Data in the universe is not trusted.
static void create_for_script(ob_population *p, uint32_t cell, const ob_script_post *post)
{
	const ob_step_data *data = ob_universe_step_data(p->u);
	ob_object_def def;
	ob_error e;
	if (data->script_turn[cell].flags & OB_SCRIPT_STOPPED || post->used < sizeof def)
		return;
	memcpy(&def, post + 1, sizeof def);
	def.path = NULL, def.force = NULL; // only a scene has them
	if (post->used - sizeof def < def.state_bytes || def.script > data->script_text->scripts)
		return;
	if (!ob_population_find_look(p, &def, &e) || !take_hull(p, &def, post, &e) || !ob_object_check(&def, &e)) {
		ob_script_request_refuse(p->u, cell, post->line, e.text);
		return;
	}
	if (p->created >= p->scene->room) {
		char why[160];
		snprintf(why, sizeof why,
			 "%u objects that scripts have created exist, and the scene has no room for more: "
			 "remove some, or give it more with scene { room = ... }",
			 p->created);
		ob_script_request_refuse(p->u, cell, post->line, why);
		return;
	}
	const uint32_t id = add_on_request(p, &def, (const unsigned char *)(post + 1) + sizeof def, 0);
	if (id == UINT32_MAX)
		return;
	p->slots[id].created = true;
	p->created++;
}

// Adds or removes a joint for a script. An invalid one stops it.
static void join_for_script(ob_population *p, uint32_t cell, const ob_script_post *post)
{
	ob_error e;
	if (!(ob_universe_step_data(p->u)->script_turn[cell].flags & OB_SCRIPT_STOPPED) &&
	    !ob_joint_post_carry_out(p->u, post, &e))
		ob_script_request_refuse(p->u, cell, post->line, e.text);
}

// The requested state; "now" where a part is not set.
static ob_state complete_state(const ob_state *now, const ob_state *asked)
{
	ob_state s = *asked;
	s.pose.p = isnan(s.pose.p.x) ? now->pose.p : s.pose.p;
	s.pose.q = isnan(s.pose.q.w) ? now->pose.q : s.pose.q;
	s.v = isnan(s.v.x) ? now->v : s.v;
	s.w = isnan(s.w.x) ? now->w : s.w;
	return s;
}

// Any thread: the motion is copied as readers do.
static bool check_new_path(const ob_population *p, const ob_request *r, ob_error *e)
{
	const double h = ob_universe_settings(p->u)->step_length;
	ob_motion m;
	if (!ob_universe_get_motion(p->u, r->id, &m))
		return ob_fail(e, "the object has gone");
	const ob_state now = ob_state_now(p->u, r->id, &m, ob_step_count(p->u));
	return ob_given_path_check(&r->path, ob_passport_of(p->u, r->id), &now, h, e);
}

bool ob_population_check_change(const ob_population *p, const ob_request *r, ob_error *e)
{
	static const ob_state legal = { .pose.q.w = 1 };
	const ob_passport *pass = ob_passport_of(p->u, r->id);
	const ob_pull pull = ob_pull_of_request(r);
	const ob_state state = complete_state(&legal, &r->state);
	if (r->kind == OB_REQUEST_REMOVE || r->kind == OB_REQUEST_MESSAGE || r->kind == OB_REQUEST_COLOUR)
		return true;
	if (r->kind != OB_REQUEST_FORCE && ob_universe_settings(p->u)->monolith)
		return ob_fail(e, "the one ODE world keeps its bodies to itself: take object simulators");
	if (ob_is_pull_request(r))
		return ob_free_settings_of(p->u)
			       ? ob_fail(e, "in a free run nothing is pulled in each step: use --sync lockstep")
			       : ob_pull_check(&pull, pass, e);
	if (ob_is_joint_request(r))
		return ob_joint_request_check(p->u, r, e);
	if (r->kind == OB_REQUEST_PATH)
		return check_new_path(p, r, e);
	if (r->kind == OB_REQUEST_SURFACE)
		return ob_surface_velocity_check(pass, r->surface_velocity, e);
	if (r->kind == OB_REQUEST_FRICTION)
		return ob_friction_check(r->friction, e);
	if (r->kind == OB_REQUEST_STATE)
		return ob_state_check(pass, &state, e);
	if (pass->flags & OB_OBJECT_PRESCRIBED)
		return ob_fail(e, "object %u (%.*s) does not move by forces", r->id, OB_NAME_MAX, pass->name);
	return ob_push_check(pass, r->force, r->kind == OB_REQUEST_KICK ? r->twist : ob_v3(0, 0, 0), e);
}

// Carries out a request for an object that exists, and was valid when it came.
static void change_object(ob_population *p, const ob_request *r)
{
	const uint32_t id = r->id, step = (uint32_t)ob_step_count(p->u);
	const ob_state now = ob_state_now(p->u, id, ob_newest_motion(p->u, id), step),
		       state = complete_state(&now, &r->state);
	const ob_pull pull = ob_pull_of_request(r);
	ob_passport pass = *ob_passport_of(p->u, id);
	ob_error e;
	if (!ob_population_check_change(p, r, &e)) {
		ob_log_warn("a request was left out: %s", e.text);
		return;
	}
	if (r->kind == OB_REQUEST_FORCE || r->kind == OB_REQUEST_STATE || r->kind == OB_REQUEST_PATH)
		end_plan(p, id);
	if (r->kind == OB_REQUEST_REMOVE) {
		remove_object(p, id);
	} else if (r->kind == OB_REQUEST_MESSAGE) {
		if (!ob_script_deliver(p->u, id, r->values, r->bytes))
			ob_log_warn("object \"%.*s\" got no message: too many wait for it", OB_NAME_MAX, pass.name);
	} else if (r->kind == OB_REQUEST_COLOUR) {
		memcpy(pass.colour, r->colour, sizeof pass.colour);
		pass.flags &= ~(uint32_t)OB_OBJECT_MESH_COLOUR;
		ob_write_passport(p->u, id, &pass);
	} else if (ob_is_joint_request(r)) {
		ob_joint_request_carry_out(p->u, r);
	} else if (ob_is_pull_request(r)) {
		if (!ob_pulls_set(&p->pulls, &pull))
			ob_log_warn("object %u is not pulled: too many pulls act, or there is no memory", id);
	} else if (r->kind == OB_REQUEST_PATH) {
		if (!ob_given_paths_ask(&p->paths, id, step, &r->path, &now))
			ob_log_warn("object %u goes on as it was: too many paths, or there is no memory", id);
	} else if (r->kind == OB_REQUEST_FORCE) {
		ob_sim_push(p->u, id, r->force, true);
	} else if (r->kind == OB_REQUEST_KICK) {
		ob_sim_kick(p->u, id, r->force, r->twist);
	} else if (r->kind == OB_REQUEST_STATE) {
		ob_sim_place_anew(p->u, id, &state);
	} else { // contacts begin anew, so that those at rest on it are solved again
		pass.friction = r->kind == OB_REQUEST_FRICTION ? r->friction : pass.friction;
		pass.surface_velocity = r->kind == OB_REQUEST_SURFACE ? r->surface_velocity : pass.surface_velocity;
		ob_write_passport(p->u, id, &pass);
		ob_sim_place_anew(p->u, id, &now);
	}
}

// True if the object moves, or its surface runs, as requested: its contacts go on.
static bool is_as_requested(const ob_population *p, const ob_request *r)
{
	const ob_state now = ob_state_now(p->u, r->id, ob_newest_motion(p->u, r->id), ob_step_count(p->u)),
		       state = complete_state(&now, &r->state);
	ob_path path;
	uint32_t born;
	if (r->kind == OB_REQUEST_SURFACE)
		return ob_equal(ob_passport_of(p->u, r->id)->surface_velocity, r->surface_velocity);
	return r->kind == OB_REQUEST_STATE && !find_path(p, r->id, &path, &born) && ob_equal(state.v, now.v) &&
	       ob_equal(state.w, now.w);
}

// Steers an object for its script, as a request from outside does. An invalid request stops the script.
static void steer_for_script(ob_population *p, uint32_t cell, const ob_script_post *post)
{
	const uint32_t id = post->object;
	ob_request r;
	ob_error e;
	if (ob_universe_step_data(p->u)->script_turn[cell].flags & OB_SCRIPT_STOPPED ||
	    id >= ob_universe_capacity(p->u) || p->slots[id].generation != post->generation ||
	    p->slots[id].use != SLOT_PRESENT)
		return;
	bool valid = ob_script_request_read(post, &r) || ob_fail(&e, "the request makes no sense");
	valid = valid &&
		(r.kind != OB_REQUEST_STATE || p->slots[id].kinematic || ob_fail(&e, "expected a kinematic object"));
	if (!valid || !ob_population_check_change(p, &r, &e))
		ob_script_request_refuse(p->u, cell, post->line, e.text);
	else if (!is_as_requested(p, &r))
		change_object(p, &r);
}

static void carry_out_scripts(ob_population *p)
{
	const ob_step_data *data = ob_universe_step_data(p->u);
	ob_script_counts *count = data->script_counts;
	const uint32_t capacity = ob_universe_capacity(p->u);
	if (!count || !count->requests)
		return;
	count->requests = 0;
	for (uint32_t i = 0; i < count->due && i < data->script_cells; i++) {
		const uint32_t cell = data->script_due[i];
		if (cell >= data->script_cells || !data->script_turn[cell].script)
			continue;
		const ob_script_cell *c = &data->script_cell[cell];
		for (uint32_t at = 0; at + sizeof(ob_script_post) <= c->outbox_bytes;) {
			const ob_script_post *post = (const ob_script_post *)(const void *)(c->outbox + at);
			at += (uint32_t)sizeof *post + post->bytes;
			if (at > OB_SCRIPT_OUTBOX_BYTES || post->used > post->bytes)
				break;
			if (post->kind == OB_REQUEST_ADD)
				create_for_script(p, cell, post);
			else if (post->kind == OB_REQUEST_JOIN || post->kind == OB_REQUEST_UNJOIN)
				join_for_script(p, cell, post);
			else if (post->kind == OB_REQUEST_STATE || post->kind == OB_REQUEST_SURFACE ||
				 post->kind == OB_REQUEST_PATH)
				steer_for_script(p, cell, post);
			else if (post->kind == OB_REQUEST_REMOVE && post->object < capacity &&
				 p->slots[post->object].generation == post->generation)
				remove_object(p, post->object);
		}
	}
}

static void add_asked_for(ob_population *p, const ob_request *r)
{
	ob_error e;
	ob_object_def def = r->def;
	ob_passport *pass = &def.passport;
	if (ob_shape_is(pass->shape, OB_HULLED) && r->corners.count && !ob_hulls_give(&p->hulls, &r->corners, pass, &e))
		ob_log_warn("object \"%s\" was not added: %s", pass->name, e.text);
	else
		add_on_request(p, &def, NULL, r->origin);
}

bool ob_population_check_avatar(const ob_population *p, const ob_request *r, ob_object_def *def, ob_error *e)
{
	if (!p->scene->avatar)
		return ob_fail(e, "the scene has no object with avatar = true");
	*def = *p->scene->avatar;
	def->state.pose.p = r->state.pose.p;
	const size_t n = strnlen(def->passport.name, OB_NAME_MAX - 12);
	snprintf(def->passport.name + n, OB_NAME_MAX - n, " %u", r->origin);
	return ob_object_def_check(def, e);
}

static void add_avatar(ob_population *p, const ob_request *r)
{
	ob_error e;
	ob_object_def def = { 0 };
	if (!ob_population_check_avatar(p, r, &def, &e)) {
		ob_log_warn("no avatar was added: %s", e.text);
		return;
	}
	add_on_request(p, &def, p->scene->states + def.state_at, r->origin);
}

static void publish_roster(ob_population *p)
{
	bool one_per_object = ob_universe_settings(p->u)->one_per_object;
	uint32_t n = 0, ids = ob_universe_capacity(p->u);
	ob_roster_entry *entries = malloc(ids * sizeof *entries);
	for (uint32_t id = 0; entries && id < ids; id++) {
		if (p->slots[id].use != SLOT_PRESENT)
			continue;
		const ob_passport *pass = ob_passport_of(p->u, id);
		ob_roster_entry *entry = &entries[n++];
		entry->id = id;
		entry->generation = pass->generation;
		entry->origin = p->slots[id].origin;
		const ob_script_turn *turn = ob_script_turn_of(p->u, id);
		entry->script = turn ? (uint8_t)turn->script : 0;
		entry->own_worker = one_per_object;
		memcpy(entry->name, pass->name, sizeof entry->name);
	}
	if (!entries || !ob_roster_publish(p->roster, entries, n))
		ob_log_warn("out of memory: the roster of objects is out of date");
	free(entries);
	p->changed = false;
}

// Sets forces that change in time, for the coming step.
static void push_all(ob_population *p)
{
	const double h = ob_universe_settings(p->u)->step_length;
	uint32_t left = p->pushed;
	for (uint32_t id = 0; left > 0; id++) {
		const slot *s = &p->slots[id];
		const ob_force *force = force_of(p, id);
		if (s->use != SLOT_PRESENT || !force)
			continue;
		const uint64_t since = ob_step_count(p->u) - s->born, next = ob_force_next(force, h, since);
		const ob_vec3 now = ob_force_mean(force, h, since),
			      before = since ? ob_force_mean(force, h, since - 1) : ob_v3(0, 0, 0);
		ob_sim_push(p->u, id, ob_add(p->scene->object[id].passport.force, now),
			    ob_norm2(ob_sub(now, before)) > 0);
		if (next != UINT64_MAX && s->born + next < p->next_prescribed)
			p->next_prescribed = s->born + next;
		left--;
	}
}

// Sets the prescribed motion of kinematic objects from this step on.
static void prescribe_all(ob_population *p)
{
	uint32_t left = p->kinematic;
	p->next_prescribed = UINT64_MAX;
	for (uint32_t id = 0; left > 0; id++) {
		if (!p->slots[id].kinematic)
			continue;
		ob_path path;
		uint32_t born;
		const bool follows = find_path(p, id, &path, &born);
		const uint64_t next = ob_sim_prescribe(p->u, id, follows ? &path : NULL, born);
		p->next_prescribed = next < p->next_prescribed ? next : p->next_prescribed;
		left--;
	}
	push_all(p);
}

static void carry_out_request(ob_population *p, const ob_request *r)
{
	if (r->kind == OB_REQUEST_ADD)
		add_asked_for(p, r);
	else if (r->kind == OB_REQUEST_AVATAR)
		add_avatar(p, r);
	else if (r->kind == OB_REQUEST_RELEASE)
		ob_pulls_release(&p->pulls, r->id, r->origin);
	else if (r->id < ob_universe_capacity(p->u) && p->slots[r->id].generation == r->generation &&
		 p->slots[r->id].use == SLOT_PRESENT)
		change_object(p, r);
}

// Carries out requests. After a restart, first those that were carried out before, in the same places; new ones wait until
// the run is again where it was, as viewers have seen its states.
static void carry_out_requests(ob_population *p, ob_requests *q)
{
	const ob_journal_place at = ob_journal_here(p->u);
	const ob_request *again;
	ob_request r;
	while ((again = ob_journal_again(&p->journal, &at)))
		carry_out_request(p, again);
	if (ob_population_is_behind(p) || !ob_requests_waiting(q))
		return;
	while (ob_requests_take(q, &r)) {
		if (p->kept)
			ob_journal_note(&p->journal, &at, &r);
		ob_request_log_request(p->log, &at, &r);
		carry_out_request(p, &r);
	}
	ob_request_log_flush(p->log);
}

void ob_population_pull(ob_population *p)
{
	const uint64_t step = ob_step_count(p->u);
	if (p->pulls.count == 0 || p->pulled == step + 1)
		return;
	p->pulled = step + 1;
	ob_pulls_act(&p->pulls, p->u);
}

// Adds the impulses of pulls at the end of the step.
static void end_pull(ob_population *p, uint64_t step)
{
	if (p->pulled == 0 || p->pulled > step)
		return;
	p->pulled = 0;
	ob_pulls_act(&p->pulls, p->u);
}

bool ob_population_update(ob_population *p, uint64_t step, ob_requests *q)
{
	end_pull(p, step);
	for (; p->next < p->event_count && p->events[p->next].step <= step; p->next++) {
		event *due = &p->events[p->next];
		const ob_object_def *def = &p->scene->object[due->id];
		if (due->add)
			add_object(p, due->id, def, def->state_bytes ? p->scene->states + def->state_at : NULL, 0);
		else
			remove_scheduled(p, due->id);
	}
	carry_out_scripts(p);
	carry_out_requests(p, q);
	bool changed = p->changed;
	prescribe_all(p);
	if (changed)
		publish_roster(p);
	return changed;
}

bool ob_population_replay(ob_population *p, const ob_journal_entry *entry, size_t count)
{
	return ob_journal_load(&p->journal, entry, count);
}

void ob_population_set_log(ob_population *p, ob_request_log *log)
{
	p->log = log;
}

bool ob_population_is_checkpoint_due(const ob_population *p)
{
	return ob_journal_is_full(&p->journal);
}

void ob_kept_population_free(ob_kept_population *k)
{
	if (k) {
		free(k->slots);
		ob_pulls_finish(&k->pulls);
		ob_given_paths_finish(&k->paths);
	}
	free(k);
}

ob_kept_population *ob_population_copy(const ob_population *p, ob_kept_population *k)
{
	const size_t bytes = ob_universe_capacity(p->u) * sizeof *p->slots;
	if (!k)
		k = calloc(1, sizeof *k);
	if (k && !k->slots)
		k->slots = malloc(bytes);
	if (!k || !k->slots || !ob_pulls_copy(&k->pulls, &p->pulls) || !ob_given_paths_copy(&k->paths, &p->paths)) {
		ob_kept_population_free(k);
		return NULL;
	}
	k->pulled = p->pulled;
	memcpy(k->slots, p->slots, bytes);
	k->next = p->next;
	k->first_free = p->first_free;
	k->created = p->created;
	k->kinematic = p->kinematic;
	k->pushed = p->pushed;
	k->hulls = p->hulls.count;
	k->roster = p->changed ? 0 : ob_roster_number(p->roster);
	return k;
}

bool ob_population_keep(ob_population *p)
{
	p->kept = ob_population_copy(p, p->kept);
	if (!p->kept)
		return false;
	ob_journal_clear(&p->journal);
	return true;
}

static void put_back(ob_population *p, const ob_kept_population *k)
{
	memcpy(p->slots, k->slots, ob_universe_capacity(p->u) * sizeof *p->slots);
	p->next = k->next;
	p->first_free = k->first_free;
	p->created = k->created;
	p->kinematic = k->kinematic;
	p->pushed = k->pushed;
	p->hulls.count = k->hulls; // hulls added later come again, unchanged
	p->pulled = k->pulled;
	if (!ob_pulls_copy(&p->pulls, &k->pulls))
		ob_log_warn("out of memory: objects are no longer pulled as they were");
	if (!ob_given_paths_copy(&p->paths, &k->paths))
		ob_log_warn("out of memory: objects no longer follow the paths that they were given");
	if (p->changed || k->roster != ob_roster_number(p->roster))
		publish_roster(p);
}

void ob_population_put_back(ob_population *p, uint64_t reached)
{
	p->reached = reached > p->reached ? reached : p->reached;
	if (!p->kept)
		return;
	ob_journal_rewind(&p->journal);
	put_back(p, p->kept);
}

bool ob_population_is_behind(const ob_population *p)
{
	return ob_journal_next(&p->journal).step < UINT64_MAX || ob_step_count(p->u) < p->reached;
}

void ob_population_restore(ob_population *p, const ob_kept_population *k)
{
	p->reached = 0;
	ob_journal_finish(&p->journal), p->journal = (ob_journal){ 0 };
	ob_pulls_set_aside(&p->pulls);
	put_back(p, k);
	ob_pulls_take_up(&p->pulls, p->u);
}

bool ob_population_is_due_after_scripts(const ob_population *p)
{
	return ob_journal_is_after_scripts(ob_journal_next(&p->journal), ob_journal_here(p->u));
}

uint64_t ob_population_next_step(const ob_population *p)
{
	const uint64_t timetable = p->next < p->event_count ? p->events[p->next].step : UINT64_MAX,
		       again = ob_population_is_due_after_scripts(p) ? UINT64_MAX : ob_journal_next(&p->journal).step,
		       first = timetable < p->next_prescribed ? timetable : p->next_prescribed;
	// requests may wait for it
	const uint64_t reached = p->reached > ob_step_count(p->u) ? p->reached : UINT64_MAX,
		       then = again < reached ? again : reached;
	const uint64_t pull = p->pulls.count ? ob_step_count(p->u) + 1 : UINT64_MAX, soon = first < then ? first : then;
	return pull < soon ? pull : soon;
}

// ---- saved

// True of the scene's object, the first in its slot, if it has a path or a time-dependent force.
static bool has_plan(const ob_population *p, uint32_t id)
{
	return id < p->scene->objects && p->slots[id].generation == 1 &&
	       (p->scene->object[id].path || p->scene->object[id].force);
}

void ob_population_count_saved(const ob_population *p, ob_saved_population *out)
{
	const uint32_t ids = ob_universe_ids(p->u);
	uint32_t count = ob_universe_capacity(p->u);
	// Slots that were used before the run was resumed count, too: their next objects are of later generations.
	while (count > ids && count > p->scene->objects && !p->slots[count - 1].generation)
		count--;
	*out = (ob_saved_population){
		.events = p->next,
		.count = count,
		.hulls = p->hulls.count - p->hulls.of_scene,
		.pulls = p->pulls.count,
		.paths = p->paths.count,
		.points = p->paths.points,
	};
}

void ob_population_save(const ob_population *p, ob_saved_population *out)
{
	for (uint32_t id = 0; id < out->count; id++) {
		const slot *s = &p->slots[id];
		out->slot[id] = (ob_saved_slot){ .generation = s->generation,
						 .use = s->use,
						 .removal_scheduled = s->removal_scheduled,
						 .created = s->created,
						 .unplanned = s->use == SLOT_PRESENT && has_plan(p, id) && !s->driven,
						 .origin = s->origin < OB_ORIGIN_PROGRAM ? s->origin : 0 };
	}
	if (out->hulls)
		memcpy(out->hull, p->hulls.corners, out->hulls * sizeof *out->hull);
	if (out->pulls)
		memcpy(out->pull, p->pulls.at, out->pulls * sizeof *out->pull);
	if (out->paths)
		memcpy(out->path, p->paths.at, out->paths * sizeof *out->path);
	if (out->points)
		memcpy(out->point, p->paths.point, out->points * sizeof *out->point);
}

// Applies the first events of the timetable to the slots, which are as planned at the start.
static void follow_timetable(ob_population *p, uint64_t events)
{
	for (uint64_t i = 0; i < events; i++) {
		slot *s = &p->slots[p->events[i].id];
		s->use = p->events[i].add ? SLOT_PRESENT : SLOT_FREE;
		s->removal_scheduled &= p->events[i].add;
	}
}

// True if a slot that the timetable has left so may have been saved so. Scripts and requests may have removed its
// object, and have added another in a free slot. An event finds the object that it was planned for.
static bool follows(const slot *planned, const ob_saved_slot *s)
{
	if (s->removal_scheduled != planned->removal_scheduled)
		return false;
	if (planned->use == SLOT_RESERVED)
		return s->use == SLOT_RESERVED && s->generation == 0;
	return s->use == SLOT_PRESENT || s->use == (planned->removal_scheduled ? SLOT_RESERVED : SLOT_FREE);
}

static bool check_slot(const ob_population *p, uint32_t id, const ob_saved_slot *s)
{
	const ob_passport *pass = ob_passport_of(p->u, id);
	const bool present = id < ob_universe_ids(p->u) && pass->flags & OB_OBJECT_PRESENT;
	return follows(&p->slots[id], s) && s->created <= present && s->unplanned <= present &&
	       (present || !s->origin) && s->origin < OB_ORIGIN_PROGRAM && present == (s->use == SLOT_PRESENT) &&
	       (!present || pass->generation == s->generation);
}

static bool is_near(double a, double b)
{
	return fabs(a - b) <= 1e-9 * fabs(b);
}

// A saved object is checked as a new one is, but for where it has come to.
static bool check_object(const ob_population *p, uint32_t id, ob_error *e)
{
	const ob_passport *pass = ob_passport_of(p->u, id);
	const ob_motion *m = ob_newest_motion(p->u, id);
	if (!ob_object_check_saved(pass, e) || !check_parts(p, pass, e))
		return false;
	const ob_vec3 inertia = inertia_of(p, pass);
	if (!is_near(pass->inertia.x, inertia.x) || !is_near(pass->inertia.y, inertia.y) ||
	    !is_near(pass->inertia.z, inertia.z))
		return ob_fail(e, "object \"%s\": its inertia is not that of its shape", pass->name);
	return ob_state_is_sane(&(ob_state){ { m->p, m->q }, m->v, m->w }) ||
	       ob_fail(e, "object \"%s\": its motion makes no sense", pass->name);
}

// Checks saved objects, with their parts.
static bool check_objects(const ob_population *p, ob_error *e)
{
	for (uint32_t id = 0; id < ob_universe_ids(p->u); id++)
		if (ob_passport_of(p->u, id)->flags & OB_OBJECT_PRESENT && !check_object(p, id, e))
			return false;
	return true;
}

// First step boundary at or after t (s), except for round-off.
static uint64_t step_at(double t, double step_length)
{
	double k = ceil(t / step_length - 1e-6);
	return k <= 0 ? 0 : k < 1e18 ? (uint64_t)k : UINT64_MAX;
}

// Restores the path of an object. Only the scene's objects have one, each the first in its slot.
static void load_path(ob_population *p, uint32_t id, bool unplanned)
{
	const double h = ob_universe_settings(p->u)->step_length;
	slot *s = &p->slots[id];
	if (id >= p->scene->objects || s->generation != 1)
		return;
	const ob_object_def *def = &p->scene->object[id];
	s->driven = s->use == SLOT_PRESENT && (def->path || def->force) && !unplanned;
	p->pushed += force_of(p, id) != NULL;
	s->born = (uint32_t)step_at(p->scene->object[id].born, h);
}

static bool load_pulls(ob_population *p, const ob_saved_population *s, ob_error *e)
{
	for (uint32_t i = 0; i < s->pulls; i++) {
		const ob_pull *pull = &s->pull[i];
		const bool exists = pull->id < s->count && p->slots[pull->id].use == SLOT_PRESENT &&
				    p->slots[pull->id].generation == pull->generation;
		if (!exists || pull->kind > OB_PULL_DRAG)
			return ob_fail(e, "pull %u makes no sense", i);
		if (!(ob_passport_of(p->u, pull->id)->flags & OB_OBJECT_PRESCRIBED) && // else frozen
		    !ob_pull_check(pull, ob_passport_of(p->u, pull->id), e))
			return false;
		if (!ob_pulls_set(&p->pulls, pull))
			return ob_fail(e, "out of memory");
	}
	return true;
}

bool ob_population_load(ob_population *p, const ob_saved_population *s, ob_error *e)
{
	const double step_length = ob_universe_settings(p->u)->step_length;
	if (s->count > ob_universe_capacity(p->u) || s->count < p->scene->objects || s->events > p->event_count)
		return ob_fail(e, "its objects are not those of its scene");
	if (!ob_hulls_load(&p->hulls, s->hull, s->hulls, e) || !check_objects(p, e))
		return false;
	follow_timetable(p, s->events);
	for (uint32_t id = 0; id < s->count; id++) {
		const ob_saved_slot *from = &s->slot[id];
		if (!check_slot(p, id, from))
			return ob_fail(e, "slot %u makes no sense", id);
		p->slots[id] = (slot){ .generation = from->generation,
				       .use = from->use,
				       .removal_scheduled = from->removal_scheduled,
				       .created = from->created,
				       .origin = from->origin };
		p->created += from->created;
		load_path(p, id, from->unplanned);
		p->slots[id].kinematic =
			from->use == SLOT_PRESENT && ob_passport_of(p->u, id)->flags & OB_OBJECT_KINEMATIC;
		p->kinematic += p->slots[id].kinematic;
	}
	p->next = s->events;
	publish_roster(p);
	for (uint32_t i = 0; i < s->paths; i++)
		if (s->path[i].id >= s->count || !p->slots[s->path[i].id].kinematic)
			return ob_fail(e, "path %u makes no sense", i);
	const ob_given_paths paths = { .at = s->path, .count = s->paths, .point = s->point, .points = s->points };
	return load_pulls(p, s, e) && ob_given_paths_check(&paths, ob_step_count(p->u), step_length, e) &&
	       (ob_given_paths_copy(&p->paths, &paths) || ob_fail(e, "out of memory"));
}

// ---- the scene's timetable

static int by_step(const void *pa, const void *pb)
{
	const event *a = pa, *b = pb;
	if (a->step != b->step)
		return a->step < b->step ? -1 : 1;
	if (a->add != b->add)
		return a->add - b->add;
	return (a->id > b->id) - (a->id < b->id);
}

static void plan_object(ob_population *p, uint32_t id, double step_length)
{
	const ob_object_def *def = &p->scene->object[id];
	uint64_t born = step_at(def->born, step_length), dies = step_at(def->dies, step_length);
	if (born >= dies)
		return;
	p->slots[id] = (slot){ .use = SLOT_RESERVED, .removal_scheduled = dies < UINT64_MAX };
	p->events[p->event_count++] = (event){ .step = born, .id = id, .add = true };
	if (dies < UINT64_MAX)
		p->events[p->event_count++] = (event){ .step = dies, .id = id };
}

ob_population *ob_population_create(const ob_scene *scene, ob_universe *u, ob_roster *r, ob_error *e)
{
	double step_length = ob_universe_settings(u)->step_length;
	ob_population *p = calloc(1, sizeof *p);
	if (!p) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	p->u = u;
	p->roster = r;
	p->scene = scene;
	p->next_prescribed = UINT64_MAX;
	p->slots = calloc(ob_universe_capacity(u), sizeof *p->slots);
	p->events = calloc(2 * (size_t)scene->objects + 1, sizeof *p->events);
	bool ready = p->slots && p->events ? ob_hulls_init(&p->hulls, scene, u, e) : ob_fail(e, "out of memory");
	if (!ready) {
		ob_population_destroy(p);
		return NULL;
	}
	for (uint32_t i = 0; i < scene->objects; i++)
		plan_object(p, i, step_length);
	qsort(p->events, p->event_count, sizeof *p->events, by_step);
	return p;
}

void ob_population_destroy(ob_population *p)
{
	if (!p)
		return;
	free(p->events);
	free(p->slots);
	ob_hulls_finish(&p->hulls);
	ob_pulls_finish(&p->pulls);
	ob_given_paths_finish(&p->paths);
	ob_kept_population_free(p->kept);
	ob_journal_finish(&p->journal);
	free(p);
}
