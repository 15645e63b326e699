// What all passes of one frame share. Mirrors ob_frame_block in src/render/frame.h.
// Positions are in metres, world axes, relative to the eye: floats then hold millimetres anywhere in the world.
precision highp float;

layout(std140) uniform Frame {
	mat4 view_projection;
	mat4 sun_map;      // to shadow-map coordinates, 0..1 each
	mat4 contact_map;  // to contact-map coordinates (xy, 0..1) and the height over the ground (z, m)
	vec4 ray_right;    // view ray = forward + x right + y up, with x and y in -1..1
	vec4 ray_up;
	vec4 ray_forward;
	vec4 sun;          // unit, towards the sun; w: texel of the shadow map, m
	vec4 sun_colour;   // w: distance at which shadows have faded, m
	vec4 sky_top;      // w: fog distance, m
	vec4 sky_horizon;  // w: 1 with a ground, 0 without
	vec4 ambient_up;
	vec4 ambient_down;
	vec4 viewport;     // px: width, height; 1 / width, 1 / height
};
