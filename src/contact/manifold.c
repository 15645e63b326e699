#include "contact/manifold.h"

static void one_point(ob_manifold *m, ob_vec3 normal, ob_vec3 at, double gap, double margin)
{
	m->separation = gap;
	m->normal = normal;
	m->points = gap <= margin;
	m->at[0] = at;
	m->gap[0] = gap;
}

static void sphere_sphere(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *m)
{
	ob_vec3 d = ob_sub(a->p, b->p);
	double l = ob_norm(d), gap = l - a->size.x - b->size.x;
	ob_vec3 n = l > 0 ? ob_scale(d, 1 / l) : ob_v3(0, 0, 1);
	one_point(m, n, ob_madd(b->p, b->size.x + .5 * gap, n), gap, margin);
}

static void sphere_plane(const ob_placed *a, const ob_placed *plane, double margin, ob_manifold *m)
{
	ob_vec3 n = ob_column(&plane->r, 2);
	double gap = ob_dot(n, ob_sub(a->p, plane->p)) - a->size.x;
	one_point(m, n, ob_madd(a->p, -(a->size.x + .5 * gap), n), gap, margin);
}

static double clamp(double x, double limit)
{
	return x < -limit ? -limit : x > limit ? limit : x;
}

// Sphere a against box b. Inside the box the nearest face pushes out.
static void sphere_box(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *m)
{
	ob_vec3 l = ob_rotate_back(&b->r, ob_sub(a->p, b->p));
	ob_vec3 c = ob_v3(clamp(l.x, b->size.x), clamp(l.y, b->size.y), clamp(l.z, b->size.z));
	ob_vec3 d = ob_sub(l, c), n = { 0, 0, 0 };
	double distance = ob_norm(d);
	if (distance > 1e-8) {
		n = ob_scale(d, 1 / distance);
	} else {
		double dx = fabs(l.x) - b->size.x, dy = fabs(l.y) - b->size.y, dz = fabs(l.z) - b->size.z;
		if (dx >= dy && dx >= dz) {
			n.x = l.x < 0 ? -1 : 1, distance = dx, c.x = n.x * b->size.x;
		} else if (dy >= dz) {
			n.y = l.y < 0 ? -1 : 1, distance = dy, c.y = n.y * b->size.y;
		} else {
			n.z = l.z < 0 ? -1 : 1, distance = dz, c.z = n.z * b->size.z;
		}
	}
	double gap = distance - a->size.x;
	ob_vec3 nw = ob_rotate(&b->r, n), surface = ob_add(b->p, ob_rotate(&b->r, c));
	one_point(m, nw, ob_madd(surface, .5 * gap, nw), gap, margin);
}

// Box a against a plane: the four lowest corners within the margin.
static void box_plane(const ob_placed *a, const ob_placed *plane, double margin, ob_manifold *m)
{
	ob_vec3 n = ob_column(&plane->r, 2), corner[8];
	double gap[8];
	unsigned used = 0;
	for (int k = 0; k < 8; k++) {
		ob_vec3 h = { k & 1 ? a->size.x : -a->size.x, k & 2 ? a->size.y : -a->size.y,
			      k & 4 ? a->size.z : -a->size.z };
		corner[k] = ob_add(a->p, ob_rotate(&a->r, h));
		gap[k] = ob_dot(n, ob_sub(corner[k], plane->p));
	}
	m->normal = n;
	m->points = 0;
	for (int c = 0; c < 4; c++) {
		int low = -1;
		for (int k = 0; k < 8; k++)
			if (!(used >> k & 1) && (low < 0 || gap[k] < gap[low]))
				low = k;
		if (c == 0)
			m->separation = gap[low];
		if (gap[low] > margin)
			break;
		used |= 1u << low;
		m->at[m->points] = ob_madd(corner[low], -.5 * gap[low], n);
		m->gap[m->points++] = gap[low];
	}
}

static void flip(ob_manifold *m)
{
	m->normal = ob_scale(m->normal, -1);
}

bool ob_manifold_find(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_shape sa = a->shape, sb = b->shape;
	if (sa == OB_SHAPE_SPHERE && sb == OB_SHAPE_SPHERE)
		sphere_sphere(a, b, margin, out);
	else if (sa == OB_SHAPE_SPHERE && sb == OB_SHAPE_PLANE)
		sphere_plane(a, b, margin, out);
	else if (sa == OB_SHAPE_PLANE && sb == OB_SHAPE_SPHERE)
		sphere_plane(b, a, margin, out), flip(out);
	else if (sa == OB_SHAPE_SPHERE && sb == OB_SHAPE_BOX)
		sphere_box(a, b, margin, out);
	else if (sa == OB_SHAPE_BOX && sb == OB_SHAPE_SPHERE)
		sphere_box(b, a, margin, out), flip(out);
	else if (sa == OB_SHAPE_BOX && sb == OB_SHAPE_PLANE)
		box_plane(a, b, margin, out);
	else if (sa == OB_SHAPE_PLANE && sb == OB_SHAPE_BOX)
		box_plane(b, a, margin, out), flip(out);
	else if (sa == OB_SHAPE_BOX && sb == OB_SHAPE_BOX)
		ob_manifold_boxes(a, b, margin, out);
	else
		return false;
	return true;
}

// ---- time of impact

static ob_placed moved(const ob_placed *x, double t)
{
	ob_placed y = *x;
	double th = ob_norm(x->w) * t;
	y.p = ob_madd(x->p, t, x->v);
	if (th > 0) {
		ob_quat turn = ob_quat_turn(ob_quat_identity(), ob_scale(x->w, t));
		ob_mat3 m = ob_quat_matrix(turn);
		for (int c = 0; c < 3; c++) {
			ob_vec3 axis = ob_rotate(&m, ob_column(&x->r, c));
			y.r.m[0][c] = axis.x, y.r.m[1][c] = axis.y, y.r.m[2][c] = axis.z;
		}
	}
	return y;
}

double ob_time_of_impact(const ob_placed *a, const ob_placed *b, double speed, double h, double tolerance,
			 double margin, ob_manifold_finder find, ob_manifold *out)
{
	double t = 0, apart = 0;
	// A grazing flight takes many small advances; after so many, what is this near counts as touching.
	for (int tries = 0; tries < 256 && t <= h; tries++) {
		ob_placed at = moved(a, t), bt = moved(b, t);
		find.find(find.with, &at, &bt, tolerance, out);
		if (tries == 0)
			apart = out->separation;
		if (out->points)
			break;
		t += (fmax(out->separation, tolerance) - .5 * tolerance) / speed;
	}
	if (t <= h) {
		ob_placed at = moved(a, t), bt = moved(b, t);
		find.find(find.with, &at, &bt, margin, out);
		if (out->points)
			return t;
	}
	out->points = 0;
	out->separation = apart;
	return INFINITY;
}
