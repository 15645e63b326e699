// Reflection of light by a colour (linear), a share of metal and a roughness.
struct Surface {
	vec3 matt;         // diffuse colour
	vec3 shine, edge;  // reflectance at right angles; its growth towards grazing angles
	vec4 gloss;        // sharpness of the glint minus 1, its strength; reflections: see surroundings()
};

Surface surface_of(vec3 colour, float metal, float rough)
{
	float roughness = max(rough, .06), sharp = roughness * roughness * roughness * roughness;
	vec3 shine = mix(vec3(.04), colour, metal);
	return Surface(colour * (1. - metal), shine, max(vec3(1. - roughness), shine) - shine,
		       vec4(sharp - 1., sharp / (4. * roughness + 2.), .5 / (.06 + .9 * roughness), .25 * roughness));
}
