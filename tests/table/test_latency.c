#include "../check.h"
#include "table/counters.h"

int main(void)
{
	static ob_latency l;
	CHECK(ob_latency_percentile(&l, .5) == 0);
	for (int i = 1; i <= 1000; i++)
		ob_latency_add(&l, i * 1e-5);
	CHECK_NEAR(ob_latency_percentile(&l, .5) / 5e-3, 1, .011);
	CHECK_NEAR(ob_latency_percentile(&l, .99) / 9.9e-3, 1, .011);
	CHECK_NEAR(ob_latency_percentile(&l, 1) / 1e-2, 1, .011);
	CHECK_NEAR(ob_latency_percentile(&l, 0) / 1e-5, 1, .011);
	for (int i = 0; i < 10000; i++)
		ob_latency_add(&l, 2e-6); // ten thousand short ones move the median, not the maximum
	CHECK_NEAR(ob_latency_percentile(&l, .5) / 2e-6, 1, .011);
	CHECK_NEAR(ob_latency_percentile(&l, 1) / 1e-2, 1, .011);
	ob_latency_add(&l, 1e9); // beyond the last bin, and before the first
	ob_latency_add(&l, -1);
	CHECK(ob_latency_percentile(&l, 1) > 200);
	CHECK(ob_latency_percentile(&l, 0) < 2e-7);
	return check_end();
}
