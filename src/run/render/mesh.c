#include "render/mesh.h"

#include <math.h>
#include <stdlib.h>

#include "shape/part.h"
#include "shape/shape.h"

enum { VERTICES_MAX = 16384, INDICES_MAX = 65536 };

// Segments around the axis; multiples of 4, so that a ball has an equator.
static const int segments_of_level[OB_MESH_LEVELS] = { 12, 24, 48 };

static uint16_t vertex(ob_mesh_set *s, float cx, float cy, float cz, float nx, float ny, float nz)
{
	s->vertex[s->vertices] = (ob_vertex){ { cx, cy, cz }, { nx, ny, nz } };
	return (uint16_t)s->vertices++;
}

static void triangle(ob_mesh_set *s, uint16_t a, uint16_t b, uint16_t c)
{
	s->index[s->indices++] = a;
	s->index[s->indices++] = b;
	s->index[s->indices++] = c;
}

static void quad(ob_mesh_set *s, uint16_t a, uint16_t b, uint16_t c, uint16_t d)
{
	triangle(s, a, b, c);
	triangle(s, a, c, d);
}

// Index of the box vertex at corner (bits: x, y, z positive) on the face of axis.
static uint16_t box_at(uint16_t first, int corner, int axis)
{
	return (uint16_t)(first + 3 * corner + axis);
}

// Builds a box: each corner has three vertices, one per face.
static void build_box(ob_mesh_set *s)
{
	uint16_t first = (uint16_t)s->vertices;
	for (int corner = 0; corner < 8; corner++) {
		float c[3];
		for (int k = 0; k < 3; k++)
			c[k] = corner >> k & 1 ? 1 : -1;
		for (int axis = 0; axis < 3; axis++)
			vertex(s, c[0], c[1], c[2], axis == 0 ? c[0] : 0, axis == 1 ? c[1] : 0, axis == 2 ? c[2] : 0);
	}
	for (int axis = 0; axis < 3; axis++) {
		int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, up = 1 << axis;
		quad(s, box_at(first, up, axis), box_at(first, up | u, axis), box_at(first, up | u | v, axis),
		     box_at(first, up | v, axis));
		quad(s, box_at(first, 0, axis), box_at(first, v, axis), box_at(first, u | v, axis),
		     box_at(first, u, axis));
	}
}

// Joins two rings of n + 1 vertices each, the lower one first.
static void belt(ob_mesh_set *s, uint16_t low, uint16_t high, int n)
{
	for (int i = 0; i < n; i++)
		quad(s, (uint16_t)(low + i), (uint16_t)(low + i + 1), (uint16_t)(high + i + 1), (uint16_t)(high + i));
}

static uint16_t ring_of_ball(ob_mesh_set *s, int n, double latitude, float end)
{
	uint16_t first = (uint16_t)s->vertices;
	for (int i = 0; i <= n; i++) {
		double turn = 2 * M_PI * (i % n) / n;
		vertex(s, 0, 0, end, (float)(cos(latitude) * cos(turn)), (float)(cos(latitude) * sin(turn)),
		       (float)sin(latitude));
	}
	return first;
}

// Builds a ball, cut at its equator: the lower half belongs to the core's lower end, the upper half to its upper end.
static void build_round(ob_mesh_set *s, int n)
{
	int quarter = n / 4;
	uint16_t last = ring_of_ball(s, n, -.5 * M_PI, -1);
	for (int ring = 1; ring <= 2 * quarter + 1; ring++) {
		int step = ring <= quarter ? ring : ring - 1;
		uint16_t next = ring_of_ball(s, n, .5 * M_PI * (step - quarter) / quarter, ring <= quarter ? -1 : 1);
		belt(s, last, next, n);
		last = next;
	}
}

static uint16_t ring_of_cylinder(ob_mesh_set *s, int n, float z, float normal_z)
{
	uint16_t first = (uint16_t)s->vertices;
	for (int i = 0; i <= n; i++) {
		float c = (float)cos(2 * M_PI * (i % n) / n), d = (float)sin(2 * M_PI * (i % n) / n);
		float side = normal_z == 0;
		vertex(s, c, d, z, side * c, side * d, normal_z);
	}
	return first;
}

static void build_cylinder(ob_mesh_set *s, int n)
{
	uint16_t bottom = ring_of_cylinder(s, n, -1, -1), low = ring_of_cylinder(s, n, -1, 0);
	uint16_t high = ring_of_cylinder(s, n, 1, 0), top = ring_of_cylinder(s, n, 1, 1);
	belt(s, bottom, low, n);
	belt(s, low, high, n);
	belt(s, high, top, n);
	for (int i = 1; i + 1 < n; i++) {
		triangle(s, bottom, (uint16_t)(bottom + i + 1), (uint16_t)(bottom + i));
		triangle(s, top, (uint16_t)(top + i), (uint16_t)(top + i + 1));
	}
}

static void build_one(ob_mesh_set *s, int kind)
{
	ob_mesh_range *m = &s->mesh[kind];
	m->index_first = s->indices;
	if (kind == OB_MESH_BOX)
		build_box(s);
	else if (kind < OB_MESH_CYLINDER)
		build_round(s, segments_of_level[kind - OB_MESH_ROUND]);
	else
		build_cylinder(s, segments_of_level[kind - OB_MESH_CYLINDER]);
	m->index_count = s->indices - m->index_first;
}

bool ob_mesh_set_build(ob_mesh_set *s)
{
	*s = (ob_mesh_set){ .vertex = malloc(VERTICES_MAX * sizeof *s->vertex),
			    .index = malloc(INDICES_MAX * sizeof *s->index) };
	if (!s->vertex || !s->index)
		return false;
	for (int kind = 0; kind < OB_MESHES; kind++)
		if (kind != OB_MESH_PATTERNED_BOX)
			build_one(s, kind);
	s->mesh[OB_MESH_PATTERNED_BOX] = s->mesh[OB_MESH_BOX];
	return true;
}

void ob_mesh_set_finish(ob_mesh_set *s)
{
	free(s->vertex);
	free(s->index);
}

// Normal of a round part at a corner of face f: that of the face for the caps of a cylinder.
static ob_vec3 normal_of_round(const ob_hull *part, uint32_t f, ob_vec3 corner)
{
	const double flat = .99; // cosine
	const ob_mat3 r = ob_quat_matrix(part->frame);
	const ob_vec3 z = ob_column(&r, 2), from = ob_sub(corner, part->centre);
	const bool rimmed = ob_shape_is((ob_shape)part->round, OB_RIMMED);
	if (rimmed && fabs(ob_dot(z, part->normal[f])) > flat)
		return part->normal[f];
	const double half = ob_shape_is((ob_shape)part->round, OB_AXIAL) ? part->size.y : 0, along = ob_dot(from, z);
	const ob_vec3 out = ob_madd(from, -fmin(half, fmax(-half, along)), z);
	return ob_scale(out, 1 / ob_norm(out));
}

uint32_t ob_mesh_of_hull(const ob_hull *h, ob_vertex *vertex)
{
	uint32_t n = 0;
	const bool round = ob_part_is_round(h);
	for (uint32_t f = 0; f < h->faces; f++)
		for (uint32_t k = h->first[f] + 1u; k + 1 < h->first[f + 1]; k++) {
			const uint8_t corner[3] = { h->loop[h->first[f]], h->loop[k], h->loop[k + 1] };
			for (int i = 0; i < 3; i++, n++) {
				const ob_vec3 c = h->corner[corner[i]],
					      m = round ? normal_of_round(h, f, c) : h->normal[f];
				if (vertex)
					vertex[n] = (ob_vertex){ { (float)c.x, (float)c.y, (float)c.z },
								 { (float)m.x, (float)m.y, (float)m.z } };
			}
		}
	return n;
}
