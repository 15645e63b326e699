#include "host/role.h"

const char *ob_role_name(ob_role role)
{
	static const char *const names[OB_ROLES] = { "watch", "take part", "operate" };
	return names[role];
}

ob_role ob_role_for(ob_request_kind kind)
{
	switch (kind) {
	case OB_REQUEST_ADD:
	case OB_REQUEST_AVATAR:
	case OB_REQUEST_MESSAGE:
	case OB_REQUEST_TORQUE:
	case OB_REQUEST_PUSH:
	case OB_REQUEST_DRAG:
	case OB_REQUEST_RELEASE:
		return OB_ROLE_TAKE_PART;
	default:
		return OB_ROLE_OPERATE;
	}
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
