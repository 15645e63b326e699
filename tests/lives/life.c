#include "life.h"

#include <stdlib.h>

#include "base/random.h"
#include "things.h"

// They push themselves about, create what soon removes itself, and answer messages.
static const char scripts[] =
	"script('a', [[\n"
	"function on_start() self.state.n = 0 self:wake(random(.1, .6)) end\n"
	"function on_step(dt) if random(0, 1) < .2 then self:push(random(-.3, .3), random(-.3, .3), random(0, .6)) end "
	"end\n"
	"function on_contact(other, impulse, point)\n"
	"  if random(0, 1) < .1 then\n"
	"    local x, y, z = self:position()\n"
	"    sphere { radius = .05 + random(0, .1), at = { x, y, z + .4 }, density = 500, script = 'b' }\n"
	"  end\n"
	"end\n"
	"function on_wake()\n"
	"  for _, o in ipairs(near(1)) do send(o, self.state.n) end\n"
	"  self:wake(random(.1, .6))\n"
	"end\n"
	"function on_message(from, n)\n"
	"  self.state.n = self.state.n + 1\n"
	"  if self.state.n > 6 then self:remove() end\n"
	"end]])\n"
	"script('b', [[\n"
	"function on_start() self:wake(random(.02, .8)) end\n"
	"function on_wake() self:remove() end\n"
	"function on_stop() for _, o in ipairs(near(.5)) do send(o, 1) end end]])\n";

static void put_object(writer *w, uint64_t seed, bool has_scripts, bool closed)
{
	static const char *const shapes[] = { "sphere", "box", "capsule", "cylinder" };
	w->seed = seed;
	const unsigned shape = ob_splitmix(&w->seed) % 4, fixed = ob_splitmix(&w->seed) % 12;
	put(w, "%s {", shapes[shape]);
	put_vector(w, "at", .3, 2.3);
	if (fixed || closed)
		put_vector(w, "velocity", -2, 2);
	if (shape == 1)
		put_vector(w, "size", .1, .6);
	else
		put(w, " radius = %.3f,", within(w, .05, .3));
	if (shape > 1)
		put(w, " length = %.3f,", within(w, .1, .6));
	put(w, " restitution = %.2f,", within(w, 0, .8));
	if (fixed < 2 && !closed)
		put(w, " kind = '%s',", fixed ? "kinematic" : "static");
	else if (has_scripts && one_in(w, 2))
		put(w, " script = 'a',");
	const double born = one_in(w, 4) ? within(w, .1, 3) : 0;
	if (born > 0 && !closed)
		put(w, " born = %.3f,", born);
	if (one_in(w, 4) && !closed)
		put(w, " dies = %.3f,", born + within(w, .05, 3));
	put(w, " density = %.0f }\n", within(w, 100, 2000));
}

static int by_step(const void *a, const void *b)
{
	const life_event *x = a, *y = b;
	return x->step != y->step ? (x->step < y->step ? -1 : 1) : (x->seed > y->seed) - (x->seed < y->seed);
}

// Some of them come at once.
static uint32_t draw_events(const life *l, uint64_t seed, life_event all[LIFE_EVENTS])
{
	const uint32_t n = 1 + (uint32_t)(ob_splitmix(&seed) % LIFE_EVENTS);
	for (uint32_t i = 0; i < n; i++) {
		const uint32_t step = (uint32_t)(ob_splitmix(&seed) % LIFE_STEPS);
		all[i].step = i && ob_splitmix(&seed) % 4 == 0 ? all[i - 1].step : step;
		all[i].kind = (uint32_t)(ob_splitmix(&seed) % LIFE_EVENT_KINDS);
		all[i].seed = ob_splitmix(&seed);
		if (all[i].kind == LIFE_FREEZE && l->scripts)
			all[i].kind = LIFE_REMOVE;
		if (all[i].kind == LIFE_RESUME && all[i].seed % 4)
			all[i].kind = LIFE_CREATE_REMOVE;
	}
	qsort(all, n, sizeof *all, by_step);
	return n;
}

static uint32_t draw_deeds(uint64_t seed, life_event all[LIFE_DEEDS])
{
	const uint32_t n = (uint32_t)(ob_splitmix(&seed) % (LIFE_DEEDS + 1));
	for (uint32_t i = 0; i < n; i++) {
		const uint64_t kind = ob_splitmix(&seed) % 12;
		all[i].step = (uint32_t)(ob_splitmix(&seed) % LIFE_STEPS);
		all[i].kind = LIFE_VISIT + (kind < LIFE_ALL_KINDS - LIFE_VISIT ? (uint32_t)kind : 0);
		all[i].seed = ob_splitmix(&seed);
	}
	qsort(all, n, sizeof *all, by_step);
	return n;
}

static void take(life *l, const life_event *all, uint32_t n, uint64_t left)
{
	for (uint32_t i = 0; i < n; i++)
		if (left >> i & 1)
			l->event[l->events++] = all[i];
}

static void put_things(writer *w, life *l, uint64_t seed, uint64_t left, bool free)
{
	things t = { .scripts = l->scripts, .free = free, .closed = l->closed, .life = l->seed };
	const uint32_t most = ob_splitmix(&seed) % 4 ? LIFE_THINGS / 2 : LIFE_THINGS,
		       n = (uint32_t)(ob_splitmix(&seed) % (most + 1));
	for (uint32_t i = 0; i < n; i++) {
		const uint64_t mine = ob_splitmix(&seed);
		if (left >> i & 1)
			put_thing(w, &t, i, mine);
	}
}

// Draws them from a seed of their own, so that all else of a life is as it was without them.
static void put_fmus(writer *w, uint64_t seed, uint64_t left)
{
	if (ob_splitmix(&seed) % 4)
		return;
	for (uint32_t i = 0; i < LIFE_FMUS; i++) {
		const uint64_t mine = ob_splitmix(&seed);
		if (left >> i & 1)
			put_fmu(w, mine);
	}
}

void life_make(life *l, uint64_t seed, life_parts left, bool free)
{
	uint64_t more = seed * 0xd1342543de82ef95u + 7;
	writer w = { .to = l->text, .size = LIFE_TEXT, .seed = seed * 0x9e3779b97f4a7c15u + 1 };
	*l = (life){ .seed = seed };
	bool sleeping = !one_in(&w, 3), coarse = !one_in(&w, 3), ground = !one_in(&w, 6);
	l->scripts = one_in(&w, 3) && !free;
	l->objects = 1 + (uint32_t)(ob_splitmix(&w.seed) % LIFE_OBJECTS);
	l->reader = ob_splitmix(&more) % 3 == 0 && left.objects >> LIFE_READER & 1;
	l->keeps = ob_splitmix(&more) % 2 == 0 && left.objects >> LIFE_KEEPS & 1;
	coarse |= ob_splitmix(&more) % 4 && left.objects >> LIFE_OBJECTS; // else most of the time goes into few lives
	const uint64_t events = ob_splitmix(&w.seed), objects = ob_splitmix(&w.seed);
	l->closed = free && ob_splitmix(&more) % 2;
	put(&w, "scene { step = 1/60%s, sleeping = %s%s%s }\n", coarse ? ", substeps = 2, iterations = 4" : "",
	    sleeping ? "true" : "false", l->scripts ? ", room = 12" : "", l->closed ? ", gravity = { 0, 0, 0 }" : "");
	if (l->scripts)
		put(&w, "%s", scripts);
	if (l->closed)
		put(&w, "sphere { radius = .1, at = { 0, 0, 90 } }\n");
	else if (ground)
		put(&w, "ground {}\n");
	else
		put(&w, "box { size = { 8, 8, .2 }, at = { 0, 0, -.1 }, static = true }\n");
	for (uint32_t i = 0; i < l->objects; i++)
		if (left.objects >> i & 1)
			put_object(&w, objects + i, l->scripts, l->closed);
	put_things(&w, l, ob_splitmix(&more), left.objects >> LIFE_OBJECTS, free);
	if (!free)
		put_fmus(&w, seed * 0xaef17502108ef2d9u + 3, left.objects >> (LIFE_OBJECTS + LIFE_THINGS));
	life_event strange[LIFE_EVENTS], deeds[LIFE_DEEDS];
	take(l, strange, draw_events(l, events, strange), left.events);
	take(l, deeds, draw_deeds(ob_splitmix(&more), deeds), left.events >> LIFE_EVENTS);
	qsort(l->event, l->events, sizeof *l->event, by_step);
}
