#version 330 core
#include "frame.glsl"
#include "light.glsl"
out vec4 pixel;

void main()
{
	vec2 screen = gl_FragCoord.xy * viewport.zw * 2. - 1.;
	vec3 ray = ray_forward.xyz + screen.x * ray_right.xyz + screen.y * ray_up.xyz;
	pixel = vec4(encode(sky_colour(normalize(ray))), 1.);
}
