// "Did you mean ...?"
#ifndef OB_CLI_SUGGEST_H
#define OB_CLI_SUGGEST_H

#include <stddef.h>

// How many insertions, deletions, replacements and swaps of neighbours turn a into b (optimal string alignment,
// Damerau 1964), both cut at 63 bytes.
size_t ob_suggest_distance(const char *a, const char *b);

// Offers one candidate after the other: keeps the nearest to word that is near enough to be a slip of the hand.
typedef struct ob_suggestion {
	const char *word, *best; // best: NULL = nothing is near
	size_t distance;
} ob_suggestion;
void ob_suggest_offer(ob_suggestion *s, const char *candidate);

#endif
