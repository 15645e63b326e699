// A scene with terrain as readers see it: snapshots of the host's own universe, and of one attached as another program does.
#include "../check.h"
#include "little_scene.h"

#include <string.h>
#include <unistd.h>

#include "measure/measure.h"

enum { BALLS = 9, CELLS = 8 };
static const double size = 6; // m, of the terrain

// Balls above hills.
static ob_scene hilly_scene(void)
{
	double height[CELLS + 1][CELLS + 1];
	ob_error e;
	for (int y = 0; y <= CELLS; y++)
		for (int x = 0; x <= CELLS; x++)
			height[y][x] = .2 * sin(x) * cos(y);
	ob_terrain *t = ob_terrain_of_heights(height[0], (uint32_t[2]){ CELLS, CELLS }, (double[2]){ size, size }, &e);
	ob_scene s = little_scene(BALLS);
	CHECK(t && ob_terrain_set_add(&s.terrains, t, &e));
	ob_passport *p = &s.object[0].passport;
	p->shape = OB_SHAPE_TERRAIN;
	p->size = ob_terrain_size(t);
	for (uint32_t i = 1; i <= BALLS; i++)
		s.object[i].state.pose.p = ob_v3(i % 3 - 1., i / 3 - 2., .5);
	free(t);
	return s;
}

static void check_snapshot(const ob_universe *u, const ob_scene *s)
{
	ob_snapshot shot = { 0 };
	ob_error e;
	for (int i = 0; i < 2; i++) { // the second has them already
		CHECK(ob_snapshot_take(&shot, u, OB_SNAPSHOT_CONTACTS | OB_SNAPSHOT_BOUNDS, &e));
		CHECK(shot.terrains && shot.terrains->bytes == s->terrains->bytes &&
		      memcmp(shot.terrains, s->terrains, s->terrains->bytes) == 0);
	}
	ob_snapshot_finish(&shot);
}

static void test_readers(ob_isolation isolation)
{
	ob_scene s = hilly_scene();
	ob_host_config c = little_config(&s, isolation, 2);
	char name[32];
	ob_error e = { "" };
	snprintf(name, sizeof name, "test-terrain-%d", (int)getpid());
	c.name = name;
	ob_host *h = ob_host_start(&s, &c, &e);
	ob_universe *r = h ? ob_universe_attach(name, &e) : NULL;
	CHECK(r != NULL);
	for (uint64_t step = 0; r && step <= 60; step += 20) {
		ob_host_go(h, step);
		CHECK(ob_host_wait(h, &e) && steps_of(h) == step);
		check_snapshot(ob_host_universe(h), &s);
		check_snapshot(r, &s);
	}
	if (r) {
		char some[8];
		CHECK(ob_universe_get_terrains(r, some, sizeof some) == s.terrains->bytes);
		CHECK(memcmp(some, s.terrains, sizeof some) == 0);
		ob_universe_detach(r);
	}
	if (h)
		ob_host_stop(h);
	free(s.terrains);
	free(s.object);
}

int main(void)
{
	test_readers(OB_ISOLATION_THREAD);
	test_readers(OB_ISOLATION_PROCESS);
	return check_end();
}
