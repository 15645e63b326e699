// List of all cases, in the order of their rows. Each is in a file of its group in this folder.
#ifndef OB_LAB_CASES_CASES_H
#define OB_LAB_CASES_CASES_H

#include "lab/case.h"

#define OB_CASES(X) \
	X(plank_bridge) \
	X(ragdoll) \
	X(car)

#define OB_CASE_DECLARE(name) extern const ob_case ob_case_##name;
OB_CASES(OB_CASE_DECLARE)
#undef OB_CASE_DECLARE

#endif
