// Each hint about a concept of other simulators is true: what it names works, and what it says obsim lacks is no field.
// argv[1]: the source of the hints, so that none is left out.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "text.h"

#define BODIES \
	"box { name = 'a', size = { .1, .1, .1 }, at = { 0, 0, 2 } }\n" \
	"box { name = 'b', size = { .1, .1, .1 }, at = { 1, 0, 2 } }\n"
#define JOINTS \
	BODIES "ball { 'a', 'b', at = { 0, 0, 2 } }\nhinge { 'a', at = { 0, 0, 2 }, axis = { 0, 0, 1 } }\n" \
	       "slider { 'a', axis = { 0, 0, 1 } }\nfixed { 'a', 'b' }\ndistance { 'a', 'b' }\n" \
	       "universal { 'a', 'b', at = { 0, 0, 2 }, axis = { 0, 0, 1 }, across = { 1, 0, 0 } }"
#define TORUS "compound { parts = { { shape = 'capsule', radius = .1, length = 1, at = { 1, 0, 0 } } } }"
#define POINTS "hull { points = { { 0, 0, 1 }, { 1, 0, 0 }, { -1, 1, 0 }, { -1, -1, 0 } } }"
#define FIELD "heightfield { size = { 4, 4 }, cells = { 4, 4 }, height = function(x, y) return .1 * x * y end }"

// A word, and a scene that uses what its hint names.
static const char *const example[][2] = {
	{ "joint", JOINTS },
	{ "constraint", JOINTS },
	{ "revolute", BODIES "hinge { 'a', 'b', at = { 0, 0, 2 }, axis = { 0, 0, 1 } }" },
	{ "prismatic", BODIES "slider { 'a', 'b', axis = { 0, 0, 1 } }" },
	{ "weld", BODIES "fixed { 'a', 'b' }" },
	{ "motor", BODIES "hinge { 'a', 'b', at = { 0, 0, 2 }, axis = { 0, 0, 1 }, motor = { rate = 5 } }" },
	{ "spring", BODIES "distance { 'a', 'b', stiffness = 100, damping = 5 }" },
	{ "rope",
	  BODIES "distance { 'a', 'b', high = 2 }\ncapsule { name = 'c', radius = .1, length = 1, at = { 3, 0, 2 } }\n"
		 "ball { 'c', 'b', at = { 3, 0, 2 } }" },
	{ "cloth", "box { size = { 1, 1, 1 } }" },
	{ "fluid", "box { size = { 1, 1, 1 } }" },
	{ "cone", POINTS },
	{ "ellipsoid", POINTS },
	{ "torus", TORUS },
	{ "terrain", FIELD },
	{ "trimesh", FIELD }, // and a file, which test_files has
	{ "light", "ground {}\nsun { towards = { 0, 0, 1 } }" },
};
enum { EXAMPLES = sizeof example / sizeof *example };

static const char *const lacking[] = { "box { size = { 1, 1, 1 }, %s = 1 }",
				       BODIES "hinge { 'a', at = { 0, 0, 2 }, axis = { 0, 0, 1 }, %s = 1 }",
				       BODIES "distance { 'a', 'b', %s = 1 }", "scene { %s = 1 }", "%s { }" };

static void check_message(const char *text, const char *expected)
{
	ob_error e = { "" };
	ob_scene *s = load_text(text, &e);
	const bool good = !s && strstr(e.text, expected);
	CHECK(good);
	if (!good)
		fprintf(stderr, "  %s\n  expected %s\n  got %s\n", text, expected, s ? "a scene" : e.text);
	ob_scene_free(s);
}

static void check_hint(const char *word, const char *hint)
{
	char text[600], plural[64];
	int i = 0;
	while (i < EXAMPLES && strcmp(example[i][0], word) != 0)
		i++;
	CHECK(i < EXAMPLES);
	ob_scene *s = i < EXAMPLES ? load_good(example[i][1]) : NULL;
	CHECK(s);
	if (!s)
		fprintf(stderr, "  %s has no example that loads\n", word);
	ob_scene_free(s);
	snprintf(text, sizeof text, "%s { }", word);
	check_message(text, hint);
	snprintf(plural, sizeof plural, "%ss { }", word);
	check_message(plural, hint);
	for (size_t k = 0; strstr(hint, "obsim has no") && k < sizeof lacking / sizeof *lacking; k++) {
		snprintf(text, sizeof text, lacking[k], word);
		check_message(text, "unknown");
	}
}

int main(int argc, char **argv)
{
	FILE *f = argc > 1 ? fopen(argv[1], "r") : NULL;
	char line[300];
	int hints = 0;
	bool inside = false;
	while (f && fgets(line, sizeof line, f)) {
		char word[32], hint[200];
		inside = inside ? strncmp(line, "};", 2) != 0 : strstr(line, " foreign[][2]") != NULL;
		if (!inside || strstr(line, " foreign[][2]"))
			continue;
		CHECK(sscanf(line, " { \"%31[^\"]\", \"%199[^\"]\" }", word, hint) == 2);
		check_hint(word, hint);
		hints++;
	}
	if (f)
		fclose(f);
	CHECK(hints == EXAMPLES);
	return check_end();
}
