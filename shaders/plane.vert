#version 330 core
#include "frame.glsl"
uniform vec3 foot, axis_x, axis_y; // m: the point of the plane nearest to the eye; unit axes
uniform float reach;               // m, half side of the square that is drawn

out vec2 v_at; // m from the foot, along the axes

void main()
{
	v_at = (vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2. - 1.) * reach;
	gl_Position = view_projection * vec4(foot + v_at.x * axis_x + v_at.y * axis_y, 1.);
}
