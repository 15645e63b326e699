// Objects at the corners of what is allowed (scene/object_limits.h), among usual ones: none makes a number of anybody
// diverge. What takes too much work is frozen, and the run goes on.
//
//   test_host_corners [fast]    fast: as fast as they may be, too, and under a tolerance; takes an hour or more
#include <stdlib.h>
#include <string.h>

#include "base/sanitizer.h"
#include "check.h"
#include "host/host.h"
#include "scene/object_limits.h"

enum { STEPS = 12 };

static const char neighbours[] =
	"ground {}\n"
	"for x = 0, 1 do for z = 0, 1 do box { size = { .4, .4, .4 }, at = { .5 * x, 0, .2 + .4 * z } } end end\n"
	"sphere { radius = .3, at = { .02, .03, 1.1 } }\n"
	"cylinder { radius = .2, length = .5, at = { 1.5, 0, .25 } }\n"
	"capsule { radius = .2, length = .5, at = { -1, 0, .45 } }\n"
	"hull { points = { {.3,0,-.1}, {-.3,.3,-.1}, {-.3,-.3,-.1}, {0,0,.3} }, at = { 0, 1, .1 } }\n";

// A shape with its extents (m), as a scene says it.
typedef struct corner {
	char text[200];
	double below; // m, from its lowest point to its centre
	double radius; // m
} corner;

static const double lengths[] = { OB_LENGTH_LEAST, OB_LENGTH_LEAST *OB_SLENDERNESS_MOST, 1,
				  OB_LENGTH_MOST / OB_SLENDERNESS_MOST, OB_LENGTH_MOST };

static bool slender(double a, double b, double c)
{
	return fmax(a, fmax(b, c)) > OB_SLENDERNESS_MOST * fmin(a, fmin(b, c));
}

// Returns how many there are.
static int find_corners(corner out[200])
{
	int n = 0;
	for (int i = 0; i < 125; i++) {
		const double a = lengths[i / 25], b = lengths[i / 5 % 5], c = lengths[i % 5];
		if (!slender(a, b, c)) {
			out[n] = (corner){ .below = c / 2, .radius = sqrt(a * a + b * b + c * c) / 2 };
			snprintf(out[n++].text, sizeof out->text, "box { size = { %g, %g, %g }", a, b, c);
		}
		if (i >= 25) // each of b and c once
			continue;
		if (!slender(b, c / 2, b)) {
			out[n] = (corner){ .below = c / 2, .radius = b + c / 2 };
			snprintf(out[n++].text, sizeof out->text, "cylinder { radius = %g, length = %g", b, c);
		}
		if (!slender(b, b + c / 2, b)) {
			out[n] = (corner){ .below = b + c / 2, .radius = b + c / 2 };
			snprintf(out[n++].text, sizeof out->text, "capsule { radius = %g, length = %g", b, c);
		}
	}
	for (int i = 0; i < 5; i++) {
		const double r = lengths[i], s = fmin(fmax(r, 2e-6), 6e5);
		out[n] = (corner){ .below = r, .radius = r };
		snprintf(out[n++].text, sizeof out->text, "sphere { radius = %g", r);
		out[n] = (corner){ .below = s / 2, .radius = 1.5 * s };
		snprintf(out[n++].text, sizeof out->text,
			 "hull { points = { {%g,0,%g}, {%g,%g,%g}, {%g,%g,%g}, {0,0,%g} }", s, -s / 2, -s / 2, s,
			 -s / 2, -s / 2, -s, -s / 2, s);
	}
	return n;
}

static bool fast; // a tolerance would then choose more substeps than a step may take

// Falls onto its neighbours, or is thrown at them.
static void run(const corner *c, double mass, double speed, double spin, double restitution)
{
	char *text;
	ob_error e = { "" };
	const int bytes = asprintf(
		&text,
		"%s%s, mass = %g, restitution = %g, at = { .02, .03, %.17g }, velocity = { 0, 0, %g }, spin = { %g, "
		"%g, %g } }",
		neighbours, c->text, mass, restitution, c->below + 1.41, -speed, .6 * spin, .5 * spin, .4 * spin);
	CHECK(bytes > 0);
	if (bytes < 0)
		return;
	ob_scene *s = ob_scene_load_text("corner.lua", text, strlen(text), NULL, &e);
	CHECK(s && ob_run_settings_resolve(&s->run, NULL, &e));
	ob_host_config config = { .isolation = OB_ISOLATION_THREAD, .workers = 1, .on_death = OB_ON_DEATH_FREEZE };
	if (s)
		config.run = s->run;
	if (!fast)
		config.run.tolerance = 0, config.run.substeps = 4, config.run.iterations = 8;
	ob_host *h = s ? ob_host_start(s, &config, &e) : NULL;
	CHECK(h);
	if (h) {
		ob_universe_info info;
		ob_host_go(h, STEPS);
		CHECK(ob_host_wait(h, &e));
		ob_universe_get_info(ob_host_universe(h), &info);
		CHECK(info.step == STEPS && !strstr(info.last_death, "diverged"));
		if (strstr(info.last_death, "diverged"))
			fprintf(stderr, "%s\n%s\n", info.last_death, text);
	}
	if (e.text[0])
		fprintf(stderr, "%s\n%s\n", e.text, text);
	ob_host_stop(h);
	ob_scene_free(s);
	free(text);
}

int main(int argc, char **argv)
{
	const double masses[] = { OB_MASS_LEAST, 1, OB_MASS_MOST };
	corner c[200];
	fast = argc > 1 && strcmp(argv[1], "fast") == 0;
	const int n = find_corners(c);
	for (int i = 0; i < n; i++) // under sanitizers with one mass each
		for (int m = OB_SANITIZED ? i % 3 : 0; m < 3; m += OB_SANITIZED ? 3 : 1)
			for (int k = 0; k < (fast ? 8 : 1); k++) {
				const double spin = fmin(OB_SPIN_MOST, .9 * OB_SPEED_MOST / c[i].radius);
				run(&c[i], masses[m], k & 1 ? OB_SPEED_MOST : 0, k & 2 ? spin : 0, k >> 2);
			}
	printf("%d shapes\n", n);
	return check_end();
}
