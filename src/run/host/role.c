#include "host/role.h"

const char *ob_role_name(ob_role role)
{
	static const char *const names[OB_ROLES] = { "watch", "take part", "operate" };
	return names[role];
}

bool ob_role_check(ob_role role, ob_role needed, ob_error *e)
{
	if (role >= needed)
		return true;
	if (role == OB_ROLE_WATCH)
		return ob_fail(e, "viewers of this universe may change nothing");
	return ob_fail(e,
		       "visitors may %s; this is for those who %s: the user whose universe it is, and holders of the "
		       "first address that obsim serve has printed",
		       ob_role_name(role), ob_role_name(needed));
}
