#version 330 core
#include "frame.glsl"
#include "light.glsl"
out vec4 pixel;

void main()
{
	vec2 screen = gl_FragCoord.xy * viewport.zw * 2. - 1.;
	vec3 ray = normalize(ray_forward.xyz + screen.x * ray_right.xyz + screen.y * ray_up.xyz);
	float up = max(ray.z, 0.), down = 1. - up;
	float down2 = down * down;
	float glow = max(dot(ray, sun.xyz), 0.);
	glow *= glow;
	glow *= glow;
	glow *= glow;
	vec3 sky = mix(sky_top.rgb, sky_horizon.rgb, down2 * down2 * down);
	sky *= 1. + .4 * min(ray.z, 0.); // without a ground: a little depth below the horizon
	pixel = shown(sky + sun_colour.rgb * (.06 * glow * min(4. * up, 1.)), 0.);
}
