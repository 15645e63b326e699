// Contacts of spheres with spheres and planes: one point, in closed form.
#include "contact/pairs.h"

static void one_point(ob_manifold *m, ob_vec3 normal, ob_vec3 at, double gap, double margin)
{
	m->separation = gap;
	m->normal = normal;
	m->points = gap <= margin;
	m->at[0] = at;
	m->gap[0] = gap;
}

void ob_manifold_spheres(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *m)
{
	ob_vec3 d = ob_sub(a->p, b->p);
	double l = ob_norm(d), gap = l - a->size.x - b->size.x;
	ob_vec3 n = l > 0 ? ob_scale(d, 1 / l) : ob_v3(0, 0, 1);
	one_point(m, n, ob_madd(b->p, b->size.x + .5 * gap, n), gap, margin);
}

void ob_manifold_sphere_plane(const ob_placed *a, const ob_placed *plane, double margin, ob_manifold *m)
{
	ob_vec3 n = ob_column(&plane->r, 2);
	double gap = ob_dot(n, ob_sub(a->p, plane->p)) - a->size.x;
	one_point(m, n, ob_madd(a->p, -(a->size.x + .5 * gap), n), gap, margin);
}
