// Pictures, and binary glTF files of a cube with one on it, for tests.
#ifndef OB_TESTS_MESH_PICTURES_H
#define OB_TESTS_MESH_PICTURES_H

#include <stdbool.h>
#include <stdio.h>

#include <jpeglib.h>
#include <png.h>
#include <zlib.h>

#include "check.h"
#include "glb.h"

enum { PICTURE_MAX = 1 << 16, WIDTH = 5, HEIGHT = 3 };

typedef struct picture {
	unsigned char bytes[PICTURE_MAX];
	size_t size;
} picture;

static inline uint8_t shade(int x, int y)
{
	return (uint8_t)(40 * x + 9 * y);
}

// As PNG has its numbers.
static inline void put_big_endian(unsigned char *at, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		at[i] = (unsigned char)(value >> (24 - 8 * i));
}

// Picture with one channel, grey.
static inline picture grey_png(void)
{
	uint8_t pixel[HEIGHT][WIDTH];
	picture p = { .size = sizeof p.bytes };
	png_image image = { .version = PNG_IMAGE_VERSION, .width = WIDTH, .height = HEIGHT, .format = PNG_FORMAT_GRAY };
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		pixel[i / WIDTH][i % WIDTH] = shade(i % WIDTH, i / WIDTH);
	CHECK(png_image_write_to_memory(&image, p.bytes, &p.size, 0, pixel, 0, NULL));
	return p;
}

static inline void put_png_chunk(picture *p, size_t at, const char *kind, const void *bytes, size_t size)
{
	if (p->size + size + 12 > sizeof p->bytes)
		return;
	memmove(p->bytes + at + size + 12, p->bytes + at, p->size - at);
	put_big_endian(p->bytes + at, (uint32_t)size);
	memcpy(p->bytes + at + 4, kind, 4);
	memcpy(p->bytes + at + 8, bytes, size);
	put_big_endian(p->bytes + at + 8 + size, (uint32_t)crc32(0, p->bytes + at + 4, (uInt)size + 4));
	p->size += size + 12;
}

// The grey one with chunks that are no pixels, as many as there is room for: texts and profiles that would become 8 MB
// each, and chunks that nobody knows.
static inline picture wordy_png(void)
{
	enum { AFTER_HEAD = 33, UNPACKED = 7900000, CHUNKS = 7 };
	static const char *const kinds[] = { "zTXt", "zTXt", "zTXt", "iTXt", "iCCP", "zTXt", "teSt" };
	picture p = grey_png();
	unsigned char *zeros = calloc(UNPACKED, 1), packed[PICTURE_MAX / CHUNKS] = "k\0\0";
	for (int i = 0; zeros && i < CHUNKS; i++) {
		const bool international = strcmp(kinds[i], "iTXt") == 0;
		memcpy(packed, international ? "k\0\1\0\0\0" : "k\0\0", international ? 6 : 3);
		uLongf size = sizeof packed - 6;
		CHECK(compress2(packed + (international ? 6 : 3), &size, zeros, UNPACKED, 9) == Z_OK);
		put_png_chunk(&p, AFTER_HEAD, kinds[i], packed, size + (international ? 6 : 3));
	}
	free(zeros);
	return p;
}

// All of one colour, so that little is lost.
static inline picture orange_jpeg(void)
{
	struct jpeg_compress_struct jpeg;
	struct jpeg_error_mgr errors;
	uint8_t pixel[3 * WIDTH];
	JSAMPROW row = pixel;
	unsigned char *bytes = NULL;
	unsigned long size = 0;
	picture p = { .size = 0 };
	for (int i = 0; i < WIDTH; i++)
		memcpy(pixel + 3 * i, (uint8_t[]){ 230, 120, 30 }, 3);
	jpeg.err = jpeg_std_error(&errors);
	jpeg_create_compress(&jpeg);
	jpeg_mem_dest(&jpeg, &bytes, &size);
	jpeg.image_width = WIDTH;
	jpeg.image_height = HEIGHT;
	jpeg.input_components = 3;
	jpeg.in_color_space = JCS_RGB;
	jpeg_set_defaults(&jpeg);
	jpeg_set_quality(&jpeg, 95, TRUE);
	jpeg_start_compress(&jpeg, TRUE);
	for (int i = 0; i < HEIGHT; i++)
		jpeg_write_scanlines(&jpeg, &row, 1);
	jpeg_finish_compress(&jpeg);
	jpeg_destroy_compress(&jpeg);
	p.size = size;
	memcpy(p.bytes, bytes, size);
	free(bytes);
	return p;
}

#define TEXTURES "\"textures\":[{\"source\":0,\"sampler\":0}],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648}],"

// A file of a cube with so many images, a material and a primitive each, that begin at the same byte of the file; each is
// so many bytes longer than the one before.
static inline glb sharing_cube(const picture *p, int images, size_t longer)
{
	struct {
		glb_cube_buffer cube;
		unsigned char picture[2 * PICTURE_MAX];
	} b = { .cube = glb_cube_of(1) };
	enum { ROOM = 1 << 16 };
	char *text = malloc(ROOM);
	int n = 0;
	const size_t size = sizeof b.cube + p->size + (size_t)images * longer;
	memcpy(b.picture, p->bytes, p->size);
#define EACH(...) \
	for (int i = 0; i < images; i++) \
	n += snprintf(text + n, (size_t)(ROOM - n), __VA_ARGS__)
	n += snprintf(text, ROOM,
		      "{\"nodes\":[{\"mesh\":0}],\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[");
	EACH("%s{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":%d}", i ? "," : "", i);
	n += snprintf(text + n, (size_t)(ROOM - n), "]}],\"materials\":[");
	EACH("%s{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":%d}}}", i ? "," : "", i);
	n += snprintf(text + n, (size_t)(ROOM - n), "],\"textures\":[");
	EACH("%s{\"source\":%d}", i ? "," : "", i);
	n += snprintf(text + n, (size_t)(ROOM - n), "],\"images\":[");
	EACH("%s{\"bufferView\":%d,\"mimeType\":\"image/png\"}", i ? "," : "", 2 + i);
	n += snprintf(text + n, (size_t)(ROOM - n),
		      "],\"bufferViews\":[{\"buffer\":0,\"byteLength\":96},{\"buffer\":0,\"byteOffset\":96,"
		      "\"byteLength\":72}");
	EACH(",{\"buffer\":0,\"byteOffset\":168,\"byteLength\":%zu}", p->size + (size_t)i * longer);
#undef EACH
	snprintf(text + n, (size_t)(ROOM - n),
		 "],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"},{"
		 "\"bufferView\":1,"
		 "\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"}],\"buffers\":[{\"byteLength\":%zu}]}",
		 size);
	glb g = glb_make(text, &b, size);
	free(text);
	return g;
}

// File of a cube with texture coordinates (here 0, 1, 2 .. and .25) and one picture. more: further JSON, before the
// common part. values: those of the material.
static inline glb textured_cube(const picture *p, const char *values, const char *more)
{
	struct {
		glb_cube_buffer cube;
		float place[8][2];
		unsigned char picture[PICTURE_MAX];
	} b = { .cube = glb_cube_of(1) };
	char text[4000];
	for (int i = 0; i < 8; i++)
		memcpy(b.place[i], (float[]){ (float)i, .25f }, sizeof b.place[i]);
	memcpy(b.picture, p->bytes, p->size);
	snprintf(text, sizeof text,
		 "{\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
		 "\"TEXCOORD_0\":2},\"indices\":1,\"material\":0},{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
		 "\"materials\":[{\"pbrMetallicRoughness\":{%s}}],%s\"images\":[{\"bufferView\":3,\"mimeType\":"
		 "\"image/png\"}],\"asset\":{\"version\":\"2.0\"},\"accessors\":["
		 "{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"},"
		 "{\"bufferView\":1,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"},"
		 "{\"bufferView\":2,\"componentType\":5126,\"count\":8,\"type\":\"VEC2\"}],"
		 "\"bufferViews\":[{\"buffer\":0,\"byteLength\":96},{\"buffer\":0,\"byteOffset\":96,\"byteLength\":72},"
		 "{\"buffer\":0,\"byteOffset\":168,\"byteLength\":64},{\"buffer\":0,\"byteOffset\":232,\"byteLength\":"
		 "%zu}],\"buffers\":[{\"byteLength\":%zu}]}",
		 values, more, p->size, 232 + p->size);
	return glb_make(text, &b, 232 + p->size);
}

#endif
