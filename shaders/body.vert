#version 330 core
// Lighting in the body's own axes: sun and sky are turned into them here, once a vertex, so that the pixel's normal
// needs no turning. A box's edges are rounded by bending its normal near them.
#include "frame.glsl"
#include "instance.glsl"
#include "surface.glsl"
out vec3 v_local;       // box: position, m; else: normal
out vec3 v_to_eye;
out vec3 v_shadow;      // shadow-map coordinates
out vec2 v_open_fog;    // share of the ground's light that arrives; fog
flat out vec4 v_half;   // half size of v_local's box; 1 / width of the rounding
flat out vec3 v_sun, v_up;
#ifdef OB_TEXTURED
out vec2 v_place;         // texture coordinates
flat out vec4 v_paint;    // factors of the images: colour; metal and roughness, as shown_paint()
flat out vec2 v_by_mesh;  // 1 if the mesh's images provide colour and surface, else 0
#elif defined(OB_PATTERNED)
flat out vec4 v_paint;
flat out vec3 v_face;     // the normal of the box's face
#else
flat out vec3 v_matt, v_shine, v_edge; // members of Surface
flat out vec4 v_gloss;
#endif
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
#ifdef OB_TEXTURED
	v_place = texture_place;
	v_paint = look;
	v_by_mesh = vec2(by_mesh());
#elif defined(OB_PATTERNED)
	v_paint = colour;
	v_face = normal;
#else
	Surface s = surface_of(look.rgb, floor(look.w) / 15., fract(look.w));
	v_matt = s.matt;
	v_shine = s.shine;
	v_edge = s.edge;
	v_gloss = s.gloss;
#endif

	// Samples the shadow off the surface, farther at grazing light: no acne, and contacts stay attached.
	float facing = clamp(dot(n, sun.xyz), 0., 1.);
	v_shadow = (shadow_map * vec4(p + n * (sun.w * (.6 + 1.4 * sqrt(1. - facing * facing))), 1.)).xyz;

	// Near the ground, less of the sky is visible, and the visible ground lies in shadow.
	float height = (occlusion_map * vec4(p, 1.)).z;
	v_open_fog.x = mix(1., .4 + .6 * clamp(1. - exp2(-3. * height), 0., 1.), sky_horizon.w);
	v_open_fog.y = fog(p);
#ifndef OB_DRAFT
	v_attitude = attitude;
#endif
	gl_Position = view_projection * vec4(p, 1.);
}
