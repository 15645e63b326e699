#version 330 core
// What a camera sensor measures: number and depth of each object. Round shapes are met exactly (sight.frag), so their
// triangles are made a little larger, to cover them.
#include "frame.glsl"
#include "instance.glsl"
out float v_depth;             // m, along the view
flat out float v_number;
flat out vec4 v_centre_radius; // m, relative to the eye; m
flat out vec4 v_attitude;
flat out vec2 v_round;         // half length, m; 0 = triangles, 1 = sphere or capsule, 2 = cylinder

void main()
{
	bool round = core.w < 0.;
	vec3 at = corner * core.xyz + normal * position_radius.w;
	vec3 p = turned(round ? 1.005 * at : at) + position_radius.xyz;
	v_depth = dot(p, ray_forward.xyz);
	v_number = colour.r;
	v_centre_radius = vec4(position_radius.xyz, core.w < -1.5 ? core.x : position_radius.w);
	v_attitude = attitude;
	v_round = vec2(core.z, round ? -core.w : 0.);
	gl_Position = view_projection * vec4(p, 1.);
}
