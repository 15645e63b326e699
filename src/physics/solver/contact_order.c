#include "solver/contact_order.h"

#include <stdlib.h>
#include <string.h>

#include "shape/shape.h"

// Returns the distance of the centres relative to the sum of the bodies' radii. For a plane: the other body's height
// relative to its radius, times .1, so that bodies on the ground come first.
static float relative_distance(const ob_body *a, const ob_body *b)
{
	const bool first = ob_shape_is(a->shape, OB_UNBOUNDED);
	const ob_body *plane = first ? a : b, *other = first ? b : a;
	ob_vec3 between = ob_sub(other->p, plane->p);
	if (ob_shape_is(plane->shape, OB_UNBOUNDED))
		return (float)ob_max(0, .1 * ob_dot(between, ob_column(&plane->r, 2)) / other->radius);
	return (float)(ob_norm(between) / (a->radius + b->radius));
}

// The same from a region of a terrain.
static float distance_of_region(const ob_body *body, const ob_body *terrain, const ob_hull *region)
{
	const ob_vec3 centre = ob_add(terrain->p, ob_rotate(&terrain->r, region->centre));
	return (float)(ob_norm(ob_sub(body->p, centre)) / (body->radius + region->radius));
}

static int by_key(const void *a, const void *b)
{
	const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

void ob_contact_order(ob_solver *s, const ob_island_input *in, uint32_t *order)
{
	const ob_island_work *w = &s->island;
	uint64_t *key = w->contact_key;
	for (uint32_t i = 0; i < in->pairs; i++) {
		const ob_island_pair *k = &in->pair[i];
		float x = relative_distance(&w->body[w->row_of[k->a]], &w->body[w->row_of[k->b]]);
		if (k->part[0] && ob_shape_is(w->body[w->row_of[k->a]].shape, OB_SURFACED))
			x = distance_of_region(&w->body[w->row_of[k->b]], &w->body[w->row_of[k->a]], k->part[0]);
		else if (k->part[1] && ob_shape_is(w->body[w->row_of[k->b]].shape, OB_SURFACED))
			x = distance_of_region(&w->body[w->row_of[k->a]], &w->body[w->row_of[k->b]], k->part[1]);
		uint32_t bits;
		memcpy(&bits, &x, sizeof bits);
		key[i] = (uint64_t)bits << 32 | i;
	}
	if (in->pairs)
		qsort(key, in->pairs, sizeof *key, by_key); // bits of non-negative floats sort as their values do
	for (uint32_t i = 0; i < in->pairs; i++)
		order[i] = (uint32_t)key[i];
}
