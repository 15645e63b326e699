// Shared by all passes of one frame. Mirrors ob_frame_block in src/run/render/frame.h. Positions are in metres, world axes,
// relative to the eye: floats then resolve millimetres anywhere in the world.
precision highp float;

layout(std140) uniform Frame {
	mat4 view_projection;
	mat4 shadow_map;    // to shadow-map coordinates, 0..1 each
	mat4 occlusion_map; // to occlusion-map coordinates (xy, 0..1) and the height over the ground (z, m)
	vec4 ray_right;     // view ray = forward + x right + y up, with x and y in -1..1
	vec4 ray_up;
	vec4 ray_forward;
	vec4 sun;           // unit, towards the sun; w: texel of the shadow map, m
	vec4 sun_colour;    // irradiance / pi
	vec4 sky_top;       // w: 1 / square of the fog's distance, 1/m2
	vec4 sky_horizon;   // w: 1 with a ground, 0 without
	vec4 ambient_up;    // irradiance / pi from above and from below
	vec4 ambient_down;
	vec4 ground_shine;  // radiance of the sunlit ground, as seen in polished surfaces
	vec4 viewport;      // px: width, height; 1 / width, 1 / height
	// 1 / texels of the shadow map; zw: radius of the penumbra, in the map, of a caster one map depth above
	vec4 shadow_texel;
	mat4 sky_map[12];   // same as shadow_map, seen from directions of the sky
	vec4 sky_ray[12];   // unit, towards there; w: texel of the map, m
};

// Share of fog between the eye and p.
float fog(vec3 p) { return 1. - exp2(-dot(p, p) * sky_top.w); }
