#version 330 core
#include "frame.glsl"
#include "light.glsl"
in vec3 v_position, v_normal;
flat in vec3 v_colour;
out vec4 pixel;

void main()
{
	vec3 n = normalize(v_normal);
	vec3 to_eye = -normalize(v_position);
	float facing = max(dot(n, sun.xyz), 0.);
	vec3 light = sun_colour.rgb * (facing * sunlight(v_position, n, facing));

	// Near the ground less of the sky is seen, and what is seen of the ground lies in shadow.
	float height = (contact_map * vec4(v_position, 1.)).z;
	float open = mix(1., .55 + .45 * clamp(1. - exp2(-3.5 * height), 0., 1.), sky_horizon.w);
	vec3 ambient = mix(ambient_down.rgb, ambient_up.rgb, .5 + .5 * n.z) * open;

	// A matt varnish: a soft highlight, and sky at grazing angles (Blinn 1977; Schlick 1994).
	float gloss = max(dot(n, normalize(to_eye + sun.xyz)), 0.);
	gloss *= gloss;
	gloss *= gloss;
	gloss *= gloss;
	gloss *= gloss;
	gloss *= gloss;
	float grazing = 1. - max(dot(n, to_eye), 0.);
	float grazing2 = grazing * grazing;
	vec3 shine = light * (.16 * gloss) + ambient * (.22 * grazing2 * grazing2);
	pixel = through_haze(v_colour * (light + ambient) + shine, v_position);
}
