#version 330 core
// Writes the average of the pictures to the screen.
#include "frame.glsl"
#include "light.glsl"
uniform highp sampler2D source;
out vec4 pixel;

void main() { pixel = vec4(encode(tone(texelFetch(source, ivec2(gl_FragCoord.xy), 0).rgb)), 1.); }
