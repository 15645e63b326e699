#include "hull/hull.h"

#include <assert.h>
#include <libqhull_r/qhull_ra.h>
#include <stdlib.h>
#include <string.h>

#include "elementary/elementary.h"
#include "shape/shape.h"

static_assert(sizeof(ob_hull_edge) == 4 && OB_HULL_CORNERS_MAX <= UINT8_MAX && OB_HULL_FACES_MAX <= UINT8_MAX,
	      "indices of corners and faces have a byte");

static const double thinnest = 1e-6; // of the radius
static const double noise = 1e-13; // relative to a tensor's trace: off-diagonal terms, or differences of moments
static const double rounding = 1e-14; // of the radius: a centre so near to the origin counts as the origin

static const char too_flat[] = "expected points that are not all in one plane, and no thinner than 1e-6 of their size";

// ---- qhull

// Face as qhull finds it: its corners, in no order.
typedef struct raw_face {
	ob_vec3 normal;
	uint32_t corners;
	uint8_t corner[OB_HULL_CORNERS_MAX];
} raw_face;

typedef struct raw_hull {
	ob_vec3 *point; // sorted, without duplicates
	size_t points;
	bool *is_corner; // [points]
	uint32_t faces;
	raw_face face[OB_HULL_FACES_MAX];
} raw_hull;

// Lexicographic, so that the order of the given points makes no difference.
static int by_place(const void *pa, const void *pb)
{
	const ob_vec3 *a = pa, *b = pb;
	if (a->x != b->x)
		return a->x < b->x ? -1 : 1;
	if (a->y != b->y)
		return a->y < b->y ? -1 : 1;
	return (a->z > b->z) - (a->z < b->z);
}

static size_t sort_points(ob_vec3 *point, size_t n)
{
	size_t kept = 0;
	qsort(point, n, sizeof *point, by_place);
	for (size_t i = 0; i < n; i++)
		if (!kept || by_place(&point[kept - 1], &point[i]) != 0)
			point[kept++] = point[i];
	return kept;
}

static void take_faces(qhT *qh, raw_hull *h)
{
	facetT *facet;
	h->faces = 0;
	FORALLfacets
	{
		vertexT *vertex, **vertexp;
		raw_face *f = &h->face[h->faces++];
		f->normal = ob_v3(facet->normal[0], facet->normal[1], facet->normal[2]);
		f->corners = 0;
		FOREACHvertex_(facet->vertices) if (f->corners < OB_HULL_CORNERS_MAX) f->corner[f->corners++] =
			(uint8_t)qh_pointid(qh, vertex->point);
	}
}

// Marks the corners among the points. with_faces: every point is a corner; stores faces, too. Returns false if qhull
// finds no hull.
static bool run_qhull(raw_hull *h, bool with_faces)
{
	char *said = NULL, command[] = "qhull";
	size_t length = 0;
	FILE *log = open_memstream(&said, &length);
	qhT *qh = malloc(sizeof *qh);
	double *place = malloc(h->points * sizeof(double[3]));
	bool fine = log && qh && place;
	for (size_t i = 0; fine && i < h->points; i++)
		memcpy(place + 3 * i, (double[3]){ h->point[i].x, h->point[i].y, h->point[i].z }, sizeof(double[3]));
	if (fine) {
		int left, all;
		qh_zero(qh, log);
		fine = qh_new_qhull(qh, 3, (int)h->points, place, false, command, NULL, log) == 0;
		if (fine && with_faces)
			fine = qh->num_facets <= OB_HULL_FACES_MAX;
		if (fine && with_faces)
			take_faces(qh, h);
		vertexT *vertex;
		memset(h->is_corner, 0, h->points * sizeof *h->is_corner);
		for (vertex = fine ? qh->vertex_list : NULL; vertex && vertex->next; vertex = vertex->next)
			h->is_corner[qh_pointid(qh, vertex->point)] = true;
		qh_freeqhull(qh, !qh_ALL);
		qh_memfreeshort(qh, &left, &all);
	}
	free(place);
	free(qh);
	if (log)
		fclose(log);
	free(said);
	return fine;
}

static void keep_corners(raw_hull *h)
{
	size_t kept = 0;
	for (size_t i = 0; i < h->points; i++)
		if (h->is_corner[i])
			h->point[kept++] = h->point[i];
	h->points = kept;
}

// ---- faces and edges

// Sorts the corners of a face counterclockwise around its normal.
static void order_corners(const ob_vec3 *corner, raw_face *f)
{
	ob_vec3 middle = ob_v3(0, 0, 0);
	double angle[OB_HULL_CORNERS_MAX];
	for (uint32_t k = 0; k < f->corners; k++)
		middle = ob_madd(middle, 1. / f->corners, corner[f->corner[k]]);
	const ob_vec3 first = ob_sub(corner[f->corner[0]], middle), across = ob_cross(f->normal, first);
	for (uint32_t k = 0; k < f->corners; k++) {
		const ob_vec3 d = ob_sub(corner[f->corner[k]], middle);
		const double turn = k ? ob_atan2(ob_dot(d, across), ob_dot(d, first)) : 0;
		const uint8_t c = f->corner[k];
		uint32_t at = k;
		for (; at > 0 && angle[at - 1] > turn; at--)
			angle[at] = angle[at - 1], f->corner[at] = f->corner[at - 1];
		angle[at] = turn, f->corner[at] = c;
	}
}

// Newell's normal of a polygon (Sutherland, Sproull and Schumacker 1974): weights all corners alike.
static ob_vec3 newell(const ob_hull *h, uint32_t f)
{
	ob_vec3 n = ob_v3(0, 0, 0);
	const ob_vec3 origin = h->corner[h->loop[h->first[f]]];
	for (uint32_t k = h->first[f] + 1u; k + 1 < h->first[f + 1]; k++)
		n = ob_add(n,
			   ob_cross(ob_sub(h->corner[h->loop[k]], origin), ob_sub(h->corner[h->loop[k + 1]], origin)));
	return n;
}

static void set_planes(ob_hull *h)
{
	for (uint32_t f = 0; f < h->faces; f++) {
		const ob_vec3 n = newell(h, f);
		const uint32_t corners = h->first[f + 1] - h->first[f];
		h->normal[f] = ob_scale(n, 1 / ob_norm(n));
		double sum = 0;
		for (uint32_t k = h->first[f]; k < h->first[f + 1]; k++)
			sum += ob_dot(h->normal[f], h->corner[h->loop[k]]);
		h->offset[f] = sum / corners;
	}
}

// Finds each edge from the face that has it from the lower to the higher corner; the other face has it reversed.
static bool find_edges(ob_hull *h)
{
	enum { NONE = OB_HULL_FACES_MAX };
	uint8_t face_of[OB_HULL_CORNERS_MAX][OB_HULL_CORNERS_MAX];
	memset(face_of, NONE, sizeof face_of);
	for (uint32_t f = 0; f < h->faces; f++)
		for (uint32_t k = h->first[f]; k < h->first[f + 1]; k++) {
			const uint32_t next = k + 1 < h->first[f + 1] ? k + 1 : h->first[f];
			uint8_t *at = &face_of[h->loop[k]][h->loop[next]];
			if (*at != NONE)
				return false;
			*at = (uint8_t)f;
		}
	h->edges = 0;
	for (uint32_t i = 0; i < h->corners; i++)
		for (uint32_t j = 0; j < h->corners; j++) {
			if (face_of[i][j] == NONE)
				continue;
			if (face_of[j][i] == NONE || (i < j && h->edges == OB_HULL_EDGES_MAX))
				return false;
			if (i < j)
				h->edge[h->edges++] =
					(ob_hull_edge){ (uint8_t)i, (uint8_t)j, face_of[i][j], face_of[j][i] };
		}
	return h->corners + h->faces == h->edges + 2 && h->first[h->faces] == 2 * h->edges;
}

static bool take_shape(raw_hull *raw, ob_hull *h)
{
	uint32_t loops = 0;
	h->corners = (uint32_t)raw->points;
	h->faces = raw->faces;
	memcpy(h->corner, raw->point, raw->points * sizeof *raw->point);
	for (uint32_t f = 0; f < raw->faces; f++) {
		raw_face *face = &raw->face[f];
		if (face->corners < 3 || loops + face->corners > 2 * OB_HULL_EDGES_MAX)
			return false;
		order_corners(h->corner, face);
		h->first[f] = (uint16_t)loops;
		memcpy(h->loop + loops, face->corner, face->corners);
		loops += face->corners;
	}
	h->first[h->faces] = (uint16_t)loops;
	return find_edges(h);
}

// ---- mass

typedef struct integrals {
	double volume; // m^3
	ob_vec3 first; // m^4
	double second[3][3]; // m^5, of x_i x_j
} integrals;

// Sums, exactly, over the tetrahedra of the origin and each triangle of each face.
static integrals integrate(const ob_hull *h)
{
	integrals out = { 0 };
	for (uint32_t f = 0; f < h->faces; f++)
		for (uint32_t k = h->first[f] + 1u; k + 1 < h->first[f + 1]; k++) {
			const ob_vec3 a = h->corner[h->loop[h->first[f]]], b = h->corner[h->loop[k]],
				      c = h->corner[h->loop[k + 1]], s = ob_add(a, ob_add(b, c));
			const double det = ob_dot(a, ob_cross(b, c));
			const double x[4][3] = {
				{ a.x, a.y, a.z }, { b.x, b.y, b.z }, { c.x, c.y, c.z }, { s.x, s.y, s.z }
			};
			out.volume += det / 6;
			out.first = ob_madd(out.first, det / 24, s);
			for (int v = 0; v < 4; v++)
				for (int i = 0; i < 3; i++)
					for (int j = 0; j < 3; j++)
						out.second[i][j] += det / 120 * x[v][i] * x[v][j];
		}
	return out;
}

static double radius_of(const ob_hull *h)
{
	double most = 0;
	for (uint32_t k = 0; k < h->corners; k++)
		most = fmax(most, ob_norm(h->corner[k]));
	return most;
}

static double snapped(double x, double least)
{
	return fabs(x) < least ? 0 : x;
}

// Jacobi's rotations: the axes of the symmetric matrix m become the columns of r, and m becomes diagonal.
static void diagonalise(double m[3][3], double r[3][3])
{
	enum { SWEEPS = 30 };
	const double least = noise * (m[0][0] + m[1][1] + m[2][2]);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			r[i][j] = i == j;
	for (int sweep = 0; sweep < SWEEPS; sweep++)
		for (int p = 0; p < 2; p++)
			for (int q = p + 1; q < 3; q++) {
				if (fabs(m[p][q]) <= (sweep ? 1e-3 : 1) * least)
					continue;
				const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
				const double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
				const double c = 1 / sqrt(t * t + 1), s = t * c;
				for (int k = 0; k < 3; k++) {
					const double a = m[k][p], b = m[k][q];
					m[k][p] = c * a - s * b, m[k][q] = s * a + c * b;
				}
				for (int k = 0; k < 3; k++) {
					const double a = m[p][k], b = m[q][k];
					m[p][k] = c * a - s * b, m[q][k] = s * a + c * b;
				}
				for (int k = 0; k < 3; k++) {
					const double a = r[k][p], b = r[k][q];
					r[k][p] = c * a - s * b, r[k][q] = s * a + c * b;
				}
			}
}

// Quaternion of a rotation matrix (Shepperd 1978).
static ob_quat quaternion_of(double r[3][3])
{
	const double trace = r[0][0] + r[1][1] + r[2][2];
	double q[4] = { trace, r[0][0], r[1][1], r[2][2] };
	int best = 0;
	for (int i = 1; i < 4; i++)
		if (q[i] > q[best])
			best = i;
	const double anti[3] = { r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1] };
	if (best == 0)
		return ob_quat_normalize((ob_quat){ 1 + trace, anti[0], anti[1], anti[2] });
	const int i = best - 1, j = (i + 1) % 3, k = (i + 2) % 3;
	q[0] = anti[i];
	q[1 + i] = 1 + r[i][i] - r[j][j] - r[k][k];
	q[1 + j] = r[j][i] + r[i][j];
	q[1 + k] = r[k][i] + r[i][k];
	return ob_quat_normalize((ob_quat){ q[0], q[1], q[2], q[3] });
}

// Makes moments equal that differ by rounding alone: such a body turns at a constant rate.
static void make_equal(double m[3][3], double least)
{
	const double mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
	bool all = true;
	for (int i = 0; i < 3; i++)
		all &= fabs(m[i][i] - mean) <= least;
	for (int i = 0; i < 3; i++) {
		double *a = &m[i][i], *b = &m[(i + 1) % 3][(i + 1) % 3];
		if (all)
			*a = mean;
		else if (fabs(*a - *b) <= least)
			*a = *b = .5 * (*a + *b);
	}
}

// Moves the corners to the centre of mass, then turns them into the principal frame. from: former origin of the
// corners.
static void set_frame(ob_hull *h, ob_vec3 from)
{
	enum { ROUNDS = 2 };
	const double radius = radius_of(h);
	ob_vec3 centre = ob_v3(0, 0, 0);
	integrals mass = { 0 };
	for (int round = 0; round < ROUNDS; round++) {
		mass = integrate(h);
		const ob_vec3 off = ob_scale(mass.first, 1 / mass.volume);
		const ob_vec3 by = ob_v3(snapped(off.x, rounding * radius), snapped(off.y, rounding * radius),
					 snapped(off.z, rounding * radius));
		for (uint32_t k = 0; k < h->corners; k++)
			h->corner[k] = ob_sub(h->corner[k], by);
		centre = ob_add(centre, by);
	}
	mass = integrate(h);
	double tensor[3][3], r[3][3];
	const double trace = mass.second[0][0] + mass.second[1][1] + mass.second[2][2];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			tensor[i][j] = ((i == j ? trace : 0) - mass.second[i][j]) / mass.volume;
	diagonalise(tensor, r);
	make_equal(tensor, 10 * noise * (tensor[0][0] + tensor[1][1] + tensor[2][2]));
	h->volume = mass.volume;
	h->inertia = ob_v3(tensor[0][0], tensor[1][1], tensor[2][2]);
	h->centre = ob_add(from, centre);
	h->frame = quaternion_of(r);
	const ob_mat3 turn = ob_quat_matrix(h->frame);
	for (uint32_t k = 0; k < h->corners; k++)
		h->corner[k] = ob_rotate_back(&turn, h->corner[k]);
}

// Width along n; stops above `enough`.
static double width_along(const ob_hull *h, ob_vec3 n, double enough)
{
	double low = INFINITY, high = -INFINITY;
	for (uint32_t k = 0; k < h->corners && !(high - low > enough); k++) {
		const double x = ob_dot(n, h->corner[k]);
		low = fmin(low, x), high = fmax(high, x);
	}
	return high - low;
}

// Least width: across a face, or across two edges (Houle and Toussaint 1988).
static double least_width(const ob_hull *h)
{
	double least = INFINITY;
	for (uint32_t f = 0; f < h->faces; f++)
		least = fmin(least, width_along(h, h->normal[f], least));
	for (uint32_t i = 0; i < h->edges; i++)
		for (uint32_t j = i + 1; j < h->edges; j++) {
			const ob_vec3 u = ob_sub(h->corner[h->edge[i].to], h->corner[h->edge[i].from]);
			const ob_vec3 v = ob_sub(h->corner[h->edge[j].to], h->corner[h->edge[j].from]),
				      n = ob_cross(u, v);
			const double l2 = ob_norm2(n);
			if (l2 > 1e-8 * ob_norm2(u) * ob_norm2(v))
				least = fmin(least, width_along(h, ob_scale(n, 1 / sqrt(l2)), least));
		}
	return least;
}

static void set_balls(ob_hull *h)
{
	h->radius = radius_of(h);
	h->inner = INFINITY;
	for (uint32_t f = 0; f < h->faces; f++)
		h->inner = fmin(h->inner, h->offset[f]);
}

// ---- all of it

static ob_vec3 middle_of_bounds(const ob_vec3 *point, size_t n)
{
	ob_vec3 low = point[0], high = point[0];
	for (size_t i = 0; i < n; i++) {
		low = ob_v3(fmin(low.x, point[i].x), fmin(low.y, point[i].y), fmin(low.z, point[i].z));
		high = ob_v3(fmax(high.x, point[i].x), fmax(high.y, point[i].y), fmax(high.z, point[i].z));
	}
	return ob_scale(ob_add(low, high), .5);
}

// Takes the faces of the corners alone. A corner that lies on an edge of the others, but for rounding, may turn out to
// be none.
static bool take_corners(raw_hull *raw)
{
	enum { ROUNDS = 4 };
	for (int i = 0; i < ROUNDS; i++) {
		const size_t before = raw->points;
		if (!run_qhull(raw, true))
			return false;
		keep_corners(raw);
		if (raw->points == before)
			return true;
	}
	return false;
}

// Moves the points so that the corners' middle is the origin, which preserves most digits.
static bool build(raw_hull *raw, ob_hull *out, ob_error *e)
{
	const ob_vec3 middle = middle_of_bounds(raw->point, raw->points);
	for (size_t i = 0; i < raw->points; i++)
		raw->point[i] = ob_sub(raw->point[i], middle);
	if (raw->points < 4 || !run_qhull(raw, false))
		return ob_fail(e, "%s", raw->points < 4 ? "expected at least four different points" : too_flat);
	keep_corners(raw);
	if (raw->points > OB_HULL_CORNERS_MAX)
		return ob_fail(e, "expected a hull of at most %d corners, got %zu", OB_HULL_CORNERS_MAX, raw->points);
	if (!take_corners(raw) || !take_shape(raw, out))
		return ob_fail(e, "%s", too_flat);
	set_frame(out, middle);
	set_planes(out);
	set_balls(out);
	out->thickness = least_width(out);
	if (!(out->thickness > thinnest * out->radius) || !ob_hull_makes_sense(out))
		return ob_fail(e, "%s", too_flat);
	return true;
}

bool ob_hull_build(const ob_vec3 *point, size_t points, ob_hull *out, ob_error *e)
{
	memset(out, 0, sizeof *out);
	if (points < 4)
		return ob_fail(e, "expected at least four different points");
	if (points > OB_HULL_POINTS_MAX)
		return ob_fail(e, "expected at most %d points, got %zu", OB_HULL_POINTS_MAX, points);
	for (size_t i = 0; i < points; i++)
		if (!ob_is_finite(point[i]))
			return ob_fail(e, "expected points of finite numbers");
	raw_hull *raw = calloc(1, sizeof *raw);
	bool fine = raw;
	if (raw) {
		raw->point = malloc(points * sizeof *raw->point);
		raw->is_corner = malloc(points * sizeof *raw->is_corner);
		fine = raw->point && raw->is_corner;
	}
	if (fine) {
		memcpy(raw->point, point, points * sizeof *point);
		raw->points = sort_points(raw->point, points);
		fine = build(raw, out, e);
	} else {
		ob_fail(e, "no memory");
	}
	if (raw) {
		free(raw->point);
		free(raw->is_corner);
	}
	free(raw);
	return fine;
}

void ob_hull_find_corners(const ob_hull *h, const ob_vec3 *point, size_t points, ob_hull_corners *out)
{
	const ob_mat3 r = ob_quat_matrix(h->frame);
	memset(out, 0, sizeof *out);
	out->count = h->corners;
	for (uint32_t k = 0; k < h->corners; k++) {
		const ob_vec3 corner = ob_add(h->centre, ob_rotate(&r, h->corner[k]));
		double least = INFINITY;
		for (size_t i = 0; i < points; i++) {
			const double d2 = ob_norm2(ob_sub(point[i], corner));
			if (d2 < least) {
				least = d2;
				out->at[k] = point[i];
			}
		}
	}
}

// ---- other frames

// Gives the hull another frame: its origin and axes in the frame of its points.
static void move_frame(ob_hull *h, ob_vec3 centre, const ob_mat3 *axes)
{
	const ob_mat3 r = ob_quat_matrix(h->frame);
	double nearest = INFINITY;
	for (uint32_t k = 0; k < h->corners; k++) {
		h->corner[k] = ob_rotate_back(axes, ob_sub(ob_add(h->centre, ob_rotate(&r, h->corner[k])), centre));
		nearest = fmin(nearest, ob_norm(h->corner[k]));
	}
	for (uint32_t f = 0; f < h->faces; f++) {
		const ob_vec3 n = ob_rotate(&r, h->normal[f]);
		h->offset[f] += ob_dot(n, ob_sub(h->centre, centre));
		h->normal[f] = ob_rotate_back(axes, n);
	}
	set_balls(h);
	if (!(h->inner > 0))
		h->inner = -nearest; // no corner is nearer than the hull
}

bool ob_hull_set_inertia(ob_hull *h, ob_vec3 inertia, ob_error *e)
{
	const ob_mat3 same = ob_quat_matrix(ob_quat_identity());
	const double least_share = .25; // in half thicknesses: collision tests take the ball inside for a core
	move_frame(h, ob_v3(0, 0, 0), &same);
	h->centre = ob_v3(0, 0, 0);
	h->frame = ob_quat_identity();
	h->inertia = inertia;
	return h->inner >= least_share * .5 * h->thickness ||
	       ob_fail(e, "inertia: expected the origin, which is the centre of mass then, well inside the hull");
}

// ---- round parts

// Adds points of a circle about z, n of them, to those of a part.
static uint32_t add_ring(ob_vec3 *point, uint32_t count, uint32_t n, double radius, double z)
{
	for (uint32_t i = 0; i < n; i++) {
		double s, c;
		ob_sincos(2 * M_PI * i / n, &s, &c);
		point[count++] = ob_v3(radius * c, radius * s, z);
	}
	return count;
}

// Finds points of a round shape: its look.
static uint32_t points_of_round(ob_shape shape, ob_vec3 size, ob_vec3 *point)
{
	enum { RIM = 32, SLICES = 10, RINGS = 3 };
	uint32_t n = 0;
	if (ob_shape_is(shape, OB_RIMMED))
		return add_ring(point, add_ring(point, 0, RIM, size.x, -size.y), RIM, size.x, size.y);
	const double half = ob_shape_is(shape, OB_AXIAL) ? size.y : 0;
	for (int side = -1; side <= 1; side += 2) {
		point[n++] = ob_v3(0, 0, side * (half + size.x));
		for (int i = half > 0 || side < 0 ? 0 : 1; i < RINGS; i++) {
			double s, c;
			ob_sincos(M_PI / 2 * i / RINGS, &s, &c);
			n = add_ring(point, n, SLICES, size.x * c, side * (half + size.x * s));
		}
	}
	return n;
}

static bool build_round(const ob_hull_part *p, ob_hull *out, ob_error *e)
{
	ob_vec3 point[OB_HULL_CORNERS_MAX];
	const ob_mat3 r = ob_quat_matrix(p->pose.q);
	const uint32_t n = points_of_round(p->round, p->size, point);
	for (uint32_t i = 0; i < n; i++)
		point[i] = ob_add(p->pose.p, ob_rotate(&r, point[i]));
	if (!ob_hull_build(point, n, out, e))
		return false;
	move_frame(out, p->pose.p, &r);
	out->round = p->round;
	out->size = p->size;
	out->centre = p->pose.p;
	out->frame = p->pose.q;
	out->volume = ob_shape_volume(p->round, p->size, NULL);
	out->inertia = ob_shape_inertia(p->round, p->size, NULL, 1);
	out->thickness = ob_shape_thickness(p->round, p->size);
	return true;
}

// Radius of the smallest ball about the origin around a round part.
static double radius_of_round(const ob_hull *part)
{
	const ob_mat3 r = ob_quat_matrix(part->frame);
	const ob_vec3 z = ob_column(&r, 2);
	const double half = ob_shape_is(part->round, OB_AXIAL) ? part->size.y : 0;
	double most = 0;
	for (int side = -1; side <= 1; side += 2) {
		const ob_vec3 end = ob_madd(part->centre, side * half, z);
		const double along = ob_dot(end, z), across = ob_norm(ob_madd(end, -along, z));
		const double rim = across + part->size.x;
		most = fmax(most, ob_shape_is(part->round, OB_RIMMED) ? sqrt(along * along + rim * rim)
								      : ob_norm(end) + part->size.x);
	}
	return most;
}

// ---- compounds

// Adds m (kg) times the tensor of a part about the point "centre" (m): its own moments, and those of its distance.
static void add_tensor(const ob_hull *part, double m, ob_vec3 centre, double tensor[3][3])
{
	const ob_mat3 r = ob_quat_matrix(part->frame);
	const ob_vec3 off = ob_sub(part->centre, centre);
	const double moment[3] = { part->inertia.x, part->inertia.y, part->inertia.z }, d[3] = { off.x, off.y, off.z };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			double own = (i == j ? ob_norm2(off) : 0) - d[i] * d[j];
			for (int k = 0; k < 3; k++)
				own += r.m[i][k] * moment[k] * r.m[j][k];
			tensor[i][j] += m * own;
		}
}

// Mass of a compound: kg, in the unit of the parts' densities; m^3; centre and axes in the frame of their points; m^2.
typedef struct parts_mass {
	double mass, volume;
	ob_vec3 centre, inertia;
	ob_quat frame;
} parts_mass;

// Finds the parts' common centre, principal axes and moments per kilogram. hull: of the parts.
static parts_mass weigh(const ob_hull_part *part, uint32_t parts, const ob_hull *hull)
{
	double tensor[3][3] = { { 0 } }, axes[3][3];
	parts_mass out = { 0 };
	for (uint32_t i = 0; i < parts; i++) {
		const double m = part[i].density * hull[i].volume;
		out.mass += m, out.volume += hull[i].volume;
		out.centre = ob_madd(out.centre, m, hull[i].centre);
	}
	out.centre = ob_scale(out.centre, 1 / out.mass);
	for (uint32_t i = 0; i < parts; i++)
		add_tensor(&hull[i], part[i].density * hull[i].volume / out.mass, out.centre, tensor);
	diagonalise(tensor, axes);
	make_equal(tensor, 10 * noise * (tensor[0][0] + tensor[1][1] + tensor[2][2]));
	out.frame = quaternion_of(axes);
	out.inertia = ob_v3(tensor[0][0], tensor[1][1], tensor[2][2]);
	return out;
}

// Moves the hulls of parts into the frame of the compound's mass.
static void move_parts(ob_hull *hull, uint32_t parts, const parts_mass *m)
{
	const ob_mat3 turn = ob_quat_matrix(m->frame);
	for (uint32_t i = 0; i < parts; i++) {
		ob_hull *h = &hull[i];
		move_frame(h, m->centre, &turn);
		h->centre = ob_rotate_back(&turn, ob_sub(h->centre, m->centre));
		h->frame = ob_quat_mul(ob_quat_conjugate(m->frame), h->frame);
		h->is_part = 1;
		if (h->round)
			h->radius = radius_of_round(h);
	}
}

// Hull of the points of all parts, in their frame.
static bool hull_of_all(const ob_hull_part *part, uint32_t parts, ob_hull *out, ob_error *e)
{
	size_t all = 0;
	for (uint32_t i = 0; i < parts; i++)
		all += part[i].points;
	ob_vec3 *point = calloc(all, sizeof *point), *at = point;
	if (!point)
		return ob_fail(e, "no memory");
	for (uint32_t i = 0; i < parts; at += part[i++].points)
		memcpy(at, part[i].point, part[i].points * sizeof *at);
	const bool built = ob_hull_build(point, all, out, e);
	free(point);
	return built;
}

// Box about moved parts, along the axes of the compound. Its ball is that about the parts.
static bool box_of_all(const ob_hull *part, uint32_t parts, ob_hull *out, ob_error *e)
{
	static const ob_vec3 axis[] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	const ob_mat3 same = ob_quat_matrix(ob_quat_identity());
	double high[6], radius = 0;
	ob_vec3 corner[8];
	for (int k = 0; k < 6; k++) {
		high[k] = -INFINITY;
		for (uint32_t i = 0; i < parts; i++) {
			const ob_vec3 n = ob_scale(axis[k % 3], k < 3 ? 1 : -1);
			high[k] = fmax(high[k], ob_dot(n, ob_shape_hull.farthest(NULL, &part[i], &n)));
		}
	}
	for (uint32_t i = 0; i < parts; i++)
		radius = fmax(radius, part[i].radius);
	for (int k = 0; k < 8; k++)
		corner[k] = ob_v3(k & 1 ? high[0] : -high[3], k & 2 ? high[1] : -high[4], k & 4 ? high[2] : -high[5]);
	if (!ob_hull_build(corner, 8, out, e))
		return false;
	move_frame(out, ob_v3(0, 0, 0), &same);
	out->radius = radius;
	out->inner = fmin(out->inner, radius); // alike for a ball, but for rounding
	return true;
}

static bool build_part(const ob_hull_part *p, ob_hull *out, ob_error *e)
{
	return p->points ? ob_hull_build(p->point, p->points, out, e) : build_round(p, out, e);
}

bool ob_hull_build_compound(const ob_hull_part *part, uint32_t parts, ob_vec3 inertia, ob_hull *out, uint32_t *failed,
			    ob_error *e)
{
	uint32_t round = 0;
	for (*failed = 1; *failed <= parts; ++*failed) {
		if (!build_part(&part[*failed - 1], &out[*failed], e))
			return false;
		round += out[*failed].round != 0;
	}
	*failed = 0;
	if (!round && !hull_of_all(part, parts, out, e))
		return false;
	parts_mass m = weigh(part, parts, out + 1);
	if (!isnan(inertia.x)) {
		m.centre = ob_v3(0, 0, 0);
		m.frame = ob_quat_identity();
		m.inertia = inertia;
	}
	move_parts(out + 1, parts, &m);
	if (round) {
		if (!box_of_all(out + 1, parts, out, e))
			return false;
	} else {
		const ob_mat3 turn = ob_quat_matrix(m.frame);
		move_frame(out, m.centre, &turn);
	}
	for (uint32_t i = 1; i <= parts; i++)
		out->thickness = fmin(out->thickness, out[i].thickness);
	out->centre = m.centre;
	out->frame = m.frame;
	out->parts = (uint16_t)parts;
	out->round = round;
	out->volume = m.volume;
	out->inertia = m.inertia;
	return ob_hull_makes_sense(out) || ob_fail(e, "expected the centre of mass inside of the hull of its parts");
}
