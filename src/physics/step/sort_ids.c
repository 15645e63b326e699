#include "step/sort_ids.h"

#include <string.h>

enum { FEW = 32 }; // below this number insertion is faster

static void insert_all(uint32_t *id, uint32_t n)
{
	for (uint32_t i = 1; i < n; i++) {
		const uint32_t moved = id[i];
		uint32_t at = i;
		for (; at > 0 && id[at - 1] > moved; at--)
			id[at] = id[at - 1];
		id[at] = moved;
	}
}

void ob_sort_ids(uint32_t *id, uint32_t n, uint32_t end, uint32_t *other)
{
	enum { BITS = 8, DIGITS = 1 << BITS };
	if (n < FEW) {
		insert_all(id, n);
		return;
	}
	uint32_t *from = id, *to = other;
	for (uint32_t shift = 0; shift < 32 && end >> shift; shift += BITS) {
		uint32_t first[DIGITS] = { 0 }, *sorted = to;
		for (uint32_t i = 0; i < n; i++)
			first[from[i] >> shift & (DIGITS - 1)]++;
		for (uint32_t d = 0, sum = 0, there; d < DIGITS; d++, sum += there)
			there = first[d], first[d] = sum;
		for (uint32_t i = 0; i < n; i++)
			to[first[from[i] >> shift & (DIGITS - 1)]++] = from[i];
		to = from;
		from = sorted;
	}
	if (from != id)
		memcpy(id, from, n * sizeof *id);
}
