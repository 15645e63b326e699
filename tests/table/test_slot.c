// Slot torture, short: argument "threads", "processes" or "killed". TORTURE=publishes overrides the length.
#include "../check.h"

#include <stdlib.h>
#include <string.h>

#include "torture.h"

int main(int argc, char **argv)
{
	const char *kind = argc > 1 ? argv[1] : "threads", *length = getenv("TORTURE");
	uint64_t publishes = length ? strtoull(length, NULL, 10) : 2000000;
	torture_result r = strcmp(kind, "killed") == 0 ? torture_run_killed(4, 60)
						       : torture_run(strcmp(kind, "processes") == 0, 4, publishes);
	CHECK(r.torn == 0);
	CHECK(r.backward == 0);
	CHECK(r.refused == 0);
	CHECK(r.failed == 0);
	CHECK(r.published > 1000 && r.read > 1000);
	printf("%s: %llu published, %llu read, %.1f s\n", kind, (unsigned long long)r.published,
	       (unsigned long long)r.read, r.seconds);
	return check_end();
}
