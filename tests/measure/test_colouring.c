// Colours by who simulates: equal for members of a group, different across groups.
#include "check.h"

#include <math.h>
#include <string.h>

#include "measure/colouring.h"

enum { OBJECTS = 6 };
static ob_passport passport[OBJECTS];
static ob_motion motion[OBJECTS];
static uint32_t home[OBJECTS] = { UINT32_MAX, 0, 1, 2, 2, UINT32_MAX };
static double own_time[OBJECTS] = { NAN, 2, 2.01, 2.01, 3, NAN };
static const ob_worker_place place[] = { { 100, 0 }, { 101, 0 }, { 101, 1 } };

static bool alike(ob_colour_key key, uint32_t a, uint32_t b)
{
	const ob_snapshot s = {
		.time = 2, .count = OBJECTS, .passport = passport, .motion = motion, .home = home, .own_time = own_time
	};
	const ob_colouring c = { key, place, 3 };
	float of_a[3], of_b[3];
	ob_colouring_of(&c, &s, a, of_a);
	ob_colouring_of(&c, &s, b, of_b);
	for (int i = 0; i < 3; i++)
		CHECK(of_a[i] >= 0 && of_a[i] <= 1);
	return memcmp(of_a, of_b, sizeof of_a) == 0;
}

int main(void)
{
	passport[0].flags = OB_OBJECT_STATIC;
	for (uint32_t i = 0; i < OBJECTS; i++)
		motion[i].island = i / 2;
	motion[1].flags = OB_MOTION_ASLEEP;
	motion[2].substeps = 4;
	motion[3].substeps = 64;
	CHECK(alike(OB_COLOUR_OWN, 0, 3) && !alike(OB_COLOUR_SIMULATOR, 3, 4));
	CHECK(alike(OB_COLOUR_WORKER, 3, 4) && !alike(OB_COLOUR_WORKER, 2, 3));
	CHECK(alike(OB_COLOUR_PROCESS, 2, 3) && !alike(OB_COLOUR_PROCESS, 1, 2));
	CHECK(alike(OB_COLOUR_RANK, 1, 2) && !alike(OB_COLOUR_RANK, 2, 3));
	CHECK(alike(OB_COLOUR_WORKER, 0, 5)); // none is known
	CHECK(alike(OB_COLOUR_LAG, 2, 3) && !alike(OB_COLOUR_LAG, 1, 2) && !alike(OB_COLOUR_LAG, 3, 4));
	CHECK(alike(OB_COLOUR_LAG, 0, 5) && ob_share_of_lead(0) == 0 && ob_share_of_lead(1) == 1);
	CHECK(alike(OB_COLOUR_ISLAND, 2, 3) && !alike(OB_COLOUR_ISLAND, 3, 4));
	CHECK(alike(OB_COLOUR_REST, 2, 3) && !alike(OB_COLOUR_REST, 1, 2));
	CHECK(!alike(OB_COLOUR_COST, 2, 3) && alike(OB_COLOUR_COST, 0, 1));
	return check_end();
}
