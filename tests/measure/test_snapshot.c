// Snapshots of a real universe: contents, missing objects, implausible data.
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "measure/measure.h"
#include "table/table.h"

#include "../check.h"

static void add(ob_universe *u, uint32_t id, double x)
{
	ob_passport p = { .id = id,
			  .generation = 1,
			  .flags = OB_OBJECT_PRESENT,
			  .shape = OB_SHAPE_SPHERE,
			  .size = { .5, 0, 0 },
			  .mass = 1,
			  .inertia = { .1, .1, .1 },
			  .name = "ball" };
	ob_motion m = { .p = { x, 0, 0 }, .q = ob_quat_identity(), .valid_until = 1 };
	ob_publish_motion(u, id, &m);
	ob_write_passport(u, id, &p);
}

int main(void)
{
	char name[32];
	snprintf(name, sizeof name, "test-snapshot-%d", (int)getpid());
	ob_universe_setup setup = { .name = name,
				    .capacity = 8,
				    .workers = 1,
				    .isolation = "thread",
				    .run = { .step_length = .5, .substeps = 1 } };
	ob_error e = { "" };
	ob_universe *u = ob_universe_create(&setup, &e);
	CHECK(u);
	if (!u)
		return check_end();
	add(u, 0, 1);
	add(u, 5, 6);
	ob_step_complete(u, 2, 0, 0);
	ob_snapshot s = { 0 }, copy = { 0 };
	CHECK(ob_snapshot_take(&s, u, OB_SNAPSHOT_CONTACTS, &e));
	CHECK(s.count == 8 && s.step == 1 && s.contacts == 0);
	CHECK_NEAR(s.time, .5, 0);
	for (uint32_t id = 0; id < 8; id++)
		CHECK((s.passport[id].flags & OB_OBJECT_PRESENT) == (id == 0 || id == 5));
	CHECK(strcmp(s.passport[5].name, "ball") == 0);
	CHECK_NEAR(s.motion[5].p.x, 6, 0);

	uint64_t hash = ob_measure_hash(&s);
	CHECK(ob_snapshot_copy(&copy, &s));
	CHECK(ob_measure_hash(&copy) == hash);
	s.motion[5].p.x = s.state[5].pose.p.x = 7;
	CHECK(ob_measure_hash(&copy) == hash && ob_measure_hash(&s) != hash); // the copy's memory is its own
	CHECK_NEAR(copy.motion[5].p.x, 6, 0);

	ob_passport gone = *ob_passport_of(u, 0);
	gone.flags = 0;
	ob_write_passport(u, 0, &gone);
	CHECK(ob_snapshot_take(&s, u, 0, &e));
	CHECK(s.passport[0].flags == 0 && s.passport[5].flags == OB_OBJECT_PRESENT);

	ob_motion broken = *ob_newest_motion(u, 5);
	broken.p.y = NAN;
	ob_publish_motion(u, 5, &broken);
	CHECK(!ob_snapshot_take(&s, u, 0, &e));
	CHECK(strstr(e.text, "object 5") && strstr(e.text, "ball"));
	ob_snapshot_finish(&s);
	ob_snapshot_finish(&copy);
	CHECK(!s.passport && !s.count_max);
	ob_universe_destroy(u, true);
	return check_end();
}
