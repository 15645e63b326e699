// Digests of what ranks compare (peers.h, holdings.h): of whole words, in lanes that do not wait for each other.
#ifndef OB_SIM_DIGEST_H
#define OB_SIM_DIGEST_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline uint64_t ob_digest_word(uint64_t sum, uint64_t word)
{
	sum = (sum ^ word) * 0x9e3779b97f4a7c15u;
	return sum ^ sum >> 29;
}

// bytes: a multiple of 8
static inline uint64_t ob_digest_words(const void *words, size_t bytes)
{
	enum { LANES = 4 };
	uint64_t lane[LANES] = { 1, 2, 3, 4 }, word[LANES];
	size_t at = 0;
	for (; at + sizeof word <= bytes; at += sizeof word) {
		memcpy(word, (const char *)words + at, sizeof word);
		for (int i = 0; i < LANES; i++)
			lane[i] = ob_digest_word(lane[i], word[i]);
	}
	for (; at < bytes; at += sizeof *word) {
		memcpy(word, (const char *)words + at, sizeof *word);
		lane[0] = ob_digest_word(lane[0], *word);
	}
	return ob_digest_word(ob_digest_word(ob_digest_word(lane[0], lane[1]), lane[2]), lane[3]);
}

#endif
