#version 330 core
// Lighting is done in the body's own axes: sun and sky are turned into them here, once a vertex, and the pixel's normal
// needs no turning. A box's edges are rounded by bending its normal near them.
#include "frame.glsl"
#include "instance.glsl"
out vec3 v_local;       // box: position, m; else: normal
out vec3 v_to_eye;
out vec3 v_shadow;      // shadow-map coordinates
out vec2 v_open_fog;    // share of the ground's light that comes up; fog
flat out vec4 v_half;   // of v_local; 1 / width of the rounding
flat out vec3 v_sun, v_up, v_matt; // v_matt: colour of what is scattered
flat out vec3 v_shine, v_edge;     // reflectance at right angles; what it grows by where one looks along the surface
flat out vec4 v_gloss;             // of the glint: its sharpness less 1, its strength; of what is mirrored: see surroundings()
#ifndef OB_DRAFT
flat out vec4 v_attitude;
#endif

void main()
{
	vec3 p = world_position(), n = turned(normal);
	bool box = core.w > 0.;
	v_local = box ? corner * core.xyz : normal;
	v_half = box ? vec4(core.xyz, 1. / core.w) : vec4(1.);
	v_sun = turned_back(sun.xyz);
	v_up = turned_back(vec3(0., 0., 1.));
	v_to_eye = turned_back(-p);
	vec4 look = shown_paint();
	float metal = floor(look.w) / 15.;
	float roughness = max(look.w - floor(look.w), .06), sharp = roughness * roughness * roughness * roughness;
	v_matt = look.rgb * (1. - metal);
	v_shine = mix(vec3(.04), look.rgb, metal);
	v_edge = max(vec3(1. - roughness), v_shine) - v_shine;
	v_gloss = vec4(sharp - 1., sharp / (4. * roughness + 2.), .5 / (.06 + .9 * roughness), .25 * roughness);

	// The shadow is looked up off the surface, farther where light grazes: no acne, and contacts stay attached.
	float facing = clamp(dot(n, sun.xyz), 0., 1.);
	v_shadow = (shadow_map * vec4(p + n * (sun.w * (.6 + 1.4 * sqrt(1. - facing * facing))), 1.)).xyz;

	// Near the ground less of the sky is seen, and what is seen of the ground lies in shadow.
	float height = (occlusion_map * vec4(p, 1.)).z;
	v_open_fog.x = mix(1., .4 + .6 * clamp(1. - exp2(-3. * height), 0., 1.), sky_horizon.w);
	v_open_fog.y = fog(p);
#ifndef OB_DRAFT
	v_attitude = attitude;
#endif
	gl_Position = view_projection * vec4(p, 1.);
}
