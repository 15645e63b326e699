#include "deeds.h"

#include <stdio.h>
#include <string.h>

#include "base/random.h"
#include "host/joining.h"
#include "serve/command.h"
#include "shape/shape.h"
#include "table/home.h"
#include "things.h"

// Fields of a command, drawn for any kind that may have them.
static void put_object_fields(writer *w)
{
	static const char *const shapes[] = { "sphere", "box", "capsule", "cylinder" };
	const unsigned shape = (unsigned)(ob_splitmix(&w->seed) % 4);
	put(w, ",\"shape\":\"%s\",\"size\":[%.3f,%.3f,%.3f],\"at\":[%.3f,%.3f,%.3f],\"mass\":%.3f", shapes[shape],
	    within(w, .03, .3), shape ? within(w, .03, .3) : 0, shape == 1 ? within(w, .03, .3) : 0, within(w, -1, 2),
	    within(w, -1, 2), within(w, .1, 3), within(w, .01, 100));
	if (one_in(w, 2))
		put(w, ",\"velocity\":[%.3f,%.3f,%.3f],\"spin\":[%.3f,0,9]", within(w, -9, 9), within(w, -9, 9),
		    within(w, -9, 9), within(w, -9, 9));
}

static void put_edit(writer *w, const ob_passport *p)
{
	if (one_in(w, 2))
		put(w, ",\"at\":[%.3f,%.3f,%.3f]", within(w, -1, 2), within(w, -1, 2), within(w, .1, 3));
	if (one_in(w, 3))
		put(w, ",\"attitude\":[0.6,0.8,0,0]");
	if (one_in(w, 2))
		put(w, ",\"velocity\":[%.3f,%.3f,%.3f]", within(w, -3, 3), within(w, -3, 3), within(w, -3, 3));
	if (one_in(w, 3))
		put(w, ",\"spin\":[0,%.3f,1]", within(w, -9, 9));
	if (one_in(w, 3))
		put(w, ",\"friction\":%.2f", within(w, 0, 1));
	if (one_in(w, 3))
		put(w, ",\"colour\":[0.1,0.2,0.3]");
	if (p->flags & OB_OBJECT_PRESCRIBED)
		put(w, ",\"surface\":[%.3f,0,0]", within(w, -2, 2));
	else
		put(w, ",\"force\":[0,0,%.3f]", within(w, 0, 20) * p->mass);
}

static void put_path(writer *w)
{
	double t = 0;
	put(w, ",\"points\":[");
	for (unsigned i = 0, n = 1 + (unsigned)(ob_splitmix(&w->seed) % 3); i < n; i++) {
		t += within(w, .1, 1);
		put(w, "%s%.3f,%.3f,%.3f,%.3f", i ? "," : "", t, within(w, -1, 2), within(w, -1, 2), within(w, .1, 2));
	}
	put(w, "],\"loop\":%s", one_in(w, 2) ? "true" : "false");
}

// Name of a joint that exists; false: there is none.
static bool draw_joint(const run *r, uint64_t *seed, char name[OB_NAME_MAX])
{
	ob_joint_passport j;
	const uint32_t n = ob_universe_joints(universe(r)), first = (uint32_t)(ob_splitmix(seed) % (n ? n : 1));
	for (uint32_t i = 0; i < n; i++) {
		if (!ob_universe_get_joint(universe(r), (first + i) % n, &j))
			continue;
		memcpy(name, j.name, OB_NAME_MAX);
		return true;
	}
	return false;
}

// A command as a page sends it.
static void put_command(run *r, writer *w)
{
	static const char *const kinds[] = { "create", "remove", "drag", "push", "turn",   "release", "message",
					     "edit",   "edit",   "kick", "path", "path",   "motor",   "unjoin",
					     "kill",   "pause",  "step", "drag", "create", "push" };
	const unsigned kind = (unsigned)(ob_splitmix(&w->seed) % (sizeof kinds / sizeof *kinds));
	const char *name = kinds[kind];
	char joint[OB_NAME_MAX] = "none";
	ob_passport p = { .mass = 1 };
	put(w, "{\"do\":\"%s\"", name);
	draw_object(r, &w->seed, &p);
	char own[32];
	snprintf(own, sizeof own, ",\"id\":%u", p.id);
	if (strcmp(name, "create") == 0)
		put_object_fields(w);
	else if (strcmp(name, "release") == 0)
		put(w, "%s", one_in(w, 2) ? "" : own);
	else if (strcmp(name, "motor") == 0 || strcmp(name, "unjoin") == 0)
		put(w, ",\"name\":\"%s\"", draw_joint(r, &w->seed, joint) ? joint : "none");
	else if (strcmp(name, "pause") != 0 && strcmp(name, "step") != 0)
		put(w, ",\"id\":%u,\"generation\":%u", p.id, p.generation);
	if (strcmp(name, "motor") == 0)
		put(w, ",\"value\":%.3f", within(w, -5, 5));
	else if (strcmp(name, "drag") == 0)
		put(w, ",\"target\":[%.3f,%.3f,%.3f],\"point\":[0,0.05,0.02]", within(w, -1, 2), within(w, -1, 2),
		    within(w, .1, 3));
	else if (strcmp(name, "push") == 0)
		put(w, ",\"force\":[%.3f,0,%.3f]", within(w, -20, 20) * p.mass, within(w, 0, 20) * p.mass);
	else if (strcmp(name, "turn") == 0)
		put(w, ",\"torque\":[0,%.4f,%.4f]", within(w, -.1, .1) * p.mass, within(w, -.1, .1) * p.mass);
	else if (strcmp(name, "message") == 0)
		put(w, ",\"text\":\"walk 1 0\"");
	else if (strcmp(name, "kick") == 0)
		put(w, ",\"impulse\":[0,%.3f,%.3f]", within(w, -3, 3) * p.mass, within(w, -3, 3) * p.mass);
	else if (strcmp(name, "path") == 0)
		put_path(w);
	else if (strcmp(name, "edit") == 0)
		put_edit(w, &p);
	put(w, "}");
}

static bool fail(run *r, const char *what, const char *command)
{
	r->broken = true;
	return ob_fail(&r->e, "%s %s", what, command);
}

static ob_role role_of(uint32_t visitor)
{
	return (ob_role)(visitor - 1);
}

// Carries out a viewer's command as a server does. Refusals are the same in all ways.
static bool visit(run *r, uint64_t seed, uint32_t visitor)
{
	char text[OB_COMMAND_BYTES_MAX];
	writer w = { .to = text, .size = sizeof text, .seed = seed };
	ob_command c;
	ob_error refused;
	put_command(r, &w);
	if (!ob_command_read(&c, text, (size_t)w.used, &refused))
		return fail(r, refused.text, text);
	for (uint32_t i = 0; i < c.requests; i++) {
		ob_request *q = &c.request[i];
		if (ob_is_joint_request(q) && !ob_joint_request_find(universe(r), (const char *)q->values, q, &refused))
			continue;
		q->origin = visitor;
		if (ob_host_ask_as(r->h, role_of(visitor), q, &refused) && role_of(visitor) == OB_ROLE_WATCH)
			return fail(r, "one who watches was obeyed:", text);
	}
	return true;
}

static bool ask_for(void *host, ob_request *q, ob_error *e)
{
	return ob_host_ask(host, q, e);
}

// Creates a body, or joins two, as obsim send and programs do.
static void create_any(run *r, uint64_t seed)
{
	char text[4096];
	writer w = { .to = text, .size = sizeof text, .seed = seed };
	ob_passport a = { .name = "" }, b = { .name = "" };
	ob_error refused;
	draw_object(r, &w.seed, &a), draw_object(r, &w.seed, &b);
	if (one_in(&w, 3))
		put_any_body(&w);
	else
		put_joint(&w, a.name, a.id == b.id ? "" : b.name,
			  ob_v3(within(&w, 0, 2), within(&w, 0, 2), within(&w, 0, 2)), "made");
	ob_create_as_scene(r->h->u, text, strlen(text), 0, ask_for, r->h, &refused);
}

static void leave(run *r, uint32_t visitor)
{
	ob_request q = { .kind = OB_REQUEST_RELEASE, .id = UINT32_MAX, .origin = visitor };
	ob_error refused;
	ob_roster_entry entry;
	ob_host_ask(r->h, &q, &refused);
	for (uint32_t id = 0; id < ob_universe_ids(universe(r)); id++)
		if (ob_roster_find(ob_host_roster(r->h), id, &entry) && ob_is_avatar(&entry) && entry.origin == visitor)
			ob_host_request_remove(r->h, id, entry.generation);
}

// Goes on from here, and comes back: all that happened in between is undone.
static bool go_and_return(run *r, uint64_t seed)
{
	const uint64_t step = ob_step_count(universe(r)), until = step + ob_splitmix(&seed) % 30;
	ob_request keep = { .kind = OB_REQUEST_KEEP }, back = { .kind = OB_REQUEST_RETURN };
	ob_error refused;
	if (!stand_at(r, step)) // requests that wait are carried out first
		return false;
	ob_host_ask(r->h, &keep, &refused);
	ob_host_operate(r->h);
	if (!stand_at(r, until < LIFE_STEPS ? until : LIFE_STEPS))
		return false;
	if (ob_splitmix(&seed) % 2 && !visit(r, seed, 3))
		return false;
	ob_host_ask(r->h, &back, &refused);
	if (ob_host_operate(r->h) && ob_step_count(universe(r)) != step)
		return fail(r, "a run did not go back to where its snapshot was", "");
	return true;
}

static void move(run *r, uint64_t seed)
{
	ob_passport p;
	ob_request q = { .kind = OB_REQUEST_MOVE, .worker = (uint32_t)(ob_splitmix(&seed) % 2) };
	ob_error refused;
	if (!draw_object(r, &seed, &p))
		return;
	q.id = p.id, q.generation = p.generation;
	ob_host_ask(r->h, &q, &refused);
}

bool deed_happen(run *r, const life_event *event)
{
	uint64_t seed = event->seed;
	const uint32_t visitor = 1 + (uint32_t)(ob_splitmix(&seed) % 8 + 5) / 6; // rarely one who watches
	ob_request avatar = { .kind = OB_REQUEST_AVATAR, .origin = visitor };
	ob_error refused;
	switch ((life_event_kind)event->kind) {
	case LIFE_VISIT:
		return visit(r, seed, visitor);
	case LIFE_CREATE_ANY:
		create_any(r, seed);
		return true;
	case LIFE_AVATAR:
		avatar.state.pose.p = ob_splitmix_vector(&seed, 1.5);
		avatar.state.pose.p.z += 2;
		ob_host_ask(r->h, &avatar, &refused);
		return true;
	case LIFE_LEAVE:
		leave(r, visitor);
		return true;
	case LIFE_RETURN:
		return go_and_return(r, seed);
	case LIFE_MOVE:
		move(r, seed);
		return true;
	default:
		return true;
	}
}
