// Slot torture, long: 4 threads, then 4 processes read 1e8 publications (or the number given), then 4 processes whose
// writer is killed 500 times. Exits 1 if a copy was torn, went backward, or was refused.
#include <stdio.h>
#include <stdlib.h>

#include "../tests/table/torture.h"

static int report(const char *what, torture_result r)
{
	printf("%-16s %11llu published %12llu read  torn %llu  backward %llu  refused %llu  failed %llu  %.1f s\n",
	       what, (unsigned long long)r.published, (unsigned long long)r.read, (unsigned long long)r.torn,
	       (unsigned long long)r.backward, (unsigned long long)r.refused, (unsigned long long)r.failed, r.seconds);
	fflush(stdout);
	return r.torn || r.backward || r.refused || r.failed;
}

int main(int argc, char **argv)
{
	uint64_t publishes = argc > 1 ? strtoull(argv[1], NULL, 10) : 100000000;
	int bad = report("threads", torture_run(false, 4, publishes));
	bad |= report("processes", torture_run(true, 4, publishes));
	bad |= report("killed writers", torture_run_killed(4, 500));
	return bad;
}
