#version 330 core
#include "frame.glsl"
#include "light.glsl"
#include "surface.glsl"
#ifdef OB_PATTERNED
#include "pattern.glsl"
#endif
in vec3 v_local, v_to_eye, v_shadow;
in vec2 v_open_fog;
flat in vec4 v_half;
flat in vec3 v_sun, v_up;
#ifdef OB_TEXTURED
uniform sampler2D colour_image, surface_image;
in vec2 v_place;
flat in vec4 v_paint;
flat in vec2 v_by_mesh;
Surface shown_surface()
{
	vec3 colour = v_paint.rgb * mix(vec3(1.), texture(colour_image, v_place).rgb, v_by_mesh.x);
	vec2 share = mix(vec2(1.), texture(surface_image, v_place).gb, v_by_mesh.y);
	return surface_of(colour, floor(v_paint.w) / 15. * share.y, fract(v_paint.w) * share.x);
}
#elif defined(OB_PATTERNED)
flat in vec4 v_paint;
flat in vec3 v_face;
Surface shown_surface()
{
	vec3 at = v_local + v_half.xyz, wide = fwidth(v_local), face = abs(v_face);
	vec2 on = face.x > .5 ? at.yz : face.y > .5 ? at.xz : at.xy;
	vec2 footprint = face.x > .5 ? wide.yz : face.y > .5 ? wide.xz : wide.xy;
	float paint = mod(v_paint.w, 16.);
	vec3 colour = patterned(v_paint.rgb, int(v_paint.w) / 16, on, footprint);
	return surface_of(colour, floor(paint) / 15., fract(paint));
}
#else
flat in vec3 v_matt, v_shine, v_edge;
flat in vec4 v_gloss;
Surface shown_surface() { return Surface(v_matt, v_shine, v_edge, v_gloss); }
#endif
#ifndef OB_DRAFT
flat in vec4 v_attitude;
vec3 turned(vec3 v) { return v + 2. * cross(v_attitude.xyz, cross(v_attitude.xyz, v) + v_attitude.w * v); }
#endif
out vec4 pixel;

void main()
{
	Surface s = shown_surface();
	vec3 n = normalize(sign(v_local) * max(1. - (v_half.xyz - abs(v_local)) * v_half.w, 0.));
	vec3 to_eye = normalize(v_to_eye), half_way = normalize(to_eye + v_sun);
	float rises = dot(n, v_up), across = max(dot(n, to_eye), 0.);
	vec3 light = sun_colour.rgb * (max(dot(n, v_sun), 0.) * sunlight(v_shadow));

	// Near the ground, less of its light and only the visible part of the sky's arrive.
#ifdef OB_DRAFT
	float open = v_open_fog.x;
#else
	float open = open_sky(-turned(v_to_eye), turned(n));
#endif
	float above = .5 + .5 * rises;
	vec3 ambient = mix(ambient_down.rgb * v_open_fog.x, ambient_up.rgb * open, above);

	// A microfacet surface: the glint of the sun (GGX, with Karis's visibility, 2013), and reflections (Lagarde
	// 2011).
	float facing = max(dot(n, half_way), 0.);
	float wide = (facing * facing * s.gloss.x + 1.) * max(dot(to_eye, half_way), .1);
	vec3 glint = s.shine * min(s.gloss.y / (wide * wide), 24.);
	float grazing = 1. - across, grazing2 = grazing * grazing;
	vec3 mirrored = surroundings(2. * across * rises - dot(to_eye, v_up), s.gloss.z, s.gloss.w) *
			(s.shine + s.edge * (grazing2 * grazing2 * grazing));

	pixel = shown(s.matt * (light + ambient) + light * glint + mirrored * (.25 + .75 * open), v_open_fog.y);
}
