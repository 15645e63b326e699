#version 330 core
#include "frame.glsl"
#include "light.glsl"
uniform vec3 foot, normal;
uniform vec3 unit_x, unit_y; // axes of the grid
uniform vec2 grid_foot;      // m: where the foot lies in the 10 m cell of the grid
uniform vec4 colour;         // linear; w: 1 with grid
uniform sampler2D contact_cover;
out vec4 pixel;

// Share of the pixel covered by lines of the given width (m) every step (m): the pulse train integrated over the
// pixel's footprint, so that it neither flickers near nor makes moire far away.
vec2 lines(vec2 at, vec2 footprint, float step, float width)
{
	vec2 w = max(footprint, 1e-4) / step;
	float share = width / step;
	vec2 a = (at + .5 * width) / step - .5 * w, b = a + w;
	vec2 covered = floor(b) * share + min(fract(b), share) - floor(a) * share - min(fract(a), share);
	return clamp(covered / w, 0., 1.);
}

void main()
{
	vec2 screen = gl_FragCoord.xy * viewport.zw * 2. - 1.;
	vec3 ray = ray_forward.xyz + screen.x * ray_right.xyz + screen.y * ray_up.xyz;
	vec3 p = ray * (dot(foot, normal) / min(dot(ray, normal), -1e-6));

	vec3 albedo = colour.rgb;
	vec2 at = vec2(dot(p - foot, unit_x), dot(p - foot, unit_y)) + grid_foot;
	vec2 footprint = fwidth(at);
	vec2 thin = lines(at, footprint, 1., .022), strong = lines(at, footprint, 10., .06);
	float ink = max(.34 * max(thin.x, thin.y), .62 * max(strong.x, strong.y)) * colour.w;
	albedo *= 1. - ink;

	float facing = max(dot(normal, sun.xyz), 0.);
	vec3 light = sun_colour.rgb * (facing * sunlight(p, normal, facing));
	vec3 cover = (contact_map * vec4(p, 1.)).xyz;
	float open = 1. - .75 * texture(contact_cover, cover.xy).r * step(abs(cover.z), .01);
	vec3 ambient = mix(ambient_down.rgb, ambient_up.rgb, .5 + .5 * normal.z) * open;
	pixel = through_haze(albedo * (light * (.4 + .6 * open) + ambient), p);
}
