#version 330 core
// Seen from one direction of the sky.
#include "frame.glsl"
#include "instance.glsl"
uniform int layer;
void main() { gl_Position = vec4((sky_map[layer] * vec4(world_position(), 1.)).xyz * 2. - 1., 1.); }
