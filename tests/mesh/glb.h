// Binary glTF files made by hand, for tests: a JSON text and the bytes of its one buffer.
#ifndef OB_TESTS_MESH_GLB_H
#define OB_TESTS_MESH_GLB_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct glb {
	unsigned char *bytes;
	size_t size;
} glb;

static inline void glb_put(glb *g, const void *bytes, size_t size)
{
	g->bytes = realloc(g->bytes, g->size + size);
	if (!g->bytes)
		abort();
	memcpy(g->bytes + g->size, bytes, size);
	g->size += size;
}

static inline void glb_put_chunk(glb *g, uint32_t kind, const void *bytes, size_t size, char fill)
{
	const uint32_t padded = (uint32_t)(size + 3) / 4 * 4;
	const char pad[3] = { fill, fill, fill };
	glb_put(g, &padded, 4);
	glb_put(g, &kind, 4);
	glb_put(g, bytes, size);
	glb_put(g, pad, padded - size);
}

static inline glb glb_make(const char *json, const void *buffer, size_t size)
{
	glb g = { 0 };
	const uint32_t head[3] = { 0x46546c67, 2, 0 };
	glb_put(&g, head, sizeof head);
	glb_put_chunk(&g, 0x4e4f534a, json, strlen(json), ' ');
	if (size)
		glb_put_chunk(&g, 0x004e4942, buffer, size, 0);
	memcpy(g.bytes + 8, &(uint32_t){ (uint32_t)g.size }, 4);
	return g;
}

// The corners of a cube from -half to half, m, and the corners of its triangles, counterclockwise from outside.
#define GLB_CUBE_CORNERS 8
static const uint16_t glb_cube[36] = {
	1, 3, 7, 1, 7, 5, 0, 4, 6, 0, 6, 2, 2, 6, 7, 2, 7, 3, 0, 1, 5, 0, 5, 4, 4, 5, 7, 4, 7, 6, 0, 2, 3, 0, 3, 1,
};

typedef struct glb_cube_buffer {
	float corner[GLB_CUBE_CORNERS][3];
	uint16_t index[36];
} glb_cube_buffer;

static inline glb_cube_buffer glb_cube_of(float half)
{
	glb_cube_buffer b;
	for (int i = 0; i < GLB_CUBE_CORNERS; i++)
		for (int k = 0; k < 3; k++)
			b.corner[i][k] = i >> k & 1 ? half : -half;
	memcpy(b.index, glb_cube, sizeof b.index);
	return b;
}

// Common part of all files of a cube, behind their nodes, primitives and materials.
#define GLB_CUBE_REST \
	"\"asset\":{\"version\":\"2.0\"},\"accessors\":[" \
	"{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\",\"min\":[-1,-1,-1],\"max\":[1,1,1]}," \
	"{\"bufferView\":1,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"}]," \
	"\"bufferViews\":[{\"buffer\":0,\"byteLength\":96},{\"buffer\":0,\"byteOffset\":96,\"byteLength\":72}]," \
	"\"buffers\":[{\"byteLength\":168}]"

#define GLB_CUBE \
	"{\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]" \
	"," GLB_CUBE_REST "}"

#endif
