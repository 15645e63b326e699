// The one list of cases, in the order of their rows. Each stands in a file of its group in this folder.
#ifndef OB_LAB_CASES_CASES_H
#define OB_LAB_CASES_CASES_H

#include "lab/case.h"

#define OB_CASES(X) \
	X(projectile) \
	X(head_on) \
	X(cradle_1) \
	X(cradle_2) \
	X(bounce) \
	X(apexes) \
	X(bouncing_49)

#define OB_CASE_DECLARE(name) extern const ob_case ob_case_##name;
OB_CASES(OB_CASE_DECLARE)
#undef OB_CASE_DECLARE

#endif
