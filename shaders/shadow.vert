#version 330 core
#include "frame.glsl"
#include "instance.glsl"
void main() { gl_Position = vec4((shadow_map * vec4(world_position(), 1.)).xyz * 2. - 1., 1.); }
