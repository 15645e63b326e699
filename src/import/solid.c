#include "import/solid.h"

#include <stdlib.h>
#include <string.h>

#include "hull/hull.h"
#include "shape/shape.h"

static const double alike = 1e-9; // relative: moments, and products of inertia; of the size: places

bool ob_geom_collides(const mjModel *m, int geom)
{
	return m->geom_contype[geom] || m->geom_conaffinity[geom];
}

static ob_vec3 vec(const double *x)
{
	return ob_v3(x[0], x[1], x[2]);
}

static ob_quat quat_of(const double *matrix)
{
	double q[4];
	mju_mat2Quat(q, matrix);
	return ob_quat_normalize((ob_quat){ q[0], q[1], q[2], q[3] });
}

// Shape and size of a geometry that obsim has, too.
static ob_shape shape_of(const mjModel *m, int geom, ob_vec3 *size)
{
	const double *s = m->geom_size + 3 * geom;
	*size = vec(s);
	switch (m->geom_type[geom]) {
	case mjGEOM_SPHERE:
		*size = ob_v3(s[0], 0, 0);
		return OB_SHAPE_SPHERE;
	case mjGEOM_CAPSULE:
		*size = ob_v3(s[0], s[1], 0);
		return OB_SHAPE_CAPSULE;
	case mjGEOM_CYLINDER:
		*size = ob_v3(s[0], s[1], 0);
		return OB_SHAPE_CYLINDER;
	case mjGEOM_BOX:
		return OB_SHAPE_BOX;
	case mjGEOM_PLANE:
		return OB_SHAPE_PLANE;
	default:
		return OB_SHAPE_NONE;
	}
}

// Tensor of inertia about the axes of a frame (columns of r), of a body with principal moments along those of "own".
static void turn_inertia(const ob_mat3 *own, ob_vec3 moments, const ob_mat3 *r, double out[3][3])
{
	const double moment[3] = { moments.x, moments.y, moments.z };
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++) {
			out[i][k] = 0;
			for (int c = 0; c < 3; c++)
				out[i][k] += moment[c] * ob_dot(ob_column(own, c), ob_column(r, i)) *
					     ob_dot(ob_column(own, c), ob_column(r, k));
		}
}

// True if a body of this shape may turn with these moments about its axes (object_limits.h).
static bool suits(ob_shape shape, const double i[3][3], ob_vec3 *moments)
{
	const double most = fmax(i[0][0], fmax(i[1][1], i[2][2])), off = alike * most;
	double x = i[0][0], y = i[1][1], z = i[2][2];
	if (fabs(i[0][1]) > off || fabs(i[0][2]) > off || fabs(i[1][2]) > off)
		return false;
	if (ob_shape_is(shape, OB_ROUND)) {
		if (fabs(x - y) > off || (ob_shape_is(shape, OB_ISOTROPIC) && fabs(x - z) > off))
			return false;
		y = x;
		z = ob_shape_is(shape, OB_ISOTROPIC) ? x : z;
	}
	*moments = ob_v3(x, y, z);
	return true;
}

static bool take_exact(const ob_drawn *d, int body, int geom, ob_imported_solid *out)
{
	const ob_vec3 at = vec(d->data->geom_xpos + 3 * geom), centre = vec(d->data->xipos + 3 * body);
	const ob_quat q = quat_of(d->data->geom_xmat + 9 * geom);
	const ob_mat3 r = ob_quat_matrix(q), own = ob_quat_matrix(quat_of(d->data->ximat + 9 * body));
	double tensor[3][3];
	ob_vec3 size;
	const ob_shape shape = shape_of(d->model, geom, &size);
	if (!ob_shape_is_bounded(shape) || ob_norm(ob_sub(at, centre)) > alike * ob_shape_radius(shape, size))
		return false;
	turn_inertia(&own, vec(d->model->body_inertia + 3 * body), &r, tensor);
	if (!suits(shape, tensor, &out->inertia))
		return false;
	out->shape = shape;
	out->size = size;
	out->pose = (ob_pose){ centre, q };
	return true;
}

// ---- hulls

enum { DIRECTIONS = 400 };

// Evenly spread directions: a spiral (Rakhmanov, Saff and Zhou 1994).
static ob_vec3 direction(int i, int n)
{
	const double golden = M_PI * (3 - sqrt(5)), z = 1 - (2 * i + 1.) / n, r = sqrt(1 - z * z);
	return ob_v3(r * cos(golden * i), r * sin(golden * i), z);
}

ob_vec3 ob_geom_farthest(const ob_drawn *d, int geom, ob_vec3 n)
{
	const mjModel *m = d->model;
	const ob_mat3 r = ob_quat_matrix(quat_of(d->data->geom_xmat + 9 * geom));
	const ob_vec3 l = ob_rotate_back(&r, n);
	const double *s = m->geom_size + 3 * geom;
	ob_vec3 size, p = { 0 };
	const ob_shape shape = shape_of(m, geom, &size);
	if (m->geom_type[geom] == mjGEOM_ELLIPSOID) {
		const ob_vec3 scaled = ob_v3(s[0] * l.x, s[1] * l.y, s[2] * l.z);
		const double length = ob_norm(scaled);
		p = ob_scale(ob_v3(s[0] * scaled.x, s[1] * scaled.y, s[2] * scaled.z), 1 / length);
	} else if (m->geom_type[geom] == mjGEOM_MESH) {
		const int mesh = m->geom_dataid[geom];
		const float *v = m->mesh_vert + 3 * m->mesh_vertadr[mesh];
		double most = -INFINITY;
		for (int i = 0; i < m->mesh_vertnum[mesh]; i++) {
			const ob_vec3 at = ob_v3(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
			if (ob_dot(at, l) > most)
				most = ob_dot(at, l), p = at;
		}
	} else {
		p = ob_shape_kind_of(shape)->farthest(&size, NULL, &l);
	}
	return ob_add(vec(d->data->geom_xpos + 3 * geom), ob_rotate(&r, p));
}

bool ob_geom_has_extent(const mjModel *m, int geom)
{
	ob_vec3 size;
	const int type = m->geom_type[geom];
	return type == mjGEOM_ELLIPSOID || (type == mjGEOM_MESH && m->geom_dataid[geom] >= 0) ||
	       ob_shape_is_bounded(shape_of(m, geom, &size));
}

// Adds the support points along n directions of the geometries first .. end-1, in the frame of the solid.
static void add_points(const ob_drawn *d, int first, int end, int n, ob_imported_solid *out)
{
	const ob_mat3 r = ob_quat_matrix(out->pose.q);
	out->points = 0;
	for (int i = 0; i < n; i++) {
		const ob_vec3 l = direction(i, n), w = ob_rotate(&r, l);
		ob_vec3 p = { 0 };
		double most = -INFINITY;
		for (int geom = first; geom < end; geom++) {
			if (!ob_geom_collides(d->model, geom) || !ob_geom_has_extent(d->model, geom))
				continue;
			const ob_vec3 at = ob_rotate_back(&r, ob_sub(ob_geom_farthest(d, geom, w), out->pose.p));
			if (ob_dot(at, l) > most)
				most = ob_dot(at, l), p = at;
		}
		bool known = false;
		for (uint32_t k = 0; k < out->points; k++)
			known |= ob_norm2(ob_sub(out->point[k], p)) == 0;
		if (!known && out->points < OB_HULL_CORNERS_MAX)
			out->point[out->points++] = p;
		else if (!known)
			out->inside = INFINITY; // more corners than a hull has
	}
}

// Finds by how much the geometries stand out of the hull.
static double standing_out(const ob_drawn *d, int first, int end, const ob_imported_solid *s)
{
	const ob_mat3 r = ob_quat_matrix(s->pose.q);
	double most = 0;
	for (int i = 0; i < DIRECTIONS; i++) {
		const ob_vec3 l = direction(i, DIRECTIONS), w = ob_rotate(&r, l);
		double own = -INFINITY, all = -INFINITY;
		for (uint32_t k = 0; k < s->points; k++)
			own = fmax(own, ob_dot(s->point[k], l));
		for (int geom = first; geom < end; geom++)
			if (ob_geom_collides(d->model, geom) && ob_geom_has_extent(d->model, geom))
				all = fmax(
					all,
					ob_dot(ob_rotate_back(&r, ob_sub(ob_geom_farthest(d, geom, w), s->pose.p)), l));
		most = fmax(most, all - own);
	}
	return most;
}

// Makes the hull of the geometries first .. end-1 about the solid's frame. inward: the origin must be well inside it.
static bool take_hull(const ob_drawn *d, int first, int end, bool inward, ob_imported_solid *out)
{
	ob_hull *h = malloc(sizeof *h);
	ob_error e;
	out->inside = 0;
	add_points(d, first, end, DIRECTIONS, out);
	if (out->inside > 0)
		add_points(d, first, end, OB_HULL_CORNERS_MAX, out);
	const bool done = h && ob_hull_build(out->point, out->points, h, &e) &&
			  (!inward || ob_hull_set_inertia(h, ob_v3(1, 1, 1), &e));
	free(h);
	if (!done)
		return false;
	out->shape = OB_SHAPE_HULL;
	out->inside = standing_out(d, first, end, out);
	out->inside *= out->inside > alike * ob_norm(out->point[0]);
	return true;
}

void ob_solid_of_body(const ob_drawn *d, int body, ob_imported_solid *out)
{
	const mjModel *m = d->model;
	const int first = m->body_geomadr[body], end = first + m->body_geomnum[body];
	int only = -1;
	*out = (ob_imported_solid){ .shape = OB_SHAPE_NONE };
	for (int geom = first; geom < end; geom++)
		if (ob_geom_collides(m, geom)) {
			out->geoms += ob_geom_has_extent(m, geom);
			only = geom;
		}
	if (out->geoms == 1 && take_exact(d, body, only, out))
		return;
	out->pose = (ob_pose){ vec(d->data->xipos + 3 * body), quat_of(d->data->ximat + 9 * body) };
	out->inertia = vec(m->body_inertia + 3 * body);
	if (out->geoms && !take_hull(d, first, end, true, out))
		out->shape = OB_SHAPE_NONE;
}

void ob_solid_of_geom(const ob_drawn *d, int geom, ob_imported_solid *out)
{
	*out = (ob_imported_solid){ .geoms = 1 };
	out->pose = (ob_pose){ vec(d->data->geom_xpos + 3 * geom), quat_of(d->data->geom_xmat + 9 * geom) };
	out->shape = shape_of(d->model, geom, &out->size);
	if (out->shape == OB_SHAPE_NONE &&
	    (!ob_geom_has_extent(d->model, geom) || !take_hull(d, geom, geom + 1, false, out)))
		out->shape = OB_SHAPE_NONE;
}
