// The five regular solids, with edge length 1, about the origin.
#ifndef OB_TESTS_SOLIDS_H
#define OB_TESTS_SOLIDS_H

#include <ob/vec.h>

typedef struct solid {
	const char *name;
	int corners, faces, edges;
	double volume, inertia, inner,
		radius; // m^3; m^2, per kilogram, about any axis; m, of the inscribed and circumscribed spheres
	ob_vec3 corner[20];
} solid;

static inline void solid_scale(solid *s, double edge)
{
	double least = INFINITY;
	for (int i = 1; i < s->corners; i++)
		least = fmin(least, ob_norm(ob_sub(s->corner[i], s->corner[0])));
	for (int i = 0; i < s->corners; i++)
		s->corner[i] = ob_scale(s->corner[i], edge / least);
}

// Closed forms for edge 1 (Satterly 1958 for the moments).
static inline void solids_make(solid out[5])
{
	const double f = (1 + sqrt(5)) / 2;
	solid tetrahedron = { .name = "tetrahedron", .corners = 4, .faces = 4, .edges = 6 };
	solid cube = { .name = "cube", .corners = 8, .faces = 6, .edges = 12 };
	solid octahedron = { .name = "octahedron", .corners = 6, .faces = 8, .edges = 12 };
	solid dodecahedron = { .name = "dodecahedron", .corners = 20, .faces = 12, .edges = 30 };
	solid icosahedron = { .name = "icosahedron", .corners = 12, .faces = 20, .edges = 30 };
	int n = 0, m = 0;
	for (int k = 0; k < 8; k++) {
		const double x = k & 1 ? 1 : -1, y = k & 2 ? 1 : -1, z = k & 4 ? 1 : -1;
		cube.corner[k] = dodecahedron.corner[n++] = ob_v3(x, y, z);
		if (x * y * z > 0)
			tetrahedron.corner[m++] = ob_v3(x, y, z);
	}
	for (int axis = 0; axis < 3; axis++)
		for (int k = 0; k < 4; k++) {
			const double a = k & 1 ? 1 : -1, b = k & 2 ? 1 : -1;
			const double d[3] = { 0, a / f, b * f }, i[3] = { 0, a, b * f };
			dodecahedron.corner[n++] = ob_v3(d[axis], d[(axis + 1) % 3], d[(axis + 2) % 3]);
			icosahedron.corner[4 * axis + k] = ob_v3(i[axis], i[(axis + 1) % 3], i[(axis + 2) % 3]);
			if (k < 2)
				octahedron.corner[2 * axis + k] =
					ob_v3(axis == 0 ? a : 0, axis == 1 ? a : 0, axis == 2 ? a : 0);
		}
	tetrahedron.volume = sqrt(2) / 12, tetrahedron.inertia = 1. / 20;
	tetrahedron.inner = sqrt(6) / 12, tetrahedron.radius = sqrt(6) / 4;
	cube.volume = 1, cube.inertia = 1. / 6, cube.inner = .5, cube.radius = sqrt(3) / 2;
	octahedron.volume = sqrt(2) / 3, octahedron.inertia = 1. / 10;
	octahedron.inner = sqrt(6) / 6, octahedron.radius = sqrt(2) / 2;
	dodecahedron.volume = (15 + 7 * sqrt(5)) / 4, dodecahedron.inertia = (95 + 39 * sqrt(5)) / 300;
	dodecahedron.inner = sqrt(250 + 110 * sqrt(5)) / 20, dodecahedron.radius = sqrt(3) * f / 2;
	icosahedron.volume = 5 * (3 + sqrt(5)) / 12, icosahedron.inertia = f * f / 10;
	icosahedron.inner = sqrt(3) * (3 + sqrt(5)) / 12, icosahedron.radius = sqrt(f * sqrt(5)) / 2;
	const solid all[] = { tetrahedron, cube, octahedron, dodecahedron, icosahedron };
	for (int i = 0; i < 5; i++) {
		out[i] = all[i];
		solid_scale(&out[i], 1);
	}
}

#endif
