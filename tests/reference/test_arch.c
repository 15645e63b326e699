// Least thickness of an arch: against the known limit of many voussoirs, and by necessary conditions.
#include "check.h"
#include "reference/arch.h"

int main(void)
{
	CHECK_NEAR(ob_reference_arch_thickness(400, 1), .1075, 5e-5); // Milankovitch 1907
	CHECK_NEAR(ob_reference_arch_thickness(20, 5) / ob_reference_arch_thickness(20, 1), 5, 1e-9);
	// fewer joints, fewer ways to fail
	CHECK(ob_reference_arch_thickness(8, 1) < ob_reference_arch_thickness(400, 1));
	CHECK(ob_reference_arch_thickness(4, 1) < ob_reference_arch_thickness(8, 1));
	return check_end();
}
