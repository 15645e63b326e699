// Light of sun and sky, shadows, haze, and the way to the screen.
uniform sampler2DShadow sun_depth;

float shadow_tap(vec2 base, vec2 offset, float depth)
{
	return texture(sun_depth, vec3(base + offset / vec2(textureSize(sun_depth, 0)), depth));
}

// Share of sunlight that arrives at p with normal n. A 3x3 tent from four bilinear taps (Castano 2013).
float sunlight(vec3 p, vec3 n, float facing)
{
	// Off the surface by the map's texel, more at grazing light: no acne, and contacts stay attached.
	vec3 q = p + n * (sun.w * (.6 + 1.4 * sqrt(max(1. - facing * facing, 0.))));
	vec3 m = (sun_map * vec4(q, 1.)).xyz;
	vec2 size = vec2(textureSize(sun_depth, 0));
	vec2 texel = m.xy * size + .5;
	vec2 base = floor(texel);
	vec2 f = texel - base;
	base = (base - .5) / size;
	vec2 w0 = 3. - 2. * f, w1 = 1. + 2. * f;
	vec2 o0 = (2. - f) / w0 - 1., o1 = f / w1 + 1.;
	float sum = w0.x * w0.y * shadow_tap(base, o0, m.z) + w1.x * w0.y * shadow_tap(base, vec2(o1.x, o0.y), m.z) +
		    w0.x * w1.y * shadow_tap(base, vec2(o0.x, o1.y), m.z) + w1.x * w1.y * shadow_tap(base, o1, m.z);
	return sum / 16.;
}

vec3 sky_colour(vec3 direction)
{
	float up = 1. - max(direction.z, 0.);
	float up2 = up * up;
	vec3 sky = mix(sky_top.rgb, sky_horizon.rgb, up2 * up2 * up);
	float toward = max(dot(direction, sun.xyz), 0.);
	float glow = toward * toward;
	glow *= glow;
	glow *= glow;
	return sky + sun_colour.rgb * (.05 * glow);
}

// Highlights only are compressed; colours below .76 stay what they are (Khronos PBR Neutral, 2024).
vec3 tone(vec3 c)
{
	float low = min(c.r, min(c.g, c.b));
	c -= low < .08 ? low - 6.25 * low * low : .04;
	float peak = max(c.r, max(c.g, c.b));
	const float start = .76;
	const float d = 1. - start;
	float squeezed = 1. - d * d / (max(peak, start) + d - start);
	float keep = 1. / (.15 * (max(peak, start) - squeezed) + 1.);
	vec3 bright = mix(vec3(squeezed), c * (squeezed / max(peak, start)), keep);
	return peak < start ? c : bright;
}

// Linear to sRGB by square roots instead of powers; within half a code of the standard curve.
vec3 encode(vec3 c)
{
	vec3 s1 = sqrt(max(c, 0.)), s2 = sqrt(s1), s3 = sqrt(s2);
	return .662002687 * s1 + .684122060 * s2 - .323583601 * s3 - .0225411470 * c;
}

vec4 through_haze(vec3 lit, vec3 p)
{
	float d2 = dot(p, p) / (sky_top.w * sky_top.w);
	vec3 direction = p * inversesqrt(dot(p, p));
	return vec4(encode(mix(sky_colour(direction), tone(lit), exp2(-d2))), 1.);
}
