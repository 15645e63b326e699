// Patterns of boxes and planes, by ob_pattern: cells with joints between them, each of its own tone, and a grain within.
// All is averaged over the pixel's footprint, so there is neither flicker near nor moire far away.
const float period = 768.; // m, after which tones and grains repeat: whole cells of all patterns

// m: size of a cell, width of a joint; shift of a row against the one before, in cells
const vec4 cell_of[5] = vec4[5](vec4(.5, .5, .008, 0.), vec4(3., 3., .02, 0.), vec4(.25, .0833333333, .01, .5),
				vec4(1.5, .125, .004, .375), vec4(.5, .5, 0., 0.));
// share of the colour that joints keep, and of grey that they add; differences of tone among cells, and within
const vec4 tone_of[5] = vec4[5](vec4(.55, 0., .09, .07), vec4(.5, 0., .07, .12), vec4(.35, .32, .22, .14),
				vec4(.3, 0., .24, .24), vec4(1., 0., 0., .03));
const vec2 grain_of[5] = vec2[5](vec2(6.), vec2(2.), vec2(24.), vec2(2., 60.), vec2(6.)); // 1/m, whole

// From -1 to 1, by the place in a lattice of so many points along each axis (PCG, Jarzynski and Olano 2020).
float noise_at(vec2 place, vec2 points)
{
	uvec2 v = uvec2(ivec2(place) + 16 * ivec2(points)) % uvec2(points);
	v = v * 1664525u + 1013904223u;
	v.x += v.y * 1664525u;
	v.y += v.x * 1664525u;
	v ^= v >> 16u;
	v.x += v.y * 1664525u;
	v.y += v.x * 1664525u;
	return float((v.x ^ v.x >> 16u) >> 8u) / 8388607.5 - 1.;
}

float smooth_noise(vec2 at, vec2 points)
{
	vec2 whole = floor(at), part = at - whole, w = part * part * (3. - 2. * part);
	vec2 low = vec2(noise_at(whole, points), noise_at(whole + vec2(0., 1.), points));
	vec2 high = vec2(noise_at(whole + vec2(1., 0.), points), noise_at(whole + vec2(1., 1.), points));
	vec2 along = mix(low, high, w.x);
	return mix(along.x, along.y, w.y);
}

// Share of detail of this size that remains, m: none if two pixels are as wide.
float detail(vec2 size, vec2 wide)
{
	vec2 seen = clamp(2. - 2. * wide / size, 0., 1.);
	return seen.x * seen.y;
}

// Share of the footprint on the light squares of a checker.
float light_squares(vec2 cell, vec2 wide)
{
	vec2 w = max(wide, 1e-4), low = .5 * (cell - .5 * w), high = .5 * (cell + .5 * w);
	vec2 side = 2. * (abs(fract(low) - .5) - abs(fract(high) - .5)) / w;
	return .5 - .5 * side.x * side.y;
}

// Colour at a place of the surface (m); wide: the pixel's footprint there.
vec3 patterned(vec3 colour, int pattern, vec2 at, vec2 wide)
{
	vec4 form = cell_of[pattern - 1], tones = tone_of[pattern - 1];
	vec2 grain = grain_of[pattern - 1], size = form.xy, cell = at / size;
	cell.x += fract(form.w * floor(cell.y));
	vec2 whole = floor(cell), off = (.5 - abs(cell - whole - .5)) * size, sharp = 1. / max(wide, 1e-5);
	vec2 joint = clamp((.5 * form.z - off) * sharp + .5, 0., 1.) * min(form.z * sharp, 1.);
	joint = mix(joint, form.zz / size, clamp(2. * wide / size - .5, 0., 1.));
	float shade = 1. + tones.z * noise_at(whole, floor(period / size + .5)) * detail(size, wide);
	shade += tones.w * smooth_noise(at * grain, grain * period) * detail(1. / grain, wide);
	if (pattern == 5)
		shade *= mix(.25, 1., light_squares(cell, wide / size));
	vec3 between = colour * tones.x + tones.y * vec3(.6, .57, .53);
	return mix(colour * shade, between, joint.x + joint.y - joint.x * joint.y);
}
