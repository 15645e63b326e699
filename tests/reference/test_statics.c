// What stands: centres of mass and torques, added up body by body.
#include "reference/statics.h"

#include "check.h"

// Above every edge the centre of all bricks higher up lies right over it.
static void test_overhang(void)
{
	CHECK_NEAR(ob_reference_overhang(4), 25. / 24, 1e-15);
	CHECK(ob_reference_overhang(0) == 0);
	for (int n = 1; n <= 50; n++) {
		double left[51], end = 0; // left ends; brick 1 is the top, the table's edge is at 0
		for (int k = n; k >= 1; k--) {
			end += ob_reference_overhang_shift(k);
			left[k] = end - 1;
		}
		CHECK_NEAR(ob_reference_overhang(n), end, 1e-14);
		for (int k = 1; k <= n; k++) {
			double centre = 0, edge = k < n ? left[k + 1] + 1 : 0;
			for (int i = 1; i <= k; i++)
				centre += (left[i] + .5) / k;
			CHECK_NEAR(centre, edge, 1e-14);
		}
	}
}

// Forces and torques of one card from its corners' coordinates: the push that keeps it from turning about its foot,
// over its weight.
static double push_of(double angle, double length, double thickness)
{
	double along[2] = { sin(angle), cos(angle) }, out[2] = { -cos(angle), sin(angle) };
	double top[2], centre[2];
	for (int c = 0; c < 2; c++) {
		top[c] = length * along[c];
		centre[c] = .5 * (top[c] + thickness * out[c]);
	}
	return centre[0] / top[1];
}

static void test_cards(void)
{
	for (int i = 1; i < 30; i++) {
		double angle = .05 * i;
		CHECK_NEAR(ob_reference_cards_grip(angle, 1, 0), .5 * tan(angle), 1e-12);
		CHECK_NEAR(ob_reference_cards_grip(angle, .9, .01), push_of(angle, .9, .01), 1e-12);
		CHECK_NEAR(ob_reference_cards_grip(angle, 2, .3), push_of(angle, 2, .3), 1e-12);
	}
	CHECK(ob_reference_cards_grip(atan(.1), 1, .1) < 1e-15); // the centre stands over the foot
}

int main(void)
{
	test_overhang();
	test_cards();
	return check_end();
}
