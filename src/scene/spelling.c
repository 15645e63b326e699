#include "scene/spelling.h"

#include <string.h>

#define WORD_MAX 40 // bytes; longer words are not compared

static int smaller(int a, int b)
{
	return a < b ? a : b;
}

// Optimal string alignment (Damerau 1964): inserted, dropped, changed and swapped neighbouring letters.
static int distance(const char *a, const char *b)
{
	int n = (int)strlen(a), m = (int)strlen(b);
	int d[WORD_MAX + 1][WORD_MAX + 1];
	for (int i = 0; i <= n; i++) {
		for (int j = 0; j <= m; j++) {
			if (i == 0 || j == 0) {
				d[i][j] = i + j;
				continue;
			}
			d[i][j] = smaller(d[i - 1][j], d[i][j - 1]) + 1;
			d[i][j] = smaller(d[i][j], d[i - 1][j - 1] + (a[i - 1] != b[j - 1]));
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
				d[i][j] = smaller(d[i][j], d[i - 2][j - 2] + 1);
		}
	}
	return d[n][m];
}

// American and British, and words that other simulators use: far in letters, near in meaning.
static const char *const synonym[][2] = {
	{ "color", "colour" },
	{ "position", "at" },
	{ "pos", "at" },
	{ "dimensions", "size" },
	{ "fixed", "static" },
	{ "omega", "spin" },
	{ "quaternion", "q" },
	{ "bounciness", "restitution" },
	{ "mu", "friction" },
	{ "timestep", "step" },
	{ "dt", "step" },
	{ "sphere_radius", "radius" },
	{ "height", "length" },
	{ "orientation", "rotation" },
	{ "angular_velocity", "spin" },
	{ "cube", "box" },
	{ "ball", "sphere" },
	{ "half_extents", "size" },
};

ob_spelling ob_spelling_start(const char *word)
{
	int n = (int)strlen(word);
	return (ob_spelling){ word, NULL, n > 7 ? 4 : n > 2 ? 3 : 2 };
}

void ob_spelling_offer(ob_spelling *s, const char *known)
{
	for (size_t i = 0; i < sizeof synonym / sizeof *synonym; i++)
		if (strcmp(s->word, synonym[i][0]) == 0 && strcmp(known, synonym[i][1]) == 0) {
			s->best = known;
			s->distance = 0;
		}
	if (strlen(s->word) > WORD_MAX || strlen(known) > WORD_MAX)
		return;
	int d = distance(s->word, known);
	// The same number of edits: the first in the order of the alphabet, so that the answer is always the same.
	if (d < s->distance || (s->best && d == s->distance && strcmp(known, s->best) < 0)) {
		s->best = known;
		s->distance = d;
	}
}
