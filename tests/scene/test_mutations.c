// Damaged scenes: whatever is cut, changed, doubled or put in, a scene loads or fails with one line; never a crash
// (run under the address sanitizer). Ten thousand in a minute or two:
//
//   test_scene_mutations . SCENES [COUNT [SEED]]    mutants of each of the shipped scenes in the folder SCENES
#include <stdlib.h>

#include "base/log.h"
#include "check.h"
#include "scene/random.h"
#include "text.h"

#define ROOM 16384

static const char *const seeds[] = { "falling_boxes", "stack",     "pile",   "cradle",
				     "head_on",       "thin_wall", "shapes", "machines" };
static const char *const tokens[] = { "{",     "}",     "(",          ")",     "end",   "nil",
				      "1e308", "-1",    "0/0",        "1/0",   "\"",    ",",
				      "={",    "[[",    "function()", "do",    "\n",    "..",
				      "#",     "^",     "\0",         "box",   "scene", "''",
				      "size",  "q",     "material",   "\xff",  "~=",    "while true do",
				      "goto",  "param", "sphere {}",  "camera" };

static size_t below(ob_random *r, size_t n)
{
	return (size_t)ob_random_up_to(r, n - 1);
}

static size_t remove_part(char *text, size_t size, size_t at, size_t n)
{
	n = n < size - at ? n : size - at;
	memmove(text + at, text + at + n, size - at - n);
	return size - n;
}

static size_t insert_part(char *text, size_t size, size_t at, const char *part, size_t n)
{
	if (size + n > ROOM)
		return size;
	memmove(text + at + n, text + at, size - at);
	memcpy(text + at, part, n);
	return size + n;
}

static size_t damage(ob_random *r, char *text, size_t size)
{
	char part[64];
	size_t at = below(r, size), n = 1 + below(r, sizeof part);
	const char *token = tokens[below(r, sizeof tokens / sizeof *tokens)];
	switch (below(r, 6)) {
	case 0:
		return at + 1;
	case 1:
		text[at] = (char)ob_random_next(r);
		return size;
	case 2:
		text[at] = "0123456789-.,{}()= \"#"[below(r, 21)];
		return size;
	case 3:
		return remove_part(text, size, at, n);
	case 4:
		n = n < size - at ? n : size - at;
		memcpy(part, text + at, n);
		return insert_part(text, size, below(r, size), part, n);
	default:
		return insert_part(text, size, at, token, strlen(token) + (token[0] == 0));
	}
}

static void check_one(ob_random *r, const char *original, size_t size, int *loaded)
{
	static char text[ROOM];
	ob_error e = { "" };
	memcpy(text, original, size);
	for (size_t n = 1 + below(r, 4); n > 0 && size > 0; n--)
		size = damage(r, text, size);
	ob_scene *s = load_bytes(text, size, NULL, &e);
	bool good = s ? s->objects > 0 && s->cameras > 0 : e.text[0] && !strchr(e.text, '\n');
	CHECK(good);
	if (!good)
		fprintf(stderr, "  error: %s\n  text: %.*s\n", e.text, (int)size, text);
	*loaded += s != NULL;
	ob_scene_free(s);
}

int main(int argc, char **argv)
{
	const long count = argc > 3 ? atol(argv[3]) : 600;
	ob_random r;
	int loaded = 0, runs = 0;
	ob_random_seed(&r, argc > 4 ? strtoull(argv[4], NULL, 10) : 11);
	ob_log_set_notes(0);
	for (size_t k = 0; k < sizeof seeds / sizeof *seeds; k++) {
		char path[1024], original[ROOM];
		snprintf(path, sizeof path, "%s/%s.lua", argc > 2 ? argv[2] : "scenes", seeds[k]);
		FILE *f = fopen(path, "r");
		size_t size = f ? fread(original, 1, ROOM, f) : 0;
		if (f)
			fclose(f);
		CHECK(size > 100 && size < ROOM);
		for (long i = 0; size && i < count; i++, runs++)
			check_one(&r, original, size, &loaded);
	}
	printf("%d of %d damaged scenes load\n", loaded, runs);
	CHECK(loaded > runs / 20 && loaded < runs);
	return check_end();
}
