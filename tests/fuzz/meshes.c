// Hostile glTF files: mutants of good ones, read in this process. Each is rejected with a message, or becomes a
// consistent mesh, and a terrain of it; none may crash, hang, or allocate more memory than is reasonable for its size. 20000 in a minute or
// so:
//
//   meshes FOLDER [COUNT [SEED]]    mutants of FOLDER/*.glb, and of cubes with and without pictures
//
// tinygltf, libpng and libjpeg are built without sanitizers; those of this program (build-asan) check their output.
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "../mesh/pictures.h"
#include "base/random.h"
#include "mesh/mesh.h"
#include "terrain/terrain.h"

enum { SEEDS_MAX = 12, BYTES_MAX = 1 << 20, CHANGES = 5 };

// Replacements of numbers, and of other parts.
static const char *const words[] = {
	"-1",
	"0",
	"1",
	"2",
	"3",
	"7",
	"255",
	"65535",
	"2147483647",
	"2147483648",
	"4294967295",
	"18446744073709551615",
	"1e308",
	"-0.0",
	"1.5",
	"null",
	"true",
	"{}",
	"[]",
	"[[",
	"]]",
	"{\"a\":",
	"\"",
	"\\",
	",",
	":",
	"\"VEC2\"",
	"\"SCALAR\"",
	"\"MAT4\"",
	"5120",
	"5121",
	"5123",
	"5125",
	"5130",
	"\"uri\":\"x.bin\"",
	"\"uri\":\"data:application/octet-stream;base64,AAAA\"",
	"\"sparse\":{}",
	"\"byteStride\":1",
	"\"children\":[0]",
	"\"extensionsRequired\":[\"x\"]",
	"\"skin\":0",
	"\"normalized\":true",
	"\"mode\":5",
	"\"indices\":0",
	"\"images\":[{\"bufferView\":0,\"mimeType\":\"image/png\"}]",
	"\"doubleSided\":true",
};

static glb seed[SEEDS_MAX];
static uint32_t seeds;
static uint64_t state = 1;

static uint32_t below(uint32_t n)
{
	return (uint32_t)(ob_splitmix(&state) % n);
}

static void read_seeds(const char *folder)
{
	const glb_cube_buffer cube = glb_cube_of(1);
	const picture png = grey_png(), jpeg = orange_jpeg(), wordy = wordy_png();
	static const char both[] = "\"baseColorTexture\":{\"index\":0},\"metallicRoughnessTexture\":{\"index\":0}";
	seed[seeds++] = glb_make(GLB_CUBE, &cube, sizeof cube);
	seed[seeds++] = textured_cube(&png, both, TEXTURES);
	seed[seeds++] = textured_cube(&jpeg, both, TEXTURES);
	seed[seeds++] = textured_cube(&wordy, both, TEXTURES);
	seed[seeds++] = sharing_cube(&png, 3, 0);
	seed[seeds++] = sharing_cube(&jpeg, 3, 1);
	DIR *d = opendir(folder);
	for (struct dirent *entry; d && (entry = readdir(d)) && seeds < SEEDS_MAX;) {
		char path[1024];
		unsigned char *bytes = malloc(BYTES_MAX);
		if (!strstr(entry->d_name, ".glb") || !bytes) {
			free(bytes);
			continue;
		}
		snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
		FILE *f = fopen(path, "rb");
		seed[seeds++] = (glb){ bytes, f ? fread(bytes, 1, BYTES_MAX, f) : 0 };
		if (f)
			fclose(f);
	}
	if (d)
		closedir(d);
}

static uint32_t big_endian(const unsigned char *at)
{
	return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

// Changes one part of a PNG of so many bytes, a number or some bytes, and corrects its checksum.
static void change_png(unsigned char *png, size_t size)
{
	static const uint32_t numbers[] = { 0, 1, 2, 255, 4096, 4097, 65535, 0x7fffffff, 0x80000000, 0xffffffff };
	size_t at = 8;
	for (uint32_t skip = below(4); skip > 0 && at + 12 < size; skip--)
		at += 12 + (size_t)big_endian(png + at);
	if (at + 12 > size)
		return;
	const size_t length = big_endian(png + at);
	if (length < 8 || length > size - at - 12)
		return;
	if (below(2))
		put_big_endian(png + at + 8 + 4 * below(2), numbers[below(sizeof numbers / sizeof *numbers)]);
	else
		png[at + 8 + below((uint32_t)length)] = (unsigned char)below(256);
	if (below(8))
		put_big_endian(png + at + 8 + length, (uint32_t)crc32(0, png + at + 4, (uInt)(length + 4)));
}

// Changes the picture in a file's buffer, if it has one: a number, a byte, or a cut.
static void change_picture(unsigned char *buffer, size_t size)
{
	unsigned char *png = memmem(buffer, size, "\x89PNG\r\n\x1a\n", 8);
	unsigned char *at = png ? png : memmem(buffer, size, "\xff\xd8\xff", 3);
	if (!at)
		return;
	const size_t left = size - (size_t)(at - buffer);
	const uint32_t place = below((uint32_t)left);
	if (png && below(4))
		change_png(png, left);
	else if (below(2))
		at[place] = (unsigned char)below(256);
	else
		memset(at + place, 0, left - place);
}

// Finds the next number of the text from "at" on: its length, and its place in *at; 0: none.
static size_t find_number(const char *text, size_t size, size_t *at)
{
	static const char digits[] = "0123456789.-";
	while (*at < size && !memchr(digits, text[*at], sizeof digits - 1))
		++*at;
	size_t n = 0;
	while (*at + n < size && memchr(digits, text[*at + n], sizeof digits - 1))
		n++;
	return n;
}

// Replaces a number or a few bytes of the JSON by a word. *size: its bytes; the buffer is large enough.
static void change_text(char *text, size_t *size)
{
	const char *word = words[below(sizeof words / sizeof *words)];
	size_t at = below((uint32_t)*size + 1), n = below(3) ? find_number(text, *size, &at) : below(4),
	       put = strlen(word);
	if (at + n > *size)
		n = *size - at;
	memmove(text + at + put, text + at + n, *size - at - n);
	memcpy(text + at, word, put);
	*size += put - n;
}

static glb mutant(const glb *of)
{
	uint32_t json;
	memcpy(&json, of->bytes + 12, 4);
	const size_t rest = 20 + (size_t)json, data = of->size > rest + 8 ? of->size - rest - 8 : 0;
	char *text = malloc(json + 64 * CHANGES);
	unsigned char *buffer = malloc(data + 1);
	size_t size = json;
	memcpy(text, of->bytes + 20, json);
	memcpy(buffer, of->bytes + of->size - data, data);
	for (uint32_t i = below(CHANGES); i > 0; i--)
		change_text(text, &size);
	for (uint32_t i = data ? below(CHANGES) : 0; i > 0; i--)
		buffer[below((uint32_t)data)] = (unsigned char)below(256);
	for (uint32_t i = below(CHANGES); i > 1; i--)
		change_picture(buffer, data);
	text[size] = 0;
	glb out = glb_make(text, buffer, below(20) ? data : below((uint32_t)data + 1));
	for (uint32_t i = below(8) ? 0 : below(4); i > 0; i--)
		out.bytes[below(below(2) ? 24 : (uint32_t)out.size)] ^= (unsigned char)(1 << below(8));
	if (below(30) == 0)
		out.size = below((uint32_t)out.size + 1);
	free(text);
	free(buffer);
	return out;
}

// Makes a terrain of the triangles: one that makes sense, or a message.
static bool stands(const ob_mesh *m)
{
	const uint32_t triangles = m->indices / 3, side = 1 + below(300), cells[2] = { side, 1 + below(300) };
	ob_vec3 *vertex = malloc(m->vertices * sizeof *vertex);
	uint32_t(*corner)[3] = malloc(triangles * sizeof *corner);
	ob_terrain_set *set = NULL;
	ob_error e = { "" };
	for (uint32_t i = 0; i < m->vertices; i++)
		vertex[i] = ob_v3(m->vertex[i].position[0], m->vertex[i].position[1], m->vertex[i].position[2]);
	memcpy(corner, m->index, triangles * sizeof *corner);
	ob_terrain *t =
		ob_terrain_build(vertex, m->vertices, (const uint32_t(*)[3])corner, triangles, cells, false, &e);
	if (t) {
		CHECK(t->entries <= OB_TERRAIN_ENTRIES_PER_TRIANGLE * (uint64_t)triangles);
		CHECK(ob_terrain_set_add(&set, t, &e) && ob_terrain_set_makes_sense(set, set->bytes));
	}
	CHECK(t || e.text[0]);
	const bool built = t;
	free(set);
	free(t);
	free(vertex);
	free(corner);
	return built;
}

int main(int argc, char **argv)
{
	const long count = argc > 2 ? strtol(argv[2], NULL, 10) : 2000;
	long good = 0, standing = 0;
	state = argc > 3 ? strtoul(argv[3], NULL, 10) : 1;
	read_seeds(argc > 1 ? argv[1] : ".");
	CHECK(seeds > 1);
	for (long i = 0; i < count; i++) {
		glb g = mutant(&seed[below(seeds)]);
		ob_mesh m;
		ob_error e = { "" };
		if (ob_mesh_read(&m, g.bytes, g.size, &e)) {
			good++;
			CHECK(ob_mesh_makes_sense(&m) && isfinite(m.radius));
			standing += stands(&m);
			ob_mesh_finish(&m);
		} else {
			CHECK(e.text[0] && !m.vertex && !m.index);
		}
		free(g.bytes);
	}
	for (uint32_t i = 0; i < seeds; i++)
		free(seed[i].bytes);
	printf("%ld of %ld were good, and %ld of these stand\n", good, count, standing);
	CHECK(good > 0 && good < count);
	return check_end();
}
