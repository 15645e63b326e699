#version 330 core
#include "frame.glsl"
#include "light.glsl"
#ifdef OB_PATTERNED
#include "pattern.glsl"
#endif
uniform vec3 foot, normal, axis_x, axis_y;
uniform vec2 grid_foot;         // m: the foot's place in the 10 m cell of the grid, or in the pattern's period
uniform vec4 colour;            // linear; w: 1 with grid, or the pattern
uniform mat3 shadow_of;         // (along x, along y, 1) to the coordinates of the shadow map
#ifdef OB_DRAFT
uniform mat3 occlusion_of;
uniform float occlusion_share;  // darkening by contacts: 0 if the occlusion map is for another plane
uniform sampler2D occlusion;
#endif
#if defined(OB_DRAFT) && !defined(OB_PATTERNED)
// Mixed from a few shown colours: linear light, a tone and sRGB for each pixel took two fifths of a picture in software.
#define OB_QUICK
flat in vec3 v_shaded, v_sunny, v_fogged;
#endif
in vec2 v_at;
out vec4 pixel;

#ifdef OB_PATTERNED
vec3 ground(vec2 at) { return patterned(colour.rgb, int(colour.w), at, fwidth(at)); }
#else
// Share of the pixel covered by the nearest line, with a box filter over its footprint. Footprints wider than the
// lines' distance give an even result, which fades: no flicker near, no moire far away.
vec2 lines(vec2 at, vec2 sharp, float distance, float width)
{
	vec2 off = abs(fract(at / distance + .5) - .5) * distance;
	return clamp((.5 * width - off) * sharp + .5, 0., 1.) * min(width * sharp, 1.);
}

float ink(vec2 at)
{
	vec2 sharp = 1. / max(fwidth(at), 1e-4);
	vec2 thin = lines(at, sharp, 1., .02), strong = lines(at, sharp, 10., .05);
	return colour.w * max(.3 * max(thin.x, thin.y), .5 * max(strong.x, strong.y));
}

vec3 ground(vec2 at) { return colour.rgb * (1. - ink(at)); }
#endif

void main()
{
	vec3 at = vec3(v_at, 1.);
	float fogged = 1. - exp2(-(dot(foot, foot) + dot(v_at, v_at)) * sky_top.w);
#ifdef OB_FAR
	float sunny = 1., open = 1.;
#else
	float sunny = sunlight(shadow_of * at);
#ifdef OB_DRAFT
	float open = 1. - occlusion_share * texture(occlusion, (occlusion_of * at).xy).r;
#else
	float open = open_sky(foot + v_at.x * axis_x + v_at.y * axis_y, normal);
#endif
#endif
#ifdef OB_QUICK
	float shade = (.5 + .5 * open) * (1. - .46 * ink(v_at + grid_foot)); // .46: a share of light, as shown by sRGB
	pixel = vec4(mix(mix(v_shaded, v_sunny, sunny) * shade, v_fogged, fogged), 1.);
#else
	vec3 albedo = ground(v_at + grid_foot);
	sunny *= max(dot(normal, sun.xyz), 0.);
#if defined(OB_DRAFT)
	sunny *= .4 + .6 * open;
#endif
	vec3 ambient = mix(ambient_down.rgb, ambient_up.rgb * open, .5 + .5 * normal.z);
	pixel = shown(albedo * (sun_colour.rgb * sunny + ambient), fogged);
#endif
}
