#version 330 core
// A line of constant width on the screen, with round ends; with length zero, a dot.
#include "frame.glsl"
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec4 colour;
layout(location = 3) in float width; // px

out vec2 v_at;                   // px, along and across
flat out vec2 v_length_radius;   // px
flat out vec4 v_colour;

void main()
{
	vec4 a = view_projection * vec4(from, 1.), b = view_projection * vec4(to, 1.);
	// Clips at the near plane: the screen position of an end behind the eye would be invalid.
	float da = a.z + a.w, db = b.z + b.w;
	if (da < 0. && db > 0.)
		a = mix(a, b, da / (da - db));
	else if (db < 0. && da > 0.)
		b = mix(b, a, db / (db - da));
	vec2 half_size = .5 * viewport.xy;
	vec2 pa = a.xy / a.w * half_size, pb = b.xy / b.w * half_size;
	float size = length(pb - pa);
	vec2 along = size > 1e-3 ? (pb - pa) / size : vec2(1., 0.);
	vec2 across = vec2(-along.y, along.x);
	float radius = .5 * width, reach = radius + 1.;
	vec2 s = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2. - 1.;
	vec4 end = s.x < 0. ? a : b;
	vec2 shift = (along * s.x + across * s.y) * reach;
	v_at = vec2(s.x < 0. ? -reach : size + reach, s.y * reach);
	v_length_radius = vec2(size, radius);
	v_colour = colour;
	// Moves it a little towards the eye, so that a box does not hide its own edges. Divides here, so that values
	// between the corners are linear on the screen.
	gl_Position = vec4(end.xy / end.w + shift / half_size, end.z / end.w - .0004, 1.);
	if (da <= 0. && db <= 0.)
		gl_Position = vec4(0., 0., 2., 1.);
}
