// The example program, as another process, reads a universe made by this one, by its name alone.
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "../check.h"
#include "table/table.h"

static void place(ob_universe *u, uint32_t id, const char *name, ob_vec3 p, ob_vec3 v)
{
	ob_passport passport = { .id = id,
				 .flags = OB_OBJECT_PRESENT,
				 .shape = OB_SHAPE_SPHERE,
				 .size = { .5, 0, 0 },
				 .mass = 2,
				 .inertia = { .2, .2, .2 },
				 .friction = .5 };
	snprintf(passport.name, sizeof passport.name, "%s", name);
	ob_write_passport(u, id, &passport);
	ob_motion m = { .valid_until = 10, .p = p, .q = ob_quat_identity(), .v = v, .flags = OB_MOTION_FREE };
	ob_publish_motion(u, id, &m);
}

// Runs watch; returns its wait status, with its output in text.
static int watch(const char *program, const char *universe, char *text, size_t size)
{
	char command[4096];
	snprintf(command, sizeof command, "'%s' '%s' 2>&1", program, universe);
	FILE *f = popen(command, "r");
	if (!f)
		return -1;
	size_t n = fread(text, 1, size - 1, f);
	text[n] = 0;
	return pclose(f);
}

int main(int argc, char **argv)
{
	if (argc != 2)
		return 2;
	char name[OB_NAME_MAX], text[4096];
	snprintf(name, sizeof name, "watch-%d", getpid());
	ob_error e = { "" };
	ob_universe_setup setup = { .name = name,
				    .capacity = 8,
				    .workers = 1,
				    .isolation = "thread",
				    .run = { .gravity = { 0, 0, -9.81 }, .step_length = 1. / 64, .substeps = 4 } };
	ob_universe *u = ob_universe_create(&setup, &e);
	if (!u) {
		fprintf(stderr, "%s\n", e.text);
		return 1;
	}
	place(u, 1, "ball", ob_v3(1, 2, 3), ob_v3(64, 0, -32));
	place(u, 4, "far", ob_v3(-1e3, 0, .25), ob_v3(0, 0, 0));
	ob_step_complete(u, 2, 0, 2); // the clock now stands at one step: motions are evaluated there

	CHECK(watch(argv[1], name, text, sizeof text) == 0);
	CHECK(strstr(text, "1 ball 2.000000 2.000000 2.500000\n"));
	CHECK(strstr(text, "4 far -1000.000000 0.000000 0.250000\n"));
	CHECK(!strstr(text, "\n0 ") && !strstr(text, "\n2 ")); // free ids
	ob_universe_destroy(u, true);

	CHECK(watch(argv[1], name, text, sizeof text) != 0); // the universe is gone, and watch reports it
	CHECK(strstr(text, name));
	return check_end();
}
