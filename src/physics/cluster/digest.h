// Digests of whole words, which ranks compare (peers.h, holdings.h).
#ifndef OB_CLUSTER_DIGEST_H
#define OB_CLUSTER_DIGEST_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline uint64_t ob_digest_word(uint64_t sum, uint64_t word)
{
	sum = (sum ^ word) * 0x9e3779b97f4a7c15u;
	return sum ^ sum >> 29;
}

// Returns the digest of memory; bytes: a multiple of 8. It sums products of two words each: NH of Black, Halevi,
// Krawczyk, Krovetz and Rogaway (UMAC: fast and secure message authentication, 1999). Keys are multiples of a number
// here, so no product waits for another.
static inline uint64_t ob_digest_words(const void *words, size_t bytes)
{
	const uint64_t step = 0x9e3779b97f4a7c15u, other = 0xd1b54a32d192ed03u;
	uint64_t word[2], key = step, low = 0, high = 0;
	size_t at = 0;
	for (; at + sizeof word <= bytes; at += sizeof word, key += step) {
		memcpy(word, (const char *)words + at, sizeof word);
		const unsigned __int128 product = (unsigned __int128)(word[0] + key) * (word[1] + (key ^ other));
		low += (uint64_t)product;
		high += (uint64_t)(product >> 64);
	}
	for (; at < bytes; at += sizeof *word) {
		memcpy(word, (const char *)words + at, sizeof *word);
		low = ob_digest_word(low, *word);
	}
	return ob_digest_word(ob_digest_word(bytes, low), high);
}

#endif
