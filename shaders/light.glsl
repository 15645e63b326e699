// Light of the sun and of the sky through their shadow maps, and the output to the screen. Three methods:
//   OB_DRAFT     one sample of the sun's map, or four on meshes (OB_SOFT), whose wide ground makes its texels large; only
//                bodies near the ground hide the sky. For software rendering.
//   OB_AVERAGED  one of many averaged pictures, each with its own point of the sun and directions of the sky.
//   else         all in one picture: shadows that soften with the distance (percentage-closer soft shadows,
//                Fernando 2005), and a dozen directions of the sky. For a GPU.
uniform highp sampler2DShadow shadow_depth;

#if defined(OB_DRAFT) && !defined(OB_SOFT)
float sunlight(vec3 m) { return texture(shadow_depth, m); }
#elif defined(OB_DRAFT) || defined(OB_AVERAGED)
// A 3x3 tent from four bilinear taps (Castano 2013).
float shadow_tap(vec2 base, vec2 offset, float depth)
{
	return texture(shadow_depth, vec3(base + offset * shadow_texel.xy, depth));
}

float sunlight(vec3 m)
{
	vec2 texel = m.xy / shadow_texel.xy + .5;
	vec2 base = floor(texel);
	vec2 f = texel - base;
	base = (base - .5) * shadow_texel.xy;
	vec2 w0 = 3. - 2. * f, w1 = 1. + 2. * f;
	vec2 o0 = (2. - f) / w0 - 1., o1 = f / w1 + 1.;
	float sum = w0.x * w0.y * shadow_tap(base, o0, m.z) + w1.x * w0.y * shadow_tap(base, vec2(o1.x, o0.y), m.z) +
		    w0.x * w1.y * shadow_tap(base, vec2(o0.x, o1.y), m.z) + w1.x * w1.y * shadow_tap(base, o1, m.z);
	return sum / 16.;
}
#else
#define SEARCHES 12
#define TAPS 20
uniform highp sampler2D shadow_plain; // the same map, without comparison

// Point i of n in the unit disc: Vogel's spiral, turned.
vec2 in_disc(int i, int n, float turn)
{
	float angle = float(i) * 2.3999632 + turn;
	return sqrt((float(i) + .5) / float(n)) * vec2(cos(angle), sin(angle));
}

float sunlight(vec3 m)
{
	// Neighbouring pixels sample other points: gradient noise (Jimenez 2014).
	float turn = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(.06711056, .00583715))));
	vec2 widest = max(shadow_texel.zw * m.z, 1.5 * shadow_texel.xy);
	float depth = 0., found = 0.;
	for (int i = 0; i < SEARCHES; i++) {
		float d = texture(shadow_plain, m.xy + in_disc(i, SEARCHES, turn) * widest).r;
		float nearer = step(d, m.z);
		depth += nearer * d;
		found += nearer;
	}
	vec2 radius = max(shadow_texel.zw * max(m.z - depth / max(found, 1.), 0.), 1.2 * shadow_texel.xy);
	float lit = 0.;
	for (int i = 0; i < TAPS; i++)
		lit += texture(shadow_depth, vec3(m.xy + in_disc(i, TAPS, turn) * radius, m.z));
	return found > 0. ? lit / float(TAPS) : 1.;
}
#endif

#ifndef OB_DRAFT
#ifdef OB_AVERAGED
#define SKY_MAPS 4
#else
#define SKY_MAPS 12
#endif
uniform highp sampler2DArrayShadow sky_depth;

// Share of the sky's light that arrives at p with normal n.
float open_sky(vec3 p, vec3 n)
{
	float open = .05, all = .05;
	for (int i = 0; i < SKY_MAPS; i++) {
		float facing = max(dot(n, sky_ray[i].xyz), 0.);
		vec3 m = (sky_map[i] * vec4(p + n * (1.5 * sky_ray[i].w), 1.)).xyz;
		open += facing * texture(sky_depth, vec4(m.xy, float(i), m.z));
		all += facing;
	}
	return open / all;
}
#endif

// Reflection in a direction that rises by up (sine): the sky, or the sunlit ground; with roughness, a mix of both.
// sharp: sharpness of the horizon; lift: shift of the direction upwards.
vec3 surroundings(float up, float sharp, float lift)
{
	float high = clamp(up + lift, 0., 1.);
	return mix(ground_shine.rgb, mix(sky_horizon.rgb, sky_top.rgb, high * (2. - high)), clamp(.5 + up * sharp, 0., 1.));
}

// Compresses highlights; darker colours stay unchanged (Khronos PBR Neutral, 2024).
vec3 tone(vec3 c)
{
	float low = min(c.r, min(c.g, c.b));
	c -= low < .08 ? low - 6.25 * low * low : .04;
	float peak = max(max(c.r, max(c.g, c.b)), .76);
	float shown = 1. - .0576 / (peak - .52);
	c *= shown / peak;
	return mix(vec3(shown), c, 1. / (.15 * (peak - shown) + 1.));
}

// Linear to sRGB by square roots instead of powers; within one code of the standard curve.
vec3 encode(vec3 c)
{
	vec3 s1 = sqrt(c);
	return s1 * (1.753043949 + .384934509 * c) - .220465309 * sqrt(s1) - .913929871 * c;
}

vec4 shown(vec3 lit, float fogged)
{
	lit = mix(lit, sky_horizon.rgb, fogged);
#ifdef OB_AVERAGED
	// linear: resolve.frag shows the average; the limit keeps a glint from outshining its neighbours
	return vec4(min(lit, 4.), 1.);
#else
	return vec4(encode(tone(lit)), 1.);
#endif
}
