#version 330 core
#include "frame.glsl"
#include "light.glsl"
uniform vec3 foot, normal;
uniform vec2 grid_foot;         // m: where the foot lies in the 10 m cell of the grid
uniform vec4 colour;            // linear; w: 1 with grid
uniform mat3 shadow_of, occlusion_of; // (along x, along y, 1) to the coordinates of the shadow map and the occlusion map
uniform float occlusion_share;      // how much contacts darken: 0 where the occlusion map is not of this plane
uniform sampler2D occlusion;
in vec2 v_at;
out vec4 pixel;

// How much of the pixel the nearest line covers, with its footprint as a box. Where footprints are wider than the
// lines' distance the result is even, and fades: neither flicker near nor moire far away.
vec2 lines(vec2 at, vec2 sharp, float distance, float width)
{
	vec2 cell = at / distance;
	vec2 off = abs(cell - floor(cell + .5)) * distance;
	return clamp((.5 * width - off) * sharp + .5, 0., 1.) * min(width * sharp, 1.);
}

float ink(vec2 at)
{
	vec2 sharp = 1. / max(fwidth(at), 1e-4);
	vec2 thin = lines(at, sharp, 1., .022), strong = lines(at, sharp, 10., .06);
	return colour.w * max(.42 * max(thin.x, thin.y), .66 * max(strong.x, strong.y));
}

void main()
{
	vec3 albedo = colour.rgb * (1. - ink(v_at + grid_foot));
	vec3 at = vec3(v_at, 1.);
	float sunny = sunlight(shadow_of * at) * max(dot(normal, sun.xyz), 0.);
	float open = 1. - occlusion_share * texture(occlusion, (occlusion_of * at).xy).r;
	vec3 ambient = mix(ambient_down.rgb, ambient_up.rgb, .5 + .5 * normal.z) * open;
	float fogged = 1. - exp2(-(dot(foot, foot) + dot(v_at, v_at)) * sky_top.w);
	pixel = shown(albedo * (sun_colour.rgb * (sunny * (.4 + .6 * open)) + ambient), fogged);
}
