// "Did you mean ...?": the nearest of several words. Pure.
#ifndef OB_SCENE_SPELLING_H
#define OB_SCENE_SPELLING_H

typedef struct ob_spelling {
	const char *word; // as it was written
	const char *best; // the nearest so far; NULL = none is near enough to be meant
	int distance; // edits from word to best
} ob_spelling;

ob_spelling ob_spelling_start(const char *word);
void ob_spelling_offer(ob_spelling *s, const char *known);

#endif
