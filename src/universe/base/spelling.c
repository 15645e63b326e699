#include "base/spelling.h"

#include <string.h>

enum { LENGTH_MAX = 63 }; // bytes

static int smaller(int a, int b)
{
	return a < b ? a : b;
}

int ob_spelling_distance(const char *a, const char *b)
{
	int rows[3][LENGTH_MAX + 1]; // last three rows of the table of distances of prefixes
	const size_t length_a = strlen(a), length_b = strlen(b);
	const int na = length_a < LENGTH_MAX ? (int)length_a : LENGTH_MAX;
	const int nb = length_b < LENGTH_MAX ? (int)length_b : LENGTH_MAX;
	int *before = rows[0], *above = rows[1], *line = rows[2];
	for (int j = 0; j <= nb; j++)
		line[j] = j;
	for (int i = 1; i <= na; i++) {
		int *oldest = before;
		before = above;
		above = line;
		line = oldest;
		line[0] = i;
		for (int j = 1; j <= nb; j++) {
			int changed = above[j - 1] + (a[i - 1] != b[j - 1]);
			line[j] = smaller(changed, smaller(above[j], line[j - 1]) + 1);
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
				line[j] = smaller(line[j], before[j - 2] + 1);
		}
	}
	return line[nb];
}

// distance: too many edits for a slip of the hand
ob_spelling ob_spelling_start(const char *word)
{
	size_t n = strlen(word);
	return (ob_spelling){ word, NULL, n > 7 ? 4 : n > 2 ? 3 : 2 };
}

void ob_spelling_offer(ob_spelling *s, const char *known)
{
	int d = ob_spelling_distance(s->word, known);
	// A truncated word ("dur" for "duration") is near, at any length of the missing part.
	size_t n = strlen(s->word);
	if (n >= 3 && strncmp(s->word, known, n) == 0)
		d = smaller(d, 1);
	// Equal distance: prefer alphabetical order, so that the answer is always the same.
	if (d < s->distance || (s->best && d == s->distance && strcmp(known, s->best) < 0)) {
		s->best = known;
		s->distance = d;
	}
}
