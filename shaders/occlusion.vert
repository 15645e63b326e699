#version 330 core
// Seen from below the ground: distance of the nearest body.
#include "frame.glsl"
#include "instance.glsl"
out float v_height;

void main()
{
	vec3 m = (occlusion_map * vec4(world_position(), 1.)).xyz;
	v_height = m.z;
	gl_Position = vec4(m.xy * 2. - 1., 0., 1.);
}
