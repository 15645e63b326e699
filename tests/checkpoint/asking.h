// Requests of tests of checkpoints.
#ifndef TESTS_CHECKPOINT_ASKING_H
#define TESTS_CHECKPOINT_ASKING_H

#include <stdio.h>

#include "check.h"
#include "host/host.h"

// Asks for a change of an object of the first generation, which must be accepted.
static void ask(ob_host *h, ob_request r)
{
	ob_error e = { "" };
	r.generation = 1;
	const bool fine = ob_host_ask(h, &r, &e);
	if (!fine)
		fprintf(stderr, "%s\n", e.text);
	CHECK(fine);
}

#endif
