#version 330 core
#include "frame.glsl"
uniform vec3 foot, axis_x, axis_y; // m: the point of the plane nearest to the eye, and half sides of the drawn square

void main()
{
	vec2 s = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2. - 1.;
	gl_Position = view_projection * vec4(foot + s.x * axis_x + s.y * axis_y, 1.);
}
