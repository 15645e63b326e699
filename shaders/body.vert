#version 330 core
#include "frame.glsl"
#include "instance.glsl"
out vec3 v_position, v_normal;
flat out vec3 v_colour;

void main()
{
	v_normal = turned(normal);
	v_position = world_position();
	v_colour = colour.rgb;
	gl_Position = view_projection * vec4(v_position, 1.);
}
