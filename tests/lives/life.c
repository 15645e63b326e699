#include "life.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/random.h"

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

typedef struct writer {
	char *to;
	int used;
	uint64_t seed;
} writer;

__attribute__((format(printf, 2, 3))) static void put(writer *w, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	w->used += vsnprintf(w->to + w->used, (size_t)(LIFE_TEXT - w->used), format, args);
	va_end(args);
}

static double within(writer *w, double low, double high)
{
	return ob_splitmix_within(&w->seed, low, high);
}

static bool one_in(writer *w, unsigned n)
{
	return ob_splitmix(&w->seed) % n == 0;
}

// " name = { x, y, z }," each between the two
static void put_vector(writer *w, const char *name, double low, double high)
{
	const double x = within(w, low, high), y = within(w, low, high);
	put(w, " %s = { %.3f, %.3f, %.3f },", name, x, y, within(w, low, high));
}

static void put_object(writer *w, uint64_t seed, bool has_scripts)
{
	static const char *const shapes[] = { "sphere", "box", "capsule", "cylinder" };
	w->seed = seed;
	const unsigned shape = ob_splitmix(&w->seed) % 4, fixed = ob_splitmix(&w->seed) % 12;
	put(w, "%s {", shapes[shape]);
	put_vector(w, "at", .3, 2.3);
	if (fixed)
		put_vector(w, "velocity", -2, 2);
	if (shape == 1)
		put_vector(w, "size", .1, .6);
	else
		put(w, " radius = %.3f,", within(w, .05, .3));
	if (shape > 1)
		put(w, " length = %.3f,", within(w, .1, .6));
	put(w, " restitution = %.2f,", within(w, 0, .8));
	if (fixed < 2)
		put(w, " kind = '%s',", fixed ? "kinematic" : "static");
	else if (has_scripts && one_in(w, 2))
		put(w, " script = 'a',");
	const double born = one_in(w, 4) ? within(w, .1, 3) : 0;
	if (born > 0)
		put(w, " born = %.3f,", born);
	if (one_in(w, 4))
		put(w, " dies = %.3f,", born + within(w, .05, 3));
	put(w, " density = %.0f }\n", within(w, 100, 2000));
}

static int by_step(const void *a, const void *b)
{
	const life_event *x = a, *y = b;
	return x->step != y->step ? (x->step < y->step ? -1 : 1) : (x->seed > y->seed) - (x->seed < y->seed);
}

// Some of them come at once.
static void draw_events(life *l, uint64_t seed, uint64_t left)
{
	life_event all[LIFE_EVENTS];
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
	for (uint32_t i = 0; i < n; i++)
		if (left >> i & 1)
			l->event[l->events++] = all[i];
}

void life_make(life *l, uint64_t seed, life_parts left)
{
	writer w = { .to = l->text, .seed = seed * 0x9e3779b97f4a7c15u + 1 };
	*l = (life){ .seed = seed };
	const bool sleeping = !one_in(&w, 3), coarse = !one_in(&w, 3), ground = !one_in(&w, 6);
	l->scripts = one_in(&w, 3);
	l->objects = 1 + (uint32_t)(ob_splitmix(&w.seed) % LIFE_OBJECTS);
	const uint64_t events = ob_splitmix(&w.seed), objects = ob_splitmix(&w.seed);
	put(&w, "scene { step = 1/60%s, sleeping = %s%s }\n", coarse ? ", substeps = 2, iterations = 4" : "",
	    sleeping ? "true" : "false", l->scripts ? ", room = 12" : "");
	if (l->scripts)
		put(&w, "%s", scripts);
	if (ground)
		put(&w, "ground {}\n");
	else
		put(&w, "box { size = { 8, 8, .2 }, at = { 0, 0, -.1 }, static = true }\n");
	for (uint32_t i = 0; i < l->objects; i++)
		if (left.objects >> i & 1)
			put_object(&w, objects + i, l->scripts);
	draw_events(l, events, left.events);
}
