#include "solver/contact_order.h"

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

// Sorts by the upper half of the keys, stably. Bits of non-negative floats sort as their values do. other: memory for n
// keys.
static void sort_keys(uint64_t *key, uint64_t *other, uint32_t n)
{
	enum { FEW = 24, BITS = 8, DIGITS = 1 << BITS };
	if (n <= FEW) {
		for (uint32_t i = 1; i < n; i++) {
			const uint64_t k = key[i];
			uint32_t at = i;
			for (; at > 0 && key[at - 1] > k; at--)
				key[at] = key[at - 1];
			key[at] = k;
		}
		return;
	}
	for (int shift = 32; shift < 64; shift += BITS) {
		uint32_t first[DIGITS] = { 0 };
		for (uint32_t i = 0; i < n; i++)
			first[key[i] >> shift & (DIGITS - 1)]++;
		for (uint32_t d = 0, sum = 0, there; d < DIGITS; d++, sum += there)
			there = first[d], first[d] = sum;
		for (uint32_t i = 0; i < n; i++)
			other[first[key[i] >> shift & (DIGITS - 1)]++] = key[i];
		memcpy(key, other, n * sizeof *key);
	}
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
	sort_keys(key, key + in->pairs, in->pairs);
	for (uint32_t i = 0; i < in->pairs; i++)
		order[i] = (uint32_t)key[i];
}
