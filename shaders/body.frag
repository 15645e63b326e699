#version 330 core
#include "frame.glsl"
#include "light.glsl"
in vec3 v_local, v_to_eye, v_shadow;
in vec2 v_open_fog;
flat in vec4 v_half;
flat in vec3 v_sun, v_up, v_colour;
out vec4 pixel;

void main()
{
	vec3 n = normalize(sign(v_local) * max(1. - (v_half.xyz - abs(v_local)) * v_half.w, 0.));
	vec3 to_eye = normalize(v_to_eye);
	float facing = max(dot(n, v_sun), 0.);
	vec3 light = sun_colour.rgb * (facing * sunlight(v_shadow));
	vec3 ambient = mix(ambient_down.rgb, ambient_up.rgb, .5 + .5 * dot(n, v_up)) * v_open_fog.x;

	// A matt varnish: a soft highlight, and sky at grazing angles (Blinn 1977; Schlick 1994).
	float gloss = max(dot(n, normalize(to_eye + v_sun)), 0.);
	gloss *= gloss;
	gloss *= gloss;
	gloss *= gloss;
	gloss *= gloss;
	gloss *= gloss;
	float grazing = 1. - max(dot(n, to_eye), 0.);
	grazing *= grazing;
	vec3 shine = light * (.16 * gloss) + ambient * (.22 * grazing * grazing);
	pixel = shown(v_colour * (light + ambient) + shine, v_open_fog.y);
}
