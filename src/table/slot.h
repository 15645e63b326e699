// The slot: how one writer hands whole records to any number of readers without a lock.
//
//                 version = 6                           a record's place is its version modulo the ring's length
//                     |
//          +-------+-------+-------+-------+
//   ring   |   4   |   5   |   6   |  (7)  |   the writer fills the place of version 7, and only then sets
//          +-------+-------+-------+-------+   version = 7: until that instant every reader takes version 6
//             0       1       2       3
//
//   writer   next = version + 1;  store-release each word into ring[next];  store-release version = next
//   reader   v = version;  load-acquire each word of ring[v];  take it if version < v + 3, else again
//
// Why a copy is never torn: the place of v is written again for version v + 4, which begins after version v + 3
// was stored. A reader that met one word of v + 4 has, by acquire and release on that word, also seen v + 3, so
// its second look at the version says so, and it reads again. There is no odd state in between: a writer that is
// preempted or killed anywhere leaves the last version readable, and its successor fills the same place anew.
// Every word is atomic by itself, so there is no data race in the sense of C11, and no fence is needed.
//
// One writer at a time; readers in any thread or process.
#ifndef OB_TABLE_SLOT_H
#define OB_TABLE_SLOT_H

#include <assert.h>

#include <ob/universe.h>

enum {
	OB_SLOT_VERSIONS = 4, // a reader may be three publications late before it must read again
	OB_PASSPORT_VERSIONS = 2, // changes rarely
	OB_RING_TRIES = 100000, // readers give up then: only a damaged table gets there
};

typedef struct ob_slot {
	_Alignas(64) uint64_t version; // 0 = never published
	_Alignas(64) ob_motion ring[OB_SLOT_VERSIONS];
} ob_slot;

typedef struct ob_passport_slot {
	_Alignas(64) uint64_t version;
	_Alignas(64) ob_passport ring[OB_PASSPORT_VERSIONS];
} ob_passport_slot;

static_assert(sizeof(ob_motion) == 256, "payload of a slot");
static_assert(sizeof(ob_passport) == 192, "passport");
static_assert(sizeof(ob_slot) == 64 + OB_SLOT_VERSIONS * 256, "slot");
static_assert(sizeof(ob_passport_slot) == 64 + OB_PASSPORT_VERSIONS * 192, "passport slot");

typedef uint64_t __attribute__((may_alias)) ob_word;

static inline void ob_ring_publish(uint64_t *version, void *ring, unsigned versions, size_t bytes, const void *record)
{
	uint64_t next = __atomic_load_n(version, __ATOMIC_ACQUIRE) + 1;
	ob_word *to = (ob_word *)((char *)ring + next % versions * bytes);
	const ob_word *from = record;
#pragma GCC unroll 8
	for (size_t i = 0; i < bytes / sizeof(ob_word); i++)
		__atomic_store_n(to + i, from[i], __ATOMIC_RELEASE);
	__atomic_store_n(version, next, __ATOMIC_RELEASE);
}

// false: never published
static inline bool ob_ring_read(const uint64_t *version, const void *ring, unsigned versions, size_t bytes, void *out)
{
	ob_word *to = out;
	for (int i = 0; i < OB_RING_TRIES; i++) {
		uint64_t v = __atomic_load_n(version, __ATOMIC_ACQUIRE);
		if (v == 0)
			return false;
		const ob_word *from = (const ob_word *)((const char *)ring + v % versions * bytes);
#pragma GCC unroll 8
		for (size_t k = 0; k < bytes / sizeof(ob_word); k++)
			to[k] = __atomic_load_n(from + k, __ATOMIC_ACQUIRE);
		if (__atomic_load_n(version, __ATOMIC_RELAXED) - v < versions - 1)
			return true;
	}
	return false;
}

static inline void ob_slot_publish(ob_slot *s, const ob_motion *m)
{
	ob_ring_publish(&s->version, s->ring, OB_SLOT_VERSIONS, sizeof *m, m);
}

static inline bool ob_slot_read(const ob_slot *s, ob_motion *out)
{
	return ob_ring_read(&s->version, s->ring, OB_SLOT_VERSIONS, sizeof *out, out);
}

#endif
