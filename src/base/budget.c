#include "base/budget.h"

#include <inttypes.h>
#include <malloc.h>

bool ob_budget_allows(uint64_t bytes, ob_error *e)
{
	const struct mallinfo2 now = mallinfo2();
	const uint64_t held = now.uordblks + now.hblkhd;
	return (bytes <= OB_BUDGET_BYTES && held <= OB_BUDGET_BYTES - bytes) ||
	       ob_fail(e, "it needs more than %" PRIu64 " MiB of memory", OB_BUDGET_BYTES >> 20);
}
