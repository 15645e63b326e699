#version 330 core
// A plane up to the horizon: the patch with shadows, and, with other light, the ring around it.
#include "frame.glsl"
uniform vec3 foot, axis_x, axis_y; // m: the point of the plane nearest to the eye; unit axes
uniform vec4 patch_ends;           // m from the foot, along the axes: low x, low y, high x, high y
uniform float reach;               // m, half side of the drawn square

out vec2 v_at; // m from the foot, along the axes
#if defined(OB_DRAFT) && !defined(OB_PATTERNED)
#define OB_QUICK
#include "light.glsl"
uniform vec3 normal;
uniform vec4 colour;
flat out vec3 v_shaded, v_sunny, v_fogged; // shown colours: in shadow, in the sun, in fog
#endif

void main()
{
#ifdef OB_FAR
	int corner = (gl_VertexID >> 1) & 3; // ten vertices: inside, outside, inside .. once round
	bool outside = (gl_VertexID & 1) == 1, right = corner == 1 || corner == 2, up = corner >= 2;
	vec4 ends = outside ? vec4(-reach, -reach, reach, reach) : patch_ends;
#else
	bool right = (gl_VertexID & 1) == 1, up = gl_VertexID >= 2;
	vec4 ends = patch_ends;
#endif
	v_at = vec2(right ? ends.z : ends.x, up ? ends.w : ends.y);
#ifdef OB_QUICK
	vec3 ambient = mix(ambient_down.rgb, ambient_up.rgb, .5 + .5 * normal.z);
	v_shaded = encode(tone(colour.rgb * ambient));
	v_sunny = encode(tone(colour.rgb * (ambient + sun_colour.rgb * max(dot(normal, sun.xyz), 0.))));
	v_fogged = encode(tone(sky_horizon.rgb));
#endif
	gl_Position = view_projection * vec4(foot + v_at.x * axis_x + v_at.y * axis_y, 1.);
}
