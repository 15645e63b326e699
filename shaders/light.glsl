// Light of the sun through its shadow map, fog, and the way to the screen.
uniform sampler2DShadow shadow_depth;

// Share of sunlight that arrives at the map's point m: bilinear in software, else a 3x3 tent from four bilinear taps
// (Castano 2013).
#ifdef OB_SOFTWARE
float sunlight(vec3 m) { return texture(shadow_depth, m); }
#else
float shadow_tap(vec2 base, vec2 offset, float depth)
{
	return texture(shadow_depth, vec3(base + offset * shadow_texel, depth));
}

float sunlight(vec3 m)
{
	vec2 texel = m.xy / shadow_texel + .5;
	vec2 base = floor(texel);
	vec2 f = texel - base;
	base = (base - .5) * shadow_texel;
	vec2 w0 = 3. - 2. * f, w1 = 1. + 2. * f;
	vec2 o0 = (2. - f) / w0 - 1., o1 = f / w1 + 1.;
	float sum = w0.x * w0.y * shadow_tap(base, o0, m.z) + w1.x * w0.y * shadow_tap(base, vec2(o1.x, o0.y), m.z) +
		    w0.x * w1.y * shadow_tap(base, vec2(o0.x, o1.y), m.z) + w1.x * w1.y * shadow_tap(base, o1, m.z);
	return sum / 16.;
}
#endif

// A little contrast; then only highlights are compressed: from .6 on to 1 - .16 / (c - .2), which meets it smoothly.
vec3 tone(vec3 c)
{
	c = max(1.06 * c - .02, 0.);
	return mix(c, 1. - .16 / max(c - .2, .1), step(.6, c));
}

// Linear to sRGB by square roots instead of powers; within half a code of the standard curve (after Chapman 2012).
vec3 encode(vec3 c)
{
	vec3 s1 = sqrt(c), s2 = sqrt(s1);
	return .662002687 * s1 + .684122060 * s2 - .323583601 * sqrt(s2) - .0225411470 * c;
}

vec4 shown(vec3 lit, float fogged) { return vec4(encode(mix(tone(lit), sky_horizon.rgb, fogged)), 1.); }
