#include "import/look.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "import/solid.h"

enum { AROUND = 32, RINGS = 17 }; // vertices of a surface without triangles of its own

// A file as it grows: the text of its accessors, meshes, materials, and its numbers.
typedef struct file {
	FILE *views, *accessors, *primitives, *materials, *numbers;
	uint32_t count; // of geometries
	uint32_t bytes; // of numbers
} file;

typedef struct bounds {
	float low[3], high[3];
} bounds;

static void put_vertex(file *f, const ob_pose *object, ob_vec3 world, bounds *b)
{
	const ob_mat3 r = ob_quat_matrix(object->q);
	const ob_vec3 l = ob_rotate_back(&r, ob_sub(world, object->p));
	const float v[3] = { (float)l.x, (float)l.z, (float)-l.y }; // y is up, z towards the viewer
	for (int c = 0; c < 3; c++) {
		b->low[c] = fminf(b->low[c], v[c]);
		b->high[c] = fmaxf(b->high[c], v[c]);
	}
	fwrite(v, sizeof v, 1, f->numbers);
}

// Writes the vertices of a mesh, then its triangles. Returns the number of vertices; corners: of the triangles.
static uint32_t put_mesh(file *f, const ob_drawn *d, int geom, const ob_pose *object, bounds *b, uint32_t *corners)
{
	const mjModel *m = d->model;
	const int mesh = m->geom_dataid[geom];
	const float *v = m->mesh_vert + 3 * m->mesh_vertadr[mesh];
	const double *at = d->data->geom_xpos + 3 * geom, *r = d->data->geom_xmat + 9 * geom;
	for (int i = 0; i < m->mesh_vertnum[mesh]; i++) {
		double x[3] = { v[3 * i], v[3 * i + 1], v[3 * i + 2] }, turned[3];
		mju_rotVecMat(turned, x, r);
		put_vertex(f, object, ob_v3(at[0] + turned[0], at[1] + turned[1], at[2] + turned[2]), b);
	}
	*corners = 3 * (uint32_t)m->mesh_facenum[mesh];
	for (uint32_t i = 0; i < *corners; i++)
		fwrite(&(uint32_t){ (uint32_t)m->mesh_face[3 * m->mesh_faceadr[mesh] + (int)i] }, 4, 1, f->numbers);
	return (uint32_t)m->mesh_vertnum[mesh];
}

// The same for a convex shape: its support points along rings of directions.
static uint32_t put_shape(file *f, const ob_drawn *d, int geom, const ob_pose *object, bounds *b, uint32_t *corners)
{
	for (int i = 0; i < RINGS; i++)
		for (int k = 0; k < AROUND; k++) {
			const double up = M_PI * (i / (RINGS - 1.) - .5), turn = 2 * M_PI * (k + .5) / AROUND;
			const ob_vec3 n = ob_v3(cos(up) * cos(turn), cos(up) * sin(turn), sin(up));
			put_vertex(f, object, ob_geom_farthest(d, geom, n), b);
		}
	*corners = 6 * (RINGS - 1) * AROUND;
	for (uint32_t i = 0; i + 1 < RINGS; i++)
		for (uint32_t k = 0; k < AROUND; k++) {
			const uint32_t next = (k + 1) % AROUND, below = i * AROUND, above = below + AROUND;
			const uint32_t quad[6] = { below + k, below + next, above + next,
						   below + k, above + next, above + k };
			fwrite(quad, sizeof quad, 1, f->numbers);
		}
	return RINGS * AROUND;
}

static void put_geom(file *f, const ob_drawn *d, int geom, const ob_pose *object)
{
	const mjModel *m = d->model;
	bounds b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
	const bool meshed = m->geom_type[geom] == mjGEOM_MESH;
	uint32_t corners;
	const uint32_t vertices = (meshed ? put_mesh : put_shape)(f, d, geom, object, &b, &corners), n = f->count++;
	const char *comma = n ? "," : "";
	const float *c = m->geom_matid[geom] >= 0 ? m->mat_rgba + 4 * m->geom_matid[geom] : m->geom_rgba + 4 * geom;
	fprintf(f->views,
		"%s{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":%u},{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":%"
		"u}",
		comma, f->bytes, 12 * vertices, f->bytes + 12 * vertices, 4 * corners);
	fprintf(f->accessors,
		"%s{\"bufferView\":%u,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\",\"min\":[%.9g,%.9g,%.9g],"
		"\"max\":[%.9g,%.9g,%.9g]},{\"bufferView\":%u,\"componentType\":5125,\"count\":%u,\"type\":\"SCALAR\"}",
		comma, 2 * n, vertices, b.low[0], b.low[1], b.low[2], b.high[0], b.high[1], b.high[2], 2 * n + 1,
		corners);
	fprintf(f->primitives, "%s{\"attributes\":{\"POSITION\":%u},\"indices\":%u,\"material\":%u}", comma, 2 * n,
		2 * n + 1, n);
	fprintf(f->materials,
		"%s{\"pbrMetallicRoughness\":{\"baseColorFactor\":[%.4g,%.4g,%.4g,1],\"metallicFactor\":0,"
		"\"roughnessFactor\":0.5}}",
		comma, c[0], c[1], c[2]);
	f->bytes += 12 * vertices + 4 * corners;
}

// Writes a chunk, filled up to a multiple of four bytes.
static void put_chunk(FILE *to, const char *type, const char *bytes, uint32_t size, char filler)
{
	const uint32_t whole = (size + 3) / 4 * 4;
	fwrite(&whole, 4, 1, to);
	fwrite(type, 4, 1, to);
	fwrite(bytes, 1, size, to);
	for (uint32_t i = size; i < whole; i++)
		fputc(filler, to);
}

static bool put_file(const char *path, const char *json, uint32_t length, const char *numbers, uint32_t bytes)
{
	FILE *to = fopen(path, "wb");
	if (!to)
		return false;
	const uint32_t head[3] = { 0x46546c67, 2, 12 + 8 + (length + 3) / 4 * 4 + 8 + (bytes + 3) / 4 * 4 };
	fwrite(head, sizeof head, 1, to);
	put_chunk(to, "JSON", json, length, ' ');
	put_chunk(to, "BIN\0", numbers, bytes, 0);
	const bool whole = !ferror(to);
	return fclose(to) == 0 && whole;
}

bool ob_look_write(const ob_drawn *d, int first, int end, const ob_pose *object, const char *path, ob_error *e)
{
	enum { TEXTS = 5 };
	char *text[TEXTS], *json = NULL;
	size_t size[TEXTS], length = 0;
	FILE *at[TEXTS];
	bool done = true, looks = false;
	for (int i = 0; i < TEXTS; i++)
		done &= (at[i] = open_memstream(&text[i], &size[i])) != NULL;
	FILE *to = open_memstream(&json, &length);
	if (!done || !to)
		return ob_fail(e, "%s: out of memory", path); // the process ends
	file f = { at[0], at[1], at[2], at[3], at[4], 0, 0 };
	for (int geom = first; geom < end; geom++)
		looks |= !ob_geom_collides(d->model, geom) && ob_geom_has_extent(d->model, geom);
	for (int geom = first; geom < end; geom++)
		if (ob_geom_has_extent(d->model, geom) && ob_geom_collides(d->model, geom) != looks)
			put_geom(&f, d, geom, object);
	for (int i = 0; i < TEXTS; i++)
		fclose(at[i]);
	fprintf(to,
		"{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
		"\"buffers\":[{\"byteLength\":%u}],\"bufferViews\":[%s],\"accessors\":[%s],"
		"\"meshes\":[{\"primitives\":[%s]}],\"materials\":[%s]}",
		f.bytes, text[0], text[1], text[2], text[3]);
	fclose(to);
	done = f.count > 0 && put_file(path, json, (uint32_t)length, text[4], f.bytes);
	for (int i = 0; i < TEXTS; i++)
		free(text[i]);
	free(json);
	return done || ob_fail(e, "%s: %s", path, f.count ? strerror(errno) : "no geometry with a look");
}
