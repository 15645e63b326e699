#include "base/budget.h"

#include <inttypes.h>
#include <malloc.h>

static _Thread_local uint32_t depth; // files that the thread reads, one within the other
static _Thread_local uint64_t held_before = UINT64_MAX; // bytes, as it began with the first

static uint64_t held_now(void)
{
	const struct mallinfo2 now = mallinfo2();
	return now.uordblks + now.hblkhd;
}

void ob_budget_begin(void)
{
	if (depth++ == 0)
		held_before = held_now();
}

void ob_budget_end(void)
{
	if (--depth == 0)
		held_before = UINT64_MAX;
}

bool ob_budget_allows(uint64_t bytes, ob_error *e)
{
	const uint64_t now = held_now(), held = now > held_before ? now - held_before : 0;
	return (bytes <= OB_BUDGET_BYTES && held <= OB_BUDGET_BYTES - bytes) ||
	       ob_fail(e, "it needs more than %" PRIu64 " MiB of memory", OB_BUDGET_BYTES >> 20);
}
