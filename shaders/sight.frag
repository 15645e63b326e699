#version 330 core
// Writes the depth of a pixel's middle along the view, and the number of the object there.
#include "frame.glsl"
out vec2 sight;
#ifdef OB_PLANE
uniform vec3 foot, normal; // m: the point of the plane nearest to the eye
uniform float number, reach;
#else
in float v_depth;
flat in float v_number;
flat in vec4 v_centre_radius;
flat in vec4 v_attitude;
flat in vec2 v_round;

vec3 turned_back(vec3 v) { return v + 2. * cross(v_attitude.xyz, cross(v_attitude.xyz, v) - v_attitude.w * v); }

// First point of a ball about the origin on the line o + t d, relative to the point nearest to its middle; below 0: none.
float enter_ball(vec3 o, vec3 d, float radius)
{
	float near = -dot(o, d) / dot(d, d);
	vec3 off = o + near * d;
	float rest = radius * radius - dot(off, off);
	return rest < 0. ? -1. : near - sqrt(rest / dot(d, d));
}

// The same of a capsule or cylinder along z.
float enter_round(vec3 o, vec3 d, float half_length, float radius, bool capsule)
{
	float across = dot(d.xy, d.xy), end = d.z > 0. ? -half_length : half_length;
	if (across > 0.) {
		float near = -dot(o.xy, d.xy) / across;
		vec2 off = o.xy + near * d.xy;
		float rest = radius * radius - dot(off, off), t = near - sqrt(max(rest, 0.) / across), z = o.z + t * d.z;
		if (rest >= 0. && abs(z) <= half_length)
			return t;
		if (capsule && rest >= 0.)
			end = z > 0. ? half_length : -half_length;
	}
	if (capsule)
		return enter_ball(o - vec3(0., 0., end), d, radius);
	float t = (end - o.z) / d.z;
	vec2 off = o.xy + t * d.xy;
	return dot(off, off) <= radius * radius ? t : -1.;
}
#endif

void main()
{
	vec2 screen = gl_FragCoord.xy * viewport.zw * 2. - 1.;
	vec3 ray = ray_forward.xyz + screen.x * ray_right.xyz + screen.y * ray_up.xyz;
	float depth;
#ifdef OB_PLANE
	depth = dot(foot, normal) / dot(ray, normal);
	if (!(depth > 0. && depth < reach))
		discard;
	sight = vec2(depth, number);
#else
	depth = v_depth;
	if (v_round.y > 0.) {
		depth = enter_round(turned_back(-v_centre_radius.xyz), turned_back(ray), v_round.x, v_centre_radius.w, v_round.y < 1.5);
		if (depth <= 0.)
			discard;
	}
	sight = vec2(depth, v_number);
#endif
	vec4 at = view_projection * vec4(ray * depth, 1.);
	gl_FragDepth = .5 * at.z / at.w + .5;
}
