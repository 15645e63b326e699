#include "measure/measure.h"

#include <string.h>

// FNV-1a, 64 bits (Fowler, Noll and Vo), least significant byte first on every machine.
static uint64_t add(uint64_t hash, uint64_t word)
{
	for (int i = 0; i < 8; i++) {
		hash ^= word >> (8 * i) & 0xff;
		hash *= 0x100000001b3u;
	}
	return hash;
}

uint64_t ob_measure_hash(const ob_snapshot *s)
{
	uint64_t hash = 0xcbf29ce484222325u;
	for (uint32_t id = 0; id < s->count; id++) {
		if (!(s->passport[id].flags & OB_OBJECT_PRESENT))
			continue;
		ob_state state = ob_snapshot_state(s, id);
		uint64_t word[sizeof state / 8];
		memcpy(word, &state, sizeof state);
		hash = add(hash, id);
		for (size_t i = 0; i < sizeof state / 8; i++)
			hash = add(hash, word[i]);
	}
	return hash;
}
