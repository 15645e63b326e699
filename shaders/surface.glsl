// What light meets, of a colour (linear), a share of metal and a roughness.
struct Surface {
	vec3 matt;         // colour of what is scattered
	vec3 shine, edge;  // reflectance at right angles; what it grows by where one looks along the surface
	vec4 gloss;        // of the glint: its sharpness less 1, its strength; of what is mirrored: see surroundings()
};

Surface surface_of(vec3 colour, float metal, float rough)
{
	float roughness = max(rough, .06), sharp = roughness * roughness * roughness * roughness;
	vec3 shine = mix(vec3(.04), colour, metal);
	return Surface(colour * (1. - metal), shine, max(vec3(1. - roughness), shine) - shine,
		       vec4(sharp - 1., sharp / (4. * roughness + 2.), .5 / (.06 + .9 * roughness), .25 * roughness));
}
