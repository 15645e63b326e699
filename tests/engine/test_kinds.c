// List of engines: found by name, each with all data for a legend and a sweep, and all different.
#include <stdlib.h>
#include <string.h>

#include "little_world.h"

#include "../check.h"

// A collapsing heap shows any difference between two engines.
static void differ(void)
{
	static ob_state end[24][LITTLE_MOST];
	little_world *l = little_world_new();
	little_ground(l);
	for (int i = 0; i < 6; i++)
		little_cube(l, 1 + i, .25, ob_v3(.1 * (i % 2), .05 * i, .3 + .55 * i));
	size_t kinds = 0;
	for (; ob_engine_kinds[kinds]; kinds++) {
		little_run(ob_engine_kinds[kinds], l, 0, 1);
		memcpy(end[kinds], l->now, sizeof l->now);
		for (size_t other = 0; other < kinds; other++)
			CHECK(memcmp(end[kinds], end[other], sizeof l->now) != 0);
	}
	CHECK(kinds >= 7);
	little_world_free(l);
}

int main(void)
{
	differ();
	CHECK(!ob_engine_find("no-such-engine"));
	CHECK(ob_engine_find("obsim") == ob_engine_kinds[0]);
	for (const ob_engine_kind *const *k = ob_engine_kinds; *k; k++) {
		CHECK(ob_engine_find((*k)->name) == *k);
		CHECK((*k)->title && (*k)->title[0] && (*k)->version);
		CHECK((*k)->usual.step_length > 0 && (*k)->usual.substeps > 0);
		bool usual_is_a_choice = !(*k)->usual.iterations;
		for (int i = 0; (*k)->iteration_choice[i]; i++) {
			CHECK(i < 7); // 0 ends the list
			CHECK(!i || (*k)->iteration_choice[i] > (*k)->iteration_choice[i - 1]);
			usual_is_a_choice |= (*k)->iteration_choice[i] == (*k)->usual.iterations;
		}
		CHECK(usual_is_a_choice);
		CHECK((*k)->create && (*k)->step && (*k)->get && (*k)->destroy);
	}
	return check_end();
}
