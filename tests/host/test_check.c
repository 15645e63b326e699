// A checked run ends where the simulators' shared state is wrong, and explains it; a correct one ends in the same bits
// as an unchecked one.
#include <string.h>

#include "check.h"
#include "host/host.h"
#include "little_scene.h"
#include "measure/measure.h"

enum { BALLS = 30, STEPS = 150 };

// false and e as ob_host_wait. damage: changes a link of the first ball's list of contacts half way. hash: at the end
static bool run(const ob_host_config *c, bool damage, uint64_t *hash, bool *broken, ob_error *e)
{
	ob_scene s = falling_heap(BALLS);
	ob_host *h = ob_host_start(&s, c, e);
	if (!h) {
		free(s.object);
		return false;
	}
	ob_host_go(h, STEPS / 2);
	bool fine = ob_host_wait(h, e);
	if (damage)
		ob_universe_step_data(ob_host_universe(h))->first_pair[1] ^= 2;
	ob_host_go(h, STEPS);
	fine = fine && ob_host_wait(h, e);
	*broken = ob_host_broke_invariant(h);
	ob_snapshot now = { 0 };
	if (fine && ob_snapshot_take(&now, ob_host_universe(h), 0, e))
		*hash = ob_measure_hash(&now);
	ob_snapshot_finish(&now);
	ob_host_stop(h);
	free(s.object);
	return fine;
}

static void test(ob_isolation isolation, uint32_t workers, uint32_t harden)
{
	ob_scene s = { .run = { .gravity = ob_v3(0, 0, -9.81), .step_length = .01 } };
	ob_host_config c = little_config(&s, isolation, workers);
	uint64_t unchecked = 0, checked = 1;
	bool broken;
	ob_error e = { "" };
	c.harden = harden;
	CHECK(run(&c, false, &unchecked, &broken, &e) && !broken);
	c.check = true;
	CHECK(run(&c, false, &checked, &broken, &e) && !broken && checked == unchecked);
	CHECK(!run(&c, true, &checked, &broken, &e) && broken);
	CHECK(strstr(e.text, "when 75 steps are complete: object ") && strstr(e.text, "list of pairs"));
	if (check_failed)
		fprintf(stderr, "%s\n", e.text);
}

int main(void)
{
	test(OB_ISOLATION_THREAD, 2, 0);
	test(OB_ISOLATION_PROCESS, 2, 0);
	test(OB_ISOLATION_PROCESS, 2, OB_HARDEN_ALL);
	return check_end();
}
