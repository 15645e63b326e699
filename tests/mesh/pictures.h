// Pictures, and binary glTF files of a cube with one on it, for tests.
#ifndef OB_TESTS_MESH_PICTURES_H
#define OB_TESTS_MESH_PICTURES_H

#include <stdio.h>

#include <jpeglib.h>
#include <png.h>

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

// Of one channel, grey.
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

// A file of a cube with coordinates of a texture (here 0, 1, 2 .. and .25) and one picture; more: of the JSON, before
// what all have in common. values: of the material's.
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
