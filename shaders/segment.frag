#version 330 core
precision highp float;
in vec2 v_at;
flat in vec2 v_length_radius;
flat in vec4 v_colour;
out vec4 pixel;

void main()
{
	vec2 d = vec2(v_at.x - clamp(v_at.x, 0., v_length_radius.x), v_at.y);
	float cover = clamp(v_length_radius.y + .5 - length(d), 0., 1.);
	pixel = vec4(v_colour.rgb, v_colour.a * cover);
}
