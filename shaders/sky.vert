#version 330 core
// One triangle over the whole picture, at the far plane.
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4. - 1., 1., 1.); }
