// The slot: one writer passes whole records to any number of readers without a lock.
//
//            version = 6             a record's place is its version modulo 2
//                |
//          +-----------+-----------+
//   ring   |     6     |    (7)    |   the writer fills the place of version 7, which was that of 5, and only then
//          +-----------+-----------+   sets version = 7: until that instant every reader takes version 6
//
//   writer   next = version + 1;  store-release each word into ring[next];  store-release version = next
//            (The words are staged; the store of the version commits them. Until then they may be staged again.)
//   reader   v = version;  load-acquire each word of ring[v];  take it if version is still v, else again
//
// A copy is never torn: the place of v is written again for version v + 2, which begins after version v + 1 was stored.
// A reader that saw one word of v + 2 has, by acquire and release on that word, also seen v + 1, so its second load of
// the version finds that, and it reads again. There is no state in between: a writer that is preempted or killed
// anywhere leaves the last version readable, and its successor fills the same place anew. Every word is atomic by
// itself, so there is no data race in the sense of C11, and no fence is needed.
//
// Two places suffice: a reader that is too late reads again, and gets a newer version. It would starve only beside a
// writer that publishes without pause; simulators publish once a step. Within the step, where the gate orders both, no
// place is written while a worker reads it: the newest version at the beginning of a step is overwritten in the next
// step at the earliest.
//
// One writer at a time; readers in any thread or process.
#ifndef OB_TABLE_SLOT_H
#define OB_TABLE_SLOT_H

#include <assert.h>

#include <ob/universe.h>

enum {
	OB_RING_VERSIONS = 2,
	OB_RING_TRIES = 100000, // readers give up then: it takes a damaged table
};

typedef struct ob_slot {
	uint64_t version; // 0 = never published
	ob_motion ring[OB_RING_VERSIONS];
} ob_slot;

// Odd versions: an object's first body properties are also its only ones, unless its slot is reused. The even ones have
// an area of their own, whose pages then stay untouched.
typedef struct ob_passport_slot {
	uint64_t version;
	ob_passport odd;
} ob_passport_slot;

static_assert(sizeof(ob_motion) == 176, "payload of a slot");
static_assert(sizeof(ob_passport) == 184, "passport");
static_assert(sizeof(ob_slot) == 360, "slot");
static_assert(sizeof(ob_passport_slot) == 192, "passport slot");

typedef uint64_t __attribute__((may_alias)) ob_word;

// Copies whole words, each by itself, that others may read or write meanwhile.
static inline void ob_words_put(void *to, const void *from, size_t bytes)
{
	for (size_t i = 0; i < bytes / sizeof(ob_word); i++)
		__atomic_store_n((ob_word *)to + i, ((const ob_word *)from)[i], __ATOMIC_RELEASE);
}

static inline void ob_words_get(void *to, const void *from, size_t bytes)
{
	for (size_t i = 0; i < bytes / sizeof(ob_word); i++)
		((ob_word *)to)[i] = __atomic_load_n((const ob_word *)from + i, __ATOMIC_ACQUIRE);
}

// Place of a version. even: place of version 0; stride: bytes from there to the place of version 1.
static inline ob_word *ob_ring_place(const void *even, ptrdiff_t stride, uint64_t version)
{
	return (ob_word *)((char *)(uintptr_t)even + (ptrdiff_t)(version % OB_RING_VERSIONS) * stride);
}

static inline void ob_ring_stage(const uint64_t *version, void *even, ptrdiff_t stride, size_t bytes,
				 const void *record)
{
	uint64_t next = __atomic_load_n(version, __ATOMIC_ACQUIRE) + 1;
	ob_word *to = ob_ring_place(even, stride, next);
	const ob_word *from = record;
#pragma GCC unroll 8
	for (size_t i = 0; i < bytes / sizeof(ob_word); i++)
		__atomic_store_n(to + i, from[i], __ATOMIC_RELEASE);
}

static inline void ob_ring_commit(uint64_t *version)
{
	__atomic_store_n(version, __atomic_load_n(version, __ATOMIC_ACQUIRE) + 1, __ATOMIC_RELEASE);
}

static inline void ob_ring_publish(uint64_t *version, void *even, ptrdiff_t stride, size_t bytes, const void *record)
{
	ob_ring_stage(version, even, stride, bytes, record);
	ob_ring_commit(version);
}

// false: never published
static inline bool ob_ring_read(const uint64_t *version, const void *even, ptrdiff_t stride, size_t bytes, void *out)
{
	ob_word *to = out;
	for (int i = 0; i < OB_RING_TRIES; i++) {
		uint64_t v = __atomic_load_n(version, __ATOMIC_ACQUIRE);
		if (v == 0)
			return false;
		const ob_word *from = ob_ring_place(even, stride, v);
#pragma GCC unroll 8
		for (size_t k = 0; k < bytes / sizeof(ob_word); k++)
			to[k] = __atomic_load_n(from + k, __ATOMIC_ACQUIRE);
		if (__atomic_load_n(version, __ATOMIC_RELAXED) == v)
			return true;
	}
	return false;
}

static inline void ob_slot_publish(ob_slot *s, const ob_motion *m)
{
	ob_ring_publish(&s->version, s->ring, sizeof *m, sizeof *m, m);
}

static inline bool ob_slot_read(const ob_slot *s, ob_motion *out)
{
	return ob_ring_read(&s->version, s->ring, sizeof *out, sizeof *out, out);
}

#endif
