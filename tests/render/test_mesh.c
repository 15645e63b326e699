// Meshes: closed, facing outwards, and as large as the shape.
#include <stdlib.h>

#include "../check.h"
#include "ob/vec.h"
#include "render/mesh.h"

// Volume by the divergence theorem, with a core of half size 1 x 1 x 2 and a ball of the given radius. It is right only
// if no triangle is missing, doubled or turned inside out.
static double volume(const ob_mesh_set *s, int kind, double core_xy, double radius)
{
	double six = 0;
	const ob_mesh_range *m = &s->mesh[kind];
	for (uint32_t i = 0; i < m->index_count; i += 3) {
		ob_vec3 p[3];
		for (int k = 0; k < 3; k++) {
			const ob_vertex *v = &s->vertex[s->index[m->index_first + i + (uint32_t)k]];
			p[k] = ob_v3(core_xy * v->corner[0] + radius * v->normal[0],
				     core_xy * v->corner[1] + radius * v->normal[1],
				     2 * v->corner[2] + radius * v->normal[2]);
		}
		six += ob_dot(p[0], ob_cross(p[1], p[2]));
	}
	return six / 6;
}

int main(void)
{
	ob_mesh_set s;
	CHECK(ob_mesh_set_build(&s));
	CHECK_NEAR(volume(&s, OB_MESH_BOX, 1, 0), 16, 1e-6);
	CHECK(s.mesh[OB_MESH_BOX].index_count == 36);
	static const double tolerance[OB_MESH_LEVELS] = { .10, .03, .01 };
	for (int level = 0; level < OB_MESH_LEVELS; level++) {
		double ball = 4. / 3 * M_PI, capsule = ball + 4 * M_PI, cylinder = 4 * M_PI;
		CHECK_NEAR(volume(&s, OB_MESH_ROUND + level, 0, 1) / capsule, 1 - .5 * tolerance[level],
			   .5 * tolerance[level]);
		CHECK_NEAR(volume(&s, OB_MESH_CYLINDER + level, 1, 0) / cylinder, 1 - .5 * tolerance[level],
			   .5 * tolerance[level]);
	}
	for (uint32_t i = 0; i < s.vertices; i++) {
		const float *n = s.vertex[i].normal;
		CHECK_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-6);
	}
	ob_mesh_set_finish(&s);
	return check_end();
}
