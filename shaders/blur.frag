#version 330 core
// One direction of a Gaussian blur: 13 texels wide, pairs read at once between two texels.
precision highp float;
uniform sampler2D source;
uniform vec2 direction; // one texel, in texture coordinates
out vec4 pixel;

void main()
{
	vec2 at = gl_FragCoord.xy / vec2(textureSize(source, 0));
	vec4 sum = .1964825502 * texture(source, at);
	sum += .2969069647 * (texture(source, at + 1.4117647 * direction) + texture(source, at - 1.4117647 * direction));
	sum += .0944703979 * (texture(source, at + 3.2941176 * direction) + texture(source, at - 3.2941176 * direction));
	sum += .0103813624 * (texture(source, at + 5.1764706 * direction) + texture(source, at - 5.1764706 * direction));
	pixel = sum;
}
