// "Did you mean ...?": the nearest of several words to one that is none of them. Pure; any thread.
//
//   ob_spelling s = ob_spelling_start(word);
//   for (...) ob_spelling_offer(&s, known[i]);
//   if (s.best) ...
#ifndef OB_BASE_SPELLING_H
#define OB_BASE_SPELLING_H

typedef struct ob_spelling {
	const char *word; // as written
	const char *best; // the nearest so far; NULL: none is near enough
	int distance; // edits from word to best
} ob_spelling;

ob_spelling ob_spelling_start(const char *word);
void ob_spelling_offer(ob_spelling *s, const char *known);

// Number of insertions, deletions, replacements and swaps of neighbours that turn a into b (optimal string alignment,
// Damerau 1964), both cut at 63 bytes.
int ob_spelling_distance(const char *a, const char *b);

#endif
