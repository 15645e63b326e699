#include "import/solid.h"

#include <stdlib.h>
#include <string.h>

#include "hull/hull.h"
#include "shape/shape.h"

static const double least_inside = .125; // of a compound's thickness: radius of the ball in it (object_limits.c)
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

// Geometries that collide: one, or all of an object.
typedef struct group {
	const ob_drawn *d;
	int body, geom; // geom -1: all of the body's object
	ob_pose frame;
} group;

static bool counts(const group *g, int geom)
{
	const mjModel *m = g->d->model;
	return (g->geom >= 0 ? geom == g->geom : ob_drawn_holder(m, m->geom_bodyid[geom]) == g->body) &&
	       ob_geom_collides(m, geom) && ob_geom_has_extent(m, geom);
}

// Support point of the group along l, both in its frame.
static ob_vec3 farthest(const group *g, ob_vec3 l)
{
	const ob_mat3 r = ob_quat_matrix(g->frame.q);
	const ob_vec3 w = ob_rotate(&r, l);
	ob_vec3 p = { 0, 0, 0 };
	double most = -INFINITY;
	for (int geom = 0; geom < g->d->model->ngeom; geom++) {
		if (!counts(g, geom))
			continue;
		const ob_vec3 at = ob_rotate_back(&r, ob_sub(ob_geom_farthest(g->d, geom, w), g->frame.p));
		if (ob_dot(at, l) > most)
			most = ob_dot(at, l), p = at;
	}
	return p;
}

// Makes the piece of the support points along n directions. Returns false if a hull has not so many corners.
static bool add_points(const group *g, int n, ob_imported_piece *to)
{
	*to = (ob_imported_piece){ .points = 0 };
	for (int i = 0; i < n; i++) {
		const ob_vec3 p = farthest(g, direction(i, n));
		bool known = false;
		for (uint32_t k = 0; k < to->points; k++)
			known |= ob_norm2(ob_sub(to->point[k], p)) == 0;
		if (!known && to->points == OB_HULL_CORNERS_MAX)
			return false;
		if (!known)
			to->point[to->points++] = p;
	}
	return true;
}

// Finds by how much the geometries stand out of the piece.
static double standing_out(const group *g, const ob_imported_piece *piece)
{
	double most = 0;
	for (int i = 0; i < DIRECTIONS; i++) {
		const ob_vec3 l = direction(i, DIRECTIONS);
		double own = -INFINITY;
		for (uint32_t k = 0; k < piece->points; k++)
			own = fmax(own, ob_dot(piece->point[k], l));
		most = fmax(most, ob_dot(farthest(g, l), l) - own);
	}
	return most > alike * ob_norm(piece->point[0]) ? most : 0;
}

static bool is_round(const group *g)
{
	ob_vec3 size;
	return g->geom >= 0 && ob_shape_is(shape_of(g->d->model, g->geom, &size), OB_ROUND);
}

// Makes the piece of the only geometry of the group if that is a box, or round.
static bool take_exact_piece(const group *g, ob_imported_piece *to)
{
	const mjModel *m = g->d->model;
	ob_vec3 size;
	const ob_shape shape = g->geom < 0 ? OB_SHAPE_NONE : shape_of(m, g->geom, &size);
	if (shape != OB_SHAPE_BOX && !ob_shape_is(shape, OB_ROUND))
		return false;
	const ob_mat3 r = ob_quat_matrix(g->frame.q);
	const ob_vec3 off = ob_sub(vec(g->d->data->geom_xpos + 3 * g->geom), g->frame.p);
	*to = (ob_imported_piece){ .pose.p = ob_rotate_back(&r, off) };
	to->pose.q = ob_quat_mul(ob_quat_conjugate(g->frame.q), quat_of(g->d->data->geom_xmat + 9 * g->geom));
	if (shape != OB_SHAPE_BOX) {
		to->round = shape, to->size = size;
		return true;
	}
	to->half = size, to->points = 8;
	const ob_mat3 turn = ob_quat_matrix(to->pose.q);
	for (uint32_t k = 0; k < 8; k++)
		to->point[k] = ob_add(to->pose.p, ob_rotate(&turn, ob_box_corner(to->half, k)));
	return true;
}

// Builds the hulls of a solid's pieces, with moments of its own. inward: its origin must be well inside them.
static bool build(bool inward, ob_imported_solid *s)
{
	ob_hull_part part[OB_HULL_PARTS_MAX];
	const ob_vec3 any = ob_v3(1, 1, 1);
	uint32_t failed;
	ob_error e;
	if (!ob_solid_is_compound(s))
		return ob_hull_build(s->piece->point, s->piece->points, s->hull, &e) &&
		       (!inward || ob_hull_set_inertia(s->hull, any, &e));
	for (uint32_t i = 0; i < s->pieces; i++)
		part[i] = (ob_hull_part){ s->piece[i].point, s->piece[i].points, 1,
					  s->piece[i].round, s->piece[i].size,   s->piece[i].pose };
	return ob_hull_build_compound(part, s->pieces, any, s->hull, &failed, &e) &&
	       s->hull->inner >= least_inside * s->hull->thickness;
}

// Makes the hulls of groups about the solid's frame: as fine as fits into the corners of all together.
static bool take_hulls(const group *g, uint32_t groups, bool inward, ob_imported_solid *out)
{
	static const int directions[] = { DIRECTIONS, OB_HULL_CORNERS_MAX, 48, 32, 24, 16, 12 };
	bool done = false;
	out->pieces = groups;
	out->piece = calloc(groups, sizeof *out->piece);
	out->hull = calloc(1 + groups, sizeof *out->hull);
	for (size_t k = 0; out->piece && out->hull && !done && k < sizeof directions / sizeof *directions; k++) {
		bool fit = true;
		for (uint32_t i = 0; i < groups; i++)
			fit &= ((groups > 1 || is_round(&g[i])) && take_exact_piece(&g[i], &out->piece[i])) ||
			       add_points(&g[i], directions[k], &out->piece[i]);
		done = fit && build(inward, out);
	}
	if (!done) {
		free(out->piece), free(out->hull);
		out->piece = NULL, out->hull = NULL, out->pieces = 0;
		return false;
	}
	out->shape = OB_SHAPE_HULL;
	out->inside = 0;
	for (uint32_t i = 0; i < groups; i++) {
		out->piece[i].inside = out->piece[i].round ? 0 : standing_out(&g[i], &out->piece[i]);
		out->inside = fmax(out->inside, out->piece[i].inside);
	}
	return true;
}

void ob_solid_of_body(const ob_drawn *d, int body, ob_imported_solid *out)
{
	const mjModel *m = d->model;
	group all = { .d = d, .body = body, .geom = -1 }, each[OB_HULL_PARTS_MAX];
	*out = (ob_imported_solid){ .shape = OB_SHAPE_NONE };
	out->pose = (ob_pose){ vec(d->data->xipos + 3 * body), quat_of(d->data->ximat + 9 * body) };
	all.frame = out->pose;
	for (int geom = 0; geom < m->ngeom; geom++) {
		if (!counts(&all, geom))
			continue;
		if (out->geoms < OB_HULL_PARTS_MAX)
			each[out->geoms] = (group){ d, body, geom, out->pose };
		out->geoms++;
	}
	if (out->geoms == 1 && take_exact(d, body, each->geom, out))
		return;
	out->inertia = vec(m->body_inertia + 3 * body);
	const bool compound = out->geoms > 1 || (out->geoms == 1 && is_round(each));
	if (compound && out->geoms <= OB_HULL_PARTS_MAX && take_hulls(each, out->geoms, true, out))
		return;
	if (out->geoms)
		take_hulls(&all, 1, true, out);
}

void ob_solid_of_geom(const ob_drawn *d, int geom, ob_imported_solid *out)
{
	*out = (ob_imported_solid){ .geoms = 1 };
	out->pose = (ob_pose){ vec(d->data->geom_xpos + 3 * geom), quat_of(d->data->geom_xmat + 9 * geom) };
	out->shape = shape_of(d->model, geom, &out->size);
	if (out->shape == OB_SHAPE_NONE && ob_geom_has_extent(d->model, geom))
		take_hulls(&(group){ d, 0, geom, out->pose }, 1, false, out);
}
