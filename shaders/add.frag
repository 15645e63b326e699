#version 330 core
// Adds one of the averaged pictures.
precision highp float;
uniform highp sampler2D source;
uniform float share;
out vec4 pixel;

void main() { pixel = share * texelFetch(source, ivec2(gl_FragCoord.xy), 0); }
