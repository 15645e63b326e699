#include "motion/joint_value.h"

#include <math.h>

#include <ob/joint.h>

#include "elementary/elementary.h"

double ob_joint_turn(const ob_joint_axis *axis, ob_vec3 x, ob_vec3 first, ob_vec3 second)
{
	const double low = axis->low, high = axis->high, angle = ob_atan2(ob_dot(x, second), ob_dot(x, first));
	const double middle = isfinite(low) && isfinite(high) ? .5 * (low + high) : 0;
	return angle + 2 * M_PI * nearbyint((middle - angle) / (2 * M_PI));
}

ob_vec3 ob_joint_twist(ob_quat q)
{
	const ob_vec3 v = q.w < 0 ? ob_v3(-q.x, -q.y, -q.z) : ob_v3(q.x, q.y, q.z);
	const double sine = ob_norm(v);
	return sine > 0 ? ob_scale(v, 2 * ob_atan2(sine, fabs(q.w)) / sine) : v;
}

bool ob_joint_value(const ob_joint_passport *j, const ob_state states[2], double *value, double *rate)
{
	ob_vec3 at[2], v[2];
	ob_mat3 axes[2];
	ob_quat attitude[2];
	for (int side = 0; side < 2; side++) {
		const ob_state *s = &states[side];
		const ob_mat3 r = ob_quat_matrix(s->pose.q);
		const ob_vec3 arm = ob_rotate(&r, j->frame[side].p);
		at[side] = ob_add(s->pose.p, arm);
		v[side] = ob_add(s->v, ob_cross(s->w, arm));
		attitude[side] = ob_quat_mul(s->pose.q, j->frame[side].q);
		axes[side] = ob_quat_matrix(attitude[side]);
	}
	const ob_vec3 apart = ob_sub(at[0], at[1]), opening = ob_sub(v[0], v[1]), z = ob_column(&axes[1], 2);
	const ob_vec3 turning = ob_sub(states[0].w, states[1].w);
	const ob_vec3 twist = ob_joint_twist(ob_quat_mul(ob_quat_conjugate(attitude[1]), attitude[0]));
	const double far = ob_norm(apart);
	switch (j->kind) {
	case OB_JOINT_HINGE:
		*value =
			ob_joint_turn(&j->axis, ob_column(&axes[0], 0), ob_column(&axes[1], 0), ob_column(&axes[1], 1));
		*rate = ob_dot(z, ob_sub(states[0].w, states[1].w));
		return true;
	case OB_JOINT_SLIDER: // the origins lie on the axis
		*value = ob_dot(z, apart);
		*rate = ob_dot(z, opening) + ob_dot(ob_cross(states[1].w, z), apart);
		return true;
	case OB_JOINT_DISTANCE:
		*value = far;
		*rate = far > 0 ? ob_dot(apart, opening) / far : 0;
		return true;
	case OB_JOINT_UNIVERSAL:
		*value = ob_joint_turn(&j->axis, ob_column(&axes[0], 1), ob_column(&axes[1], 1),
				       ob_cross(ob_column(&axes[0], 0), ob_column(&axes[1], 1)));
		*rate = ob_dot(ob_column(&axes[0], 0), turning);
		return true;
	case OB_JOINT_BALL:
		*value = ob_norm(twist);
		*rate = *value > 0 ? ob_dot(ob_rotate(&axes[1], twist), turning) / *value : ob_norm(turning);
		return true;
	default:
		return false;
	}
}

// ---- joint kind

const char *ob_joint_kind_name(uint32_t kind)
{
	static const char *const name[OB_JOINT_KINDS] = {
		[OB_JOINT_BALL] = "ball",   [OB_JOINT_HINGE] = "hinge",         [OB_JOINT_SLIDER] = "slider",
		[OB_JOINT_FIXED] = "fixed", [OB_JOINT_UNIVERSAL] = "universal", [OB_JOINT_DISTANCE] = "distance",
		[OB_JOINT_APART] = "apart",
	};
	return kind < OB_JOINT_KINDS ? name[kind] : NULL;
}
