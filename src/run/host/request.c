// Requests of any thread to a run.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <urcu/wfcqueue.h>

#include "base/number.h"
#include "free/free.h"
#include "host/host_state.h"
#include "host/pace.h"
#include "host/rcu_tsan.h"
#include "host/request_table.h"
#include "scene/object_limits.h"
#include "shape/shape.h"
#include "table/home.h"

static bool is_colour(const float *c)
{
	for (int i = 0; i < 4; i++)
		if (!(c[i] >= 0 && c[i] <= 1))
			return false;
	return c[3] == 1;
}

static bool check_new(const ob_host *h, ob_request *r, ob_error *e)
{
	const ob_shape shape = (ob_shape)r->def.passport.shape;
	ob_hull hull;
	if (!ob_shape_is_bounded(shape) || r->def.script || r->def.state_bytes)
		return ob_fail(e, "only objects with a size and without a script can be created by requests");
	if (!ob_population_find_look(h->population, &r->def, e))
		return false;
	if (!ob_shape_is(shape, OB_HULLED))
		return true;
	if (ob_universe_hulls(h->u) == 0)
		return ob_fail(e, "the one ODE world has no hulls");
	if (r->corners.count > OB_HULL_CORNERS_MAX)
		return ob_fail(e, "a hull has at most %d corners", OB_HULL_CORNERS_MAX);
	if (!ob_hull_build(r->corners.at, r->corners.count, &hull, e))
		return false;
	r->def.passport.size = ob_hull_size(&hull);
	return true;
}

// Reads the passport of the request's object. false and e: it has gone.
static bool find_object(const ob_host *h, const ob_request *r, ob_passport *p, ob_error *e)
{
	return (ob_universe_get_passport(h->u, r->id, p) && p->generation == r->generation) ||
	       ob_fail(e, "the object has gone");
}

// Checks the target of a move: the worker numbers that a pool has for its number of objects.
static bool check_move(const ob_host *h, ob_request *r, ob_error *e)
{
	const ob_universe *u = h->u;
	ob_passport p;
	const uint32_t simulators = ob_universe_simulators(u), ids = ob_universe_ids(u),
		       workers = simulators < ids ? simulators : ids;
	if (!find_object(h, r, &p, e))
		return false;
	if (ob_universe_settings(u)->monolith)
		return ob_fail(e, "in the one ODE world no object has a simulator");
	if (ob_universe_settings(u)->one_per_object)
		return ob_fail(e, "each object has a worker of its own, and cannot move");
	if (p.flags & (OB_OBJECT_STATIC | OB_OBJECT_KINEMATIC | OB_OBJECT_FROZEN))
		return ob_fail(e, "object %u (%.*s) does not move by forces, and has no simulator", r->id, OB_NAME_MAX,
			       p.name);
	return r->worker < workers ||
	       ob_fail(e, "there is no worker %u for objects: they are 0 to %u", r->worker, workers - 1);
}

static bool check_return(const ob_host *h, ob_request *r, ob_error *e)
{
	if (!h->returns)
		return ob_fail(e, "this run cannot be put back on request: obsim serve can, without --record, and a "
				  "program that leads one by obsim control");
	if (h->log)
		return ob_fail(e, "this run logs its requests (--log-requests), so it cannot be put back");
	if (ob_free_settings_of(h->u))
		return ob_fail(e, "a free run cannot be put back: use --sync lockstep");
	return !ob_universe_settings(h->u)->monolith ||
	       ob_fail(e, "the one ODE world cannot be put back, as ODE does not show its whole state");
}

// Checks "name=value" of a parameter that has limits.
static bool check_parameter(const ob_scene *s, const char *text, ob_error *e)
{
	const size_t name = strcspn(text, "=");
	char *end;
	const double value = text[name] ? strtod(text + name + 1, &end) : NAN;
	for (uint32_t i = 0; i < s->params; i++) {
		const ob_param_def *p = &s->param[i];
		if (strlen(p->name) != name || memcmp(p->name, text, name) != 0)
			continue;
		if (text[name] && !*end && value >= p->min && value <= p->max && (!p->whole || value == floor(value)))
			return true;
		return ob_fail(e, "%s: expected a %snumber from %.10g to %.10g, got %s", p->name,
			       p->whole ? "whole " : "", p->min, p->max, text + name + (text[name] != 0));
	}
	return ob_fail(e, "%.*s: the scene has no parameter of this name within limits", (int)name, text);
}

static bool check_save(const ob_host *h, const char *path, ob_error *e)
{
	if (ob_universe_settings(h->u)->monolith || ob_free_settings_of(h->u))
		return ob_fail(e, "only object simulators in lockstep can be saved");
	return *path == '/' || (!*path && h->checkpoint) ||
	       ob_fail(e, *path ? "save: expected a path from the root on"
				: "the server has no place for a checkpoint: start it with --checkpoint FILE");
}

// Checks a wish to the leader of the run.
static bool check_wish(const ob_host *h, ob_request *r, ob_error *e)
{
	const char *text = (const char *)r->values;
	r->values[sizeof r->values - 1] = 0;
	if (!h->takes_wishes)
		return ob_fail(e,
			       "this run does not take this request: obsim serve does; a program that leads a run by "
			       "obsim control has reset and save");
	if (r->kind == OB_REQUEST_SAVE)
		return check_save(h, text, e);
	if (h->fixed)
		return ob_fail(e, "the scene cannot start anew: %s", h->fixed);
	return r->kind == OB_REQUEST_SEED || check_parameter(h->scene, text, e);
}

// Checks a request about time.
static bool check_time(const ob_host *h, ob_request *r, ob_error *e)
{
	const double now = (double)ob_step_count(h->u) * ob_universe_settings(h->u)->step_length;
	if (!h->pace)
		return ob_fail(e, "the clock of this run is not to be led: obsim serve takes such requests");
	if (r->kind == OB_REQUEST_UNTIL && !(r->until > now && isfinite(r->until)))
		return ob_fail(e, "until: expected a time after %s s, got %s", ob_number_text(now).text,
			       ob_number_text(r->until).text);
	if (r->kind == OB_REQUEST_UNTIL && ob_free_settings_of(h->u))
		return ob_fail(e, "until: only simulators in lockstep stand at a time");
	if (r->kind == OB_REQUEST_STEP && !ob_pace_get(h->pace).paused)
		return ob_fail(e, "step: time goes on by itself: pause it first");
	return ob_request_check_bounds(r, ob_request_row_of(r->kind), e);
}

static bool check_kill(const ob_host *h, ob_request *r, ob_error *e)
{
	uint32_t worker;
	ob_passport p;
	if (!find_object(h, r, &p, e))
		return false;
	if (!h->spawn->own_memory)
		return ob_fail(
			e, "simulators are threads of one process, which cannot be killed alone: start the run with "
			   "--isolation process");
	if (ob_universe_settings(h->u)->monolith)
		return ob_fail(e, "the one ODE world is one simulator, without which the run ends");
	return ob_universe_get_home(h->u, r->id, &worker) ||
	       ob_fail(e, "object %u (%.*s) has no simulator: no force moves it, or it was not solved yet", r->id,
		       OB_NAME_MAX, p.name);
}

static bool check_change(const ob_host *h, ob_request *r, ob_error *e)
{
	ob_passport p;
	if (!find_object(h, r, &p, e))
		return false;
	if (r->kind == OB_REQUEST_COLOUR && !is_colour(r->colour))
		return ob_fail(e, "a colour has parts from 0 to 1, and is opaque: alpha is 1");
	if (r->kind == OB_REQUEST_MESSAGE && (r->bytes > sizeof r->values || !ob_script_turn_of(h->u, r->id)))
		return ob_fail(e, "object %u (%.*s) has no script to send a message to", r->id, OB_NAME_MAX, p.name);
	return ob_population_check_change(h->population, r, e);
}

static bool check_avatar(const ob_host *h, ob_request *r, ob_error *e)
{
	return ob_population_check_avatar(h->population, r, &(ob_object_def){ 0 }, e);
}

// ---- where they are carried out

bool ob_host_request(ob_host *h, const ob_request *r, ob_error *e)
{
	if (r->kind == OB_REQUEST_ADD && !ob_object_check(&r->def, e))
		return false;
	if (!ob_requests_push(h->requests, r))
		return ob_fail(e, "out of memory");
	ob_host_pause_early(h);
	return true;
}

static bool operate(ob_host *h, const ob_request *r, ob_error *e)
{
	return ob_requests_push(h->operations, r) || ob_fail(e, "out of memory");
}

static bool wish(ob_host *h, const ob_request *r, ob_error *e)
{
	return ob_requests_push(h->wishes, r) || ob_fail(e, "out of memory");
}

static bool move(ob_host *h, const ob_request *r, ob_error *e)
{
	return ob_move_ask(h->u, r->id, r->worker) ||
	       ob_fail(e, "an earlier move takes effect at the next step: send this one again");
}

static bool kill_simulator(ob_host *h, const ob_request *r, ob_error *e)
{
	uint32_t worker;
	return (ob_universe_get_home(h->u, r->id, &worker) && h->spawn->kill(h->group, worker)) ||
	       ob_fail(e, "the simulator of object %u has gone", r->id);
}

// The run is not paused for it: its leader waits for the pace.
static bool lead_time(ob_host *h, const ob_request *r, ob_error *e)
{
	const double length = ob_universe_settings(h->u)->step_length;
	if (r->kind == OB_REQUEST_STEP)
		ob_pace_allow(h->pace, r->steps);
	else if (r->kind == OB_REQUEST_UNTIL)
		ob_pace_run_until(h->pace, (uint64_t)fmin(ceil(r->until / length - 1e-6), 1e18));
	else if (r->kind == OB_REQUEST_RATE)
		ob_pace_set_rate(h->pace, r->rate > 0 ? r->rate : OB_PACE_MAX);
	else
		ob_pace_set_paused(h->pace, r->kind == OB_REQUEST_PAUSE);
	return true;
}

// Check and deed of a kind. Others change an object: the population carries them out.
static const struct deed {
	bool (*check)(const ob_host *h, ob_request *r, ob_error *e); // NULL: always valid
	bool (*carry_out)(ob_host *h, const ob_request *r, ob_error *e);
} deeds[OB_REQUEST_KINDS] = {
	[OB_REQUEST_ADD] = { check_new, ob_host_request },
	[OB_REQUEST_AVATAR] = { check_avatar, ob_host_request },
	[OB_REQUEST_RELEASE] = { NULL, ob_host_request },
	[OB_REQUEST_MOVE] = { check_move, move },
	[OB_REQUEST_KILL] = { check_kill, kill_simulator },
	[OB_REQUEST_KEEP] = { check_return, operate },
	[OB_REQUEST_RETURN] = { check_return, operate },
	[OB_REQUEST_RESTART] = { check_return, operate },
	[OB_REQUEST_SET] = { check_wish, wish },
	[OB_REQUEST_SEED] = { check_wish, wish },
	[OB_REQUEST_SAVE] = { check_wish, wish },
	[OB_REQUEST_PAUSE] = { check_time, lead_time },
	[OB_REQUEST_RESUME] = { check_time, lead_time },
	[OB_REQUEST_STEP] = { check_time, lead_time },
	[OB_REQUEST_UNTIL] = { check_time, lead_time },
	[OB_REQUEST_RATE] = { check_time, lead_time },
};

static struct deed deed_of(const ob_request *r)
{
	return deeds[r->kind].carry_out ? deeds[r->kind] : (struct deed){ check_change, ob_host_request };
}

bool ob_request_check(const ob_host *h, ob_request *r, ob_error *e)
{
	if (r->kind >= OB_REQUEST_KINDS)
		return ob_fail(e, "unknown request");
	if (r->kind != OB_REQUEST_MOVE && ob_universe_ranks(h->u) > 1)
		return ob_fail(e, "on several ranks, objects can only be moved");
	const struct deed deed = deed_of(r);
	return !deed.check || deed.check(h, r, e);
}

bool ob_host_ask(ob_host *h, ob_request *r, ob_error *e)
{
	return ob_request_check(h, r, e) && deed_of(r).carry_out(h, r, e);
}

bool ob_host_ask_as(ob_host *h, ob_role role, ob_request *r, ob_error *e)
{
	ob_roster_entry entry;
	const ob_request_row *row = ob_request_row_of(r->kind);
	ob_role needed = row ? (ob_role)row->role : OB_ROLE_OPERATE;
	const bool found = ob_roster_find(h->roster, r->id, &entry), own = found && entry.origin == r->origin;
	// a visitor who takes part may remove an object that it has created
	if (r->kind == OB_REQUEST_REMOVE && own && entry.generation == r->generation)
		needed = OB_ROLE_TAKE_PART;
	else if (r->kind != OB_REQUEST_ADD && r->kind != OB_REQUEST_RELEASE && found && ob_is_avatar(&entry) && !own)
		needed = OB_ROLE_OPERATE;
	return ob_role_check(role, needed, e) && ob_host_ask(h, r, e);
}

bool ob_host_request_remove(ob_host *h, uint32_t id, uint32_t generation)
{
	ob_error e;
	return ob_host_request(h, &(ob_request){ .kind = OB_REQUEST_REMOVE, .id = id, .generation = generation }, &e);
}
