#include "mesh/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "mesh/gltf.h"

static const float farthest = 1e6f; // m, largest coordinate of a vertex

float ob_surface_pack(float roughness, float metal)
{
	return roundf(15 * fminf(fmaxf(metal, 0), 1)) + fminf(fmaxf(roughness, 0), .99f);
}

size_t ob_mesh_bytes(const ob_mesh *m)
{
	size_t bytes = m->vertices * sizeof *m->vertex + m->indices * sizeof *m->index + m->parts * sizeof *m->part;
	for (uint32_t i = 0; i < m->images; i++)
		bytes += 4 * (size_t)m->image[i].width * m->image[i].height;
	return bytes;
}

uint64_t ob_mesh_key(const char *file, double scale, ob_pose pose)
{
	double number[] = { scale, pose.p.x, pose.p.y, pose.p.z, pose.q.w, pose.q.x, pose.q.y, pose.q.z };
	for (size_t i = 0; i < sizeof number / sizeof *number; i++)
		number[i] += 0.; // -0 is 0
	const uint64_t hash = ob_hash_on(OB_HASH_BEGIN, file, strlen(file) + 1);
	const uint64_t key = ob_hash_on(hash, number, sizeof number);
	return key ? key : 1;
}

void ob_mesh_finish(ob_mesh *m)
{
	for (uint32_t i = 0; i < m->images; i++)
		free(m->image[i].rgba);
	free(m->image);
	free(m->part);
	free(m->vertex);
	free(m->index);
	*m = (ob_mesh){ 0 };
}

// ---- numbers

static bool lies_within(const float *v, int n, float low, float high)
{
	for (int i = 0; i < n; i++)
		if (!(v[i] >= low && v[i] <= high))
			return false;
	return true;
}

static bool vertex_makes_sense(const ob_mesh_vertex *v)
{
	return lies_within(v->position, 3, -farthest, farthest) && lies_within(v->normal, 3, -1.01f, 1.01f) &&
	       lies_within(v->colour, 3, -1, 1) && lies_within(&v->surface, 1, -1, 16) &&
	       lies_within(v->texture, 2, -farthest, farthest);
}

static bool images_make_sense(const ob_mesh *m)
{
	uint64_t pixels = 0;
	for (uint32_t i = 0; i < m->images; i++) {
		const ob_mesh_image *image = &m->image[i];
		if (image->width < 1 || image->width > OB_MESH_IMAGE_SIDE_MAX || image->height < 1 ||
		    image->height > OB_MESH_IMAGE_SIDE_MAX)
			return false;
		pixels += (uint64_t)image->width * image->height;
	}
	return pixels <= OB_MESH_PIXELS_MAX;
}

static bool parts_make_sense(const ob_mesh *m)
{
	uint64_t indices = m->parts ? 0 : m->indices;
	for (uint32_t i = 0; i < m->parts; i++) {
		const ob_mesh_part *p = &m->part[i];
		if (p->indices % 3 != 0 || p->colour > m->images || p->surface > m->images ||
		    p->wrap[0] >= OB_MESH_WRAPS || p->wrap[1] >= OB_MESH_WRAPS)
			return false;
		indices += p->indices;
	}
	return indices == m->indices;
}

bool ob_mesh_makes_sense(ob_mesh *m)
{
	double most = 0;
	if (m->vertices < 3 || m->vertices > OB_MESH_VERTICES_MAX || m->indices < 3 || m->indices % 3 != 0 ||
	    m->indices > 3 * OB_MESH_TRIANGLES_MAX || m->parts > OB_MESH_PARTS_MAX || m->images > OB_MESH_IMAGES_MAX)
		return false;
	if (!images_make_sense(m) || !parts_make_sense(m))
		return false;
	for (uint32_t i = 0; i < m->indices; i++)
		if (m->index[i] >= m->vertices)
			return false;
	for (uint32_t i = 0; i < m->vertices; i++) {
		const float *p = m->vertex[i].position;
		if (!vertex_makes_sense(&m->vertex[i]))
			return false;
		most = fmax(most, ob_norm2(ob_v3(p[0], p[1], p[2])));
	}
	m->radius = sqrt(most);
	return true;
}

static void set3(float to[3], ob_vec3 v)
{
	to[0] = (float)v.x;
	to[1] = (float)v.y;
	to[2] = (float)v.z;
}

bool ob_mesh_place(ob_mesh *m, double scale, ob_pose pose, ob_error *e)
{
	const ob_mat3 r = ob_quat_matrix(pose.q);
	for (uint32_t i = 0; i < m->vertices; i++) {
		ob_mesh_vertex *v = &m->vertex[i];
		const ob_vec3 p = ob_v3(v->position[0], v->position[1], v->position[2]);
		const ob_vec3 n = ob_v3(v->normal[0], v->normal[1], v->normal[2]);
		set3(v->position, ob_madd(pose.p, scale, ob_rotate(&r, p)));
		set3(v->normal, ob_rotate(&r, n));
	}
	return ob_mesh_makes_sense(m) || ob_fail(e, "a vertex of it lies more than 1000 km away");
}

// ---- files

static uint32_t word_at(const unsigned char *bytes, size_t at)
{
	return bytes[at] | (uint32_t)bytes[at + 1] << 8 | (uint32_t)bytes[at + 2] << 16 | (uint32_t)bytes[at + 3] << 24;
}

// Checks the header of 12 bytes, and the first chunk's, which is JSON (glTF 2.0, 4.4).
static bool check_header(const unsigned char *bytes, size_t size, ob_error *e)
{
	enum { HEADERS = 20, JSON = 0x4e4f534a };
	size_t text = 0;
	while (text < size && strchr(" \t\r\n\xef\xbb\xbf", bytes[text]) && bytes[text])
		text++;
	if (text < size && bytes[text] == '{')
		return ob_fail(e, "it is glTF as text (.gltf): expected binary glTF (.glb), one file that holds all");
	if (size < 4 || memcmp(bytes, "glTF", 4) != 0)
		return ob_fail(e, "it is no binary glTF file (.glb)");
	if (size < HEADERS)
		return ob_fail(e, "it is cut short");
	if (word_at(bytes, 4) != 2)
		return ob_fail(e, "it is glTF of version %u: expected 2", word_at(bytes, 4));
	if (word_at(bytes, 8) > size)
		return ob_fail(e, "it is cut short: %zu of %u bytes are there", size, word_at(bytes, 8));
	if (word_at(bytes, 8) < HEADERS || word_at(bytes, 12) > word_at(bytes, 8) - HEADERS ||
	    word_at(bytes, 16) != JSON)
		return ob_fail(e, "it is damaged: it does not begin with its JSON part");
	if (word_at(bytes, 12) > OB_MESH_JSON_MAX)
		return ob_fail(e, "its JSON part is larger than %d KiB", OB_MESH_JSON_MAX >> 10);
	return true;
}

bool ob_mesh_read(ob_mesh *m, const void *bytes, size_t size, ob_error *e)
{
	*m = (ob_mesh){ 0 };
	if (size > OB_MESH_FILE_MAX)
		return ob_fail(e, "it is larger than %d MiB", OB_MESH_FILE_MAX >> 20);
	const ob_gltf_part *part = NULL;
	if (check_header(bytes, size, e))
		part = ob_part_load("gltf", sizeof *part, OB_PART_PROGRAM, "libtinygltf2d and libjpeg62-turbo", e);
	if (!part || !part->read(m, bytes, size, e))
		return false;
	if (ob_mesh_makes_sense(m))
		return true;
	ob_mesh_finish(m);
	return ob_fail(e, "a vertex of it lies more than 1000 km away, or is no number");
}

bool ob_mesh_load(ob_mesh *m, const char *path, ob_error *e)
{
	size_t size = 0;
	char *bytes = ob_file_load(path, OB_MESH_FILE_MAX, &size, e);
	*m = (ob_mesh){ 0 };
	const bool good = bytes && ob_mesh_read(m, bytes, size, e);
	free(bytes);
	return good;
}
