// One vertex of one object. Every shape is a core thickened by a ball: a sphere's core is a point, a box's ball is one.
layout(location = 0) in vec3 corner;          // in the core, in units of its half size
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 position_radius; // m, relative to the eye; m, of the ball
layout(location = 3) in vec4 attitude;        // quaternion x y z w, body to world
// m, half size; w: width of a box's rounded edges, m; 0 = not a box; negative for a mesh: -1 if it has the colour, -2
// if the surface
layout(location = 4) in vec4 core;
// linear; w: 15 times its metal, whole, plus its roughness, below 1; of a patterned box plus 16 times its pattern
layout(location = 5) in vec4 colour;
layout(location = 6) in vec4 paint;           // paint of a mesh's vertex, like colour; below 0: the object's
layout(location = 7) in vec2 texture_place;   // texture coordinates in its part's images

vec3 turned(vec3 v) { return v + 2. * cross(attitude.xyz, cross(attitude.xyz, v) + attitude.w * v); }
vec3 turned_back(vec3 v) { return v + 2. * cross(attitude.xyz, cross(attitude.xyz, v) - attitude.w * v); }
// True, by component, if its mesh provides the colour, and the surface.
bvec2 by_mesh()
{
	int flags = int(max(-core.w, 0.) + .5);
	return bvec2((flags & 1) != 0 && paint.r >= 0., (flags & 2) != 0 && paint.w >= 0.);
}
vec4 shown_paint()
{
	bvec2 mesh = by_mesh();
	return vec4(mesh.x ? paint.rgb : colour.rgb, mesh.y ? paint.w : colour.w);
}
vec3 world_position() { return turned(corner * core.xyz + normal * position_radius.w) + position_radius.xyz; }
