#include <ob/joint.h>

const char *ob_joint_kind_name(uint32_t kind)
{
	static const char *const name[OB_JOINT_KINDS] = {
		[OB_JOINT_BALL] = "ball",   [OB_JOINT_HINGE] = "hinge",         [OB_JOINT_SLIDER] = "slider",
		[OB_JOINT_FIXED] = "fixed", [OB_JOINT_UNIVERSAL] = "universal", [OB_JOINT_DISTANCE] = "distance",
		[OB_JOINT_APART] = "apart",
	};
	return kind < OB_JOINT_KINDS ? name[kind] : NULL;
}
