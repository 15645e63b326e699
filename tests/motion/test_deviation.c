// The deviation that a motion carries: it grows with its rate, says the same of a second's end at each step, ends with the
// second, and is no smaller after a hit.
#include "check.h"
#include "motion/deviation.h"

static const double h = 1. / 60; // s
static const double coded = 1.001; // factor by which a code may round up

// A motion published at a step says of the second's end what it says of it at any later step of the same second.
static void check_growth(uint32_t published, ob_deviation d)
{
	ob_motion m = { .step = published };
	ob_deviation_put(&m, d);
	const double end = ob_deviation_of_second(d, published, h);
	for (uint32_t n = published; n % 60 || n == published; n++) {
		const ob_deviation at = ob_deviation_at(&m, n, h);
		const double said = ob_deviation_of_second(at, n, h);
		CHECK(said >= end * (1 - 1e-12) && said <= end * coded);
		CHECK(at.place >= d.place + (n - published) * h * d.rate * (1 - 1e-12));
	}
	const uint32_t last = (published + 59) / 60 * 60; // step that ends the second
	CHECK_NEAR(ob_deviation_at(&m, last, h).place, end, end * (coded - 1));
	for (uint32_t n = last + 1; n < last + 130; n++)
		CHECK(ob_deviation_at(&m, n, h).place == 0 && ob_deviation_at(&m, n, h).rate == 0);
}

static void check_hit(ob_deviation most, double change, double radius)
{
	const ob_deviation after = ob_deviation_after_hit(most, change, radius);
	CHECK(after.place >= most.place && after.rate >= most.rate);
	CHECK(after.rate <= most.rate + 2 * change); // it may leave the other way at worst
}

int main(void)
{
	for (uint32_t step = 1; step <= 121; step += 8) {
		check_growth(step, (ob_deviation){ 1e-4, 0 });
		check_growth(step, (ob_deviation){ 1e-9, 3e-3 });
		check_growth(step, (ob_deviation){ 2e-3, 5 });
	}
	check_hit((ob_deviation){ 1e-6, 1e-5 }, 3, .1);
	check_hit((ob_deviation){ 10, 1e-5 }, 3, .1);
	check_hit((ob_deviation){ 1e-6, 1e-5 }, 3, 0); // whatever it hits with
	return check_end();
}
