#include "lab/case.h"

#include <string.h>

#include "lab/cases/cases.h"

#define OB_CASE_POINTER(name) &ob_case_##name,
const ob_case *const ob_cases[] = { OB_CASES(OB_CASE_POINTER) NULL };
#undef OB_CASE_POINTER

const ob_case *ob_case_find(const char *name)
{
	for (const ob_case *const *c = ob_cases; *c; c++)
		if (!strcmp((*c)->name, name))
			return *c;
	return NULL;
}
