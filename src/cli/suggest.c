#include "cli/suggest.h"

#include <string.h>

enum { LENGTH_MAX = 63 };

static size_t least(size_t a, size_t b)
{
	return a < b ? a : b;
}

size_t ob_suggest_distance(const char *a, const char *b)
{
	size_t rows[3][LENGTH_MAX + 1]; // the last three lines of the table of distances of prefixes
	size_t na = strnlen(a, LENGTH_MAX), nb = strnlen(b, LENGTH_MAX);
	size_t *before = rows[0], *above = rows[1], *line = rows[2];
	for (size_t j = 0; j <= nb; j++)
		line[j] = j;
	for (size_t i = 1; i <= na; i++) {
		size_t *free_row = before;
		before = above;
		above = line;
		line = free_row;
		line[0] = i;
		for (size_t j = 1; j <= nb; j++) {
			size_t change = above[j - 1] + (a[i - 1] != b[j - 1]);
			line[j] = least(change, least(above[j], line[j - 1]) + 1);
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
				line[j] = least(line[j], before[j - 2] + 1);
		}
	}
	return line[nb];
}

void ob_suggest_offer(ob_suggestion *s, const char *candidate)
{
	size_t d = ob_suggest_distance(s->word, candidate);
	size_t enough = 1 + strnlen(s->word, LENGTH_MAX) / 4;
	// A word that was cut short ("dur" for "duration") is near, too, however much is missing.
	size_t n = strlen(s->word);
	if (n >= 3 && strncmp(s->word, candidate, n) == 0)
		d = least(d, 1);
	if (d <= enough && (!s->best || d < s->distance)) {
		s->best = candidate;
		s->distance = d;
	}
}
