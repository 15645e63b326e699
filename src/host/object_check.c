#include "host/object_check.h"

#include <string.h>

#include "scene/object_limits.h"

static bool name_fault(const ob_passport *p, const ob_error *why, ob_error *e)
{
	return ob_fail(e, "object \"%s\": %s", p->name, why->text);
}

static bool check_name(const ob_passport *p, ob_error *e)
{
	return memchr(p->name, 0, OB_NAME_MAX) ||
	       ob_fail(e, "object %u: its name is longer than %d characters", p->id, OB_NAME_MAX - 1);
}

bool ob_object_check(const ob_object_def *def, ob_error *e)
{
	ob_error why;
	return check_name(&def->passport, e) && (ob_object_def_check(def, &why) || name_fault(&def->passport, &why, e));
}

bool ob_object_check_saved(const ob_passport *p, ob_error *e)
{
	ob_error why;
	return check_name(p, e) && (ob_passport_check(p, &why) || name_fault(p, &why, e));
}
