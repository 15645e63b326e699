#include "host/contact_events.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"

typedef struct pair {
	uint32_t a, b;
} pair;

struct ob_contact_events {
	ob_contact_point *point; // [points_max]: scratch
	pair *before, *now; // ascending; [pairs_max]
	size_t points_max, count_before, count, pairs_max;
	ob_contact_event *event; // [events]
	size_t events, events_max;
	uint64_t lost;
};

static int by_ids(const void *pa, const void *pb)
{
	const pair *a = pa, *b = pb;
	if (a->a != b->a)
		return a->a < b->a ? -1 : 1;
	return (a->b > b->b) - (a->b < b->b);
}

static bool reserve_pairs(ob_contact_events *c, size_t count)
{
	size_t one = c->pairs_max, other = c->pairs_max;
	if (!OB_RESERVE(c->before, count, one) || !OB_RESERVE(c->now, count, other))
		return false;
	c->pairs_max = one;
	return true;
}

// Lists the pairs that touch.
static bool list_pairs(ob_contact_events *c, const ob_universe *u)
{
	size_t n = ob_universe_get_contacts(u, c->point, c->points_max);
	while (n > c->points_max) {
		if (!OB_RESERVE(c->point, n, c->points_max))
			return false;
		n = ob_universe_get_contacts(u, c->point, c->points_max);
	}
	if (!reserve_pairs(c, n + 1))
		return false;
	for (size_t i = 0; i < n; i++)
		c->now[i] = (pair){ c->point[i].a, c->point[i].b };
	qsort(c->now, n, sizeof *c->now, by_ids);
	c->count = 0;
	for (size_t i = 0; i < n; i++)
		if (i == 0 || by_ids(&c->now[i], &c->now[c->count - 1]) != 0)
			c->now[c->count++] = c->now[i];
	return true;
}

static void add(ob_contact_events *c, pair p, bool begins, uint64_t step)
{
	if (c->events < OB_CONTACT_EVENTS_MAX && OB_MAKE_ROOM(c->event, c->events, c->events_max))
		c->event[c->events++] = (ob_contact_event){ p.a, p.b, (uint32_t)step, begins };
	else
		c->lost++;
}

// Merges both lists.
static void compare(ob_contact_events *c, uint64_t step)
{
	for (size_t i = 0, k = 0; i < c->count_before || k < c->count;) {
		const int order = i == c->count_before ? 1 : k == c->count ? -1 : by_ids(&c->before[i], &c->now[k]);
		if (order < 0)
			add(c, c->before[i], false, step);
		else if (order > 0)
			add(c, c->now[k], true, step);
		i += order <= 0;
		k += order >= 0;
	}
}

bool ob_contact_events_look(ob_contact_events *c, const ob_universe *u, bool silent)
{
	ob_universe_info info;
	if (!list_pairs(c, u))
		return false;
	ob_universe_get_info(u, &info);
	if (!silent)
		compare(c, info.step);
	pair *reused = c->before;
	c->before = c->now;
	c->now = reused;
	c->count_before = c->count;
	return true;
}

ob_contact_events *ob_contact_events_create(const ob_universe *u)
{
	ob_contact_events *c = calloc(1, sizeof *c);
	if (c && ob_contact_events_look(c, u, true))
		return c;
	ob_contact_events_destroy(c);
	return NULL;
}

void ob_contact_events_destroy(ob_contact_events *c)
{
	if (!c)
		return;
	free(c->point);
	free(c->before);
	free(c->now);
	free(c->event);
	free(c);
}

size_t ob_contact_events_take(ob_contact_events *c, ob_contact_event *out, size_t max, uint64_t *lost)
{
	const size_t n = c->events < max ? c->events : max;
	if (n)
		memcpy(out, c->event, n * sizeof *out);
	c->events -= n;
	if (n)
		memmove(c->event, c->event + n, c->events * sizeof *out);
	*lost = c->lost;
	c->lost = 0;
	return n;
}
