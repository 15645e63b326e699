#version 330 core
precision highp float;
in float v_height;
out vec4 occlusion;

void main() { occlusion = vec4(exp2(-5. * max(v_height, 0.))); }
