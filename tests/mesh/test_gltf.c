// Binary glTF files: places, orientations, colours and pictures of their triangles; and invalid files.
#include <math.h>
#include <zlib.h>

#include "check.h"
#include "glb.h"
#include "mesh/mesh.h"
#include "pictures.h"

#define PRIMITIVE "{\"attributes\":{\"POSITION\":0},\"indices\":1}"
#define ONE_MESH "\"meshes\":[{\"primitives\":[" PRIMITIVE "]}],"

static ob_mesh read_cube(const char *json)
{
	const glb_cube_buffer cube = glb_cube_of(1);
	glb g = glb_make(json, &cube, sizeof cube);
	ob_mesh m = { 0 };
	ob_error e = { "" };
	CHECK(ob_mesh_read(&m, g.bytes, g.size, &e));
	if (e.text[0])
		fprintf(stderr, "  %s\n", e.text);
	free(g.bytes);
	return m;
}

static ob_vec3 place_of(const ob_mesh *m, uint32_t i)
{
	const float *p = m->vertex[m->index[i]].position;
	return ob_v3(p[0], p[1], p[2]);
}

// By the divergence theorem: right only if no triangle is missing, doubled or turned inside out.
static double volume(const ob_mesh *m)
{
	double six = 0;
	for (uint32_t i = 0; i + 2 < m->indices; i += 3)
		six += ob_dot(place_of(m, i), ob_cross(place_of(m, i + 1), place_of(m, i + 2)));
	return six / 6;
}

// Normals are unit, and look away from a point inside.
static void check_normals(const ob_mesh *m, ob_vec3 inside)
{
	double least = INFINITY;
	for (uint32_t i = 0; i < m->indices; i++) {
		const float *n = m->vertex[m->index[i]].normal;
		const ob_vec3 normal = ob_v3(n[0], n[1], n[2]);
		CHECK_NEAR(ob_norm(normal), 1, 1e-6);
		least = fmin(least, ob_dot(normal, ob_sub(place_of(m, i), inside)));
	}
	CHECK(least > 0);
}

static void check_bounds(const ob_mesh *m, ob_vec3 low, ob_vec3 high)
{
	ob_vec3 a = { INFINITY, INFINITY, INFINITY }, b = { -INFINITY, -INFINITY, -INFINITY };
	for (uint32_t i = 0; i < m->indices; i++) {
		const ob_vec3 p = place_of(m, i);
		a = ob_v3(fmin(a.x, p.x), fmin(a.y, p.y), fmin(a.z, p.z));
		b = ob_v3(fmax(b.x, p.x), fmax(b.y, p.y), fmax(b.z, p.z));
	}
	CHECK(ob_norm(ob_sub(a, low)) < 1e-5);
	CHECK(ob_norm(ob_sub(b, high)) < 1e-5);
}

static void nodes_place_what_they_have(void)
{
	ob_mesh m = read_cube(GLB_CUBE);
	CHECK(m.indices == 36 && m.vertices == 36); // without normals of its own a triangle shares no vertex
	CHECK_NEAR(volume(&m), 8, 1e-5);
	CHECK_NEAR(m.radius, sqrt(3), 1e-6);
	check_normals(&m, ob_v3(0, 0, 0));
	CHECK(m.vertex[0].colour[0] < 0 && m.vertex[0].surface < 0); // nothing paints it
	ob_mesh_finish(&m);

	// A quarter turn about glTF's y, which is our z, of what lies 5 along x and is 3 times as high: it comes to lie
	// at y = 5
	m = read_cube(
		"{\"scene\":1,\"scenes\":[{\"nodes\":[]},{\"nodes\":[1]}],\"nodes\":["
		"{\"mesh\":0,\"translation\":[5,0,0],\"scale\":[1,3,1]},"
		"{\"children\":[0],\"rotation\":[0,0.70710678118654752,0,0.70710678118654752]}]," ONE_MESH GLB_CUBE_REST
		"}");
	CHECK_NEAR(volume(&m), 24, 1e-4);
	check_bounds(&m, ob_v3(-1, 4, -3), ob_v3(1, 6, 3));
	check_normals(&m, ob_v3(0, 5, 0));
	ob_mesh_finish(&m);

	// Mirrored by a matrix, and the same mesh twice
	m = read_cube("{\"nodes\":[{\"mesh\":0,\"matrix\":[-1,0,0,0,0,1,0,0,0,0,1,0,0,10,0,1]},{\"mesh\":0}]," ONE_MESH
			      GLB_CUBE_REST "}");
	CHECK(m.indices == 72);
	CHECK_NEAR(volume(&m), 16, 1e-4);
	check_bounds(&m, ob_v3(-1, -1, -1), ob_v3(1, 1, 11));
	ob_mesh_finish(&m);
}

static void it_is_scaled_turned_and_moved(void)
{
	ob_mesh m = read_cube(GLB_CUBE);
	ob_error e;
	const ob_pose pose = { { 1, 2, 3 }, ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, M_PI / 4)) };
	CHECK(ob_mesh_place(&m, .5, pose, &e));
	CHECK_NEAR(volume(&m), 1, 1e-5);
	check_bounds(&m, ob_v3(1 - sqrt(.5), 2 - sqrt(.5), 2.5), ob_v3(1 + sqrt(.5), 2 + sqrt(.5), 3.5));
	check_normals(&m, pose.p);
	CHECK(m.radius > 4 && m.radius < 4.7);
	CHECK(!ob_mesh_place(&m, 1e6, pose, &e) && strstr(e.text, "1000 km"));
	ob_mesh_finish(&m);
}

// Normals are there, so corners are shared; colours of corners multiply the material's.
static void materials_paint(void)
{
	struct {
		glb_cube_buffer cube;
		float normal[8][3];
		uint8_t colour[8][4];
	} b = { .cube = glb_cube_of(1) };
	static const char json[] =
		"{\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":2,"
		"\"COLOR_0\":3},\"indices\":1,\"material\":0}]}],\"materials\":[{\"pbrMetallicRoughness\":{"
		"\"baseColorFactor\":[0.5,0.25,1,1],\"metallicFactor\":1,\"roughnessFactor\":0.25}}],"
		"\"asset\":{\"version\":\"2.0\"},\"accessors\":["
		"{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"},"
		"{\"bufferView\":1,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"},"
		"{\"bufferView\":2,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"},"
		"{\"bufferView\":3,\"componentType\":5121,\"normalized\":true,\"count\":8,\"type\":\"VEC4\"}],"
		"\"bufferViews\":[{\"buffer\":0,\"byteLength\":96},{\"buffer\":0,\"byteOffset\":96,\"byteLength\":72},"
		"{\"buffer\":0,\"byteOffset\":168,\"byteLength\":96},{\"buffer\":0,\"byteOffset\":264,\"byteLength\":"
		"32}],"
		"\"buffers\":[{\"byteLength\":296}]}";
	for (int i = 0; i < 8; i++) {
		memcpy(b.normal[i], b.cube.corner[i], sizeof b.normal[i]);
		memcpy(b.colour[i], (uint8_t[]){ 255, 0, 51, 255 }, 4);
	}
	ob_mesh m;
	ob_error e = { "" };
	glb g = glb_make(json, &b, sizeof b);
	CHECK(ob_mesh_read(&m, g.bytes, g.size, &e));
	CHECK(m.vertices == 8 && m.indices == 36 && m.parts == 0 && m.images == 0);
	check_normals(&m, ob_v3(0, 0, 0));
	CHECK_NEAR(m.vertex->colour[0], .5, 1e-6);
	CHECK_NEAR(m.vertex->colour[1], 0, 1e-6);
	CHECK_NEAR(m.vertex->colour[2], .2, 1e-6);
	CHECK_NEAR(m.vertex->surface, 15.25, 1e-6);
	ob_mesh_finish(&m);
	free(g.bytes);
}

static void refuse_file(glb g, const char *saying)
{
	ob_mesh m;
	ob_error e = { "" };
	CHECK(!ob_mesh_read(&m, g.bytes, g.size, &e));
	CHECK(strstr(e.text, saying));
	if (!strstr(e.text, saying))
		fprintf(stderr, "  expected %s\n  got %s\n", saying, e.text);
	CHECK(!m.vertex && !m.index && !m.part && !m.image);
	free(g.bytes);
}

static void refuse(const char *json, const void *buffer, size_t size, const char *saying)
{
	refuse_file(glb_make(json, buffer, size), saying);
}

static void refuse_cube(const char *json, const char *saying)
{
	const glb_cube_buffer cube = glb_cube_of(1);
	refuse(json, &cube, sizeof cube, saying);
}

// ---- pictures

static ob_mesh read_textured(const picture *p, const char *values, const char *more)
{
	glb g = textured_cube(p, values, more);
	ob_mesh m = { 0 };
	ob_error e = { "" };
	CHECK(ob_mesh_read(&m, g.bytes, g.size, &e));
	if (e.text[0])
		fprintf(stderr, "  %s\n", e.text);
	free(g.bytes);
	return m;
}

static void refuse_textured(const picture *p, const char *values, const char *more, const char *saying)
{
	refuse_file(textured_cube(p, values, more), saying);
}

static void pictures_lie_on_it(void)
{
	const picture png = grey_png(), jpeg = orange_jpeg();
	ob_mesh m = read_textured(&png, "\"baseColorFactor\":[0.5,1,1,1],\"baseColorTexture\":{\"index\":0}", TEXTURES);
	CHECK(m.images == 1 && m.image[0].width == WIDTH && m.image[0].height == HEIGHT);
	for (int i = 0; m.images && i < WIDTH * HEIGHT; i++) {
		const uint8_t *pixel = m.image[0].rgba + 4 * i, grey = shade(i % WIDTH, i / WIDTH);
		CHECK(pixel[0] == grey && pixel[1] == grey && pixel[2] == grey && pixel[3] == 255);
	}
	// parts with it come first, then those without
	CHECK(m.parts == 2 && m.part[0].indices == 36 && m.part[0].colour == 1 && m.part[0].surface == 0);
	CHECK(m.part[0].wrap[0] == OB_MESH_CLAMP && m.part[0].wrap[1] == OB_MESH_MIRROR);
	CHECK(m.part[1].indices == 36 && m.part[1].colour == 0 && m.part[1].surface == 0);
	for (int i = 0; i < 36; i++) {
		const ob_mesh_vertex *v = &m.vertex[m.index[i]];
		CHECK(v->texture[0] == (float)glb_cube[i] && v->texture[1] == .25f);
		CHECK(v->colour[0] == .5f && v->colour[1] == 1);
	}
	CHECK(m.vertex[m.index[36]].colour[0] < 0);
	CHECK(ob_mesh_bytes(&m) ==
	      m.vertices * sizeof *m.vertex + m.indices * 4 + 2 * sizeof *m.part + 4 * WIDTH * HEIGHT);
	ob_mesh_finish(&m);

	// The same one as colours and as roughness and metal is two: the one is sRGB
	m = read_textured(&jpeg,
			  "\"baseColorTexture\":{\"index\":0},\"metallicRoughnessTexture\":{\"index\":0},"
			  "\"roughnessFactor\":0.5",
			  TEXTURES);
	CHECK(m.images == 2 && m.parts == 2 && m.part[0].colour == 1 && m.part[0].surface == 2);
	CHECK_NEAR(m.vertex[m.index[0]].surface, 15.5, 1e-6);
	for (int i = 0; m.images == 2 && i < WIDTH * HEIGHT; i++)
		for (int k = 0; k < 3; k++)
			CHECK(abs(m.image[1].rgba[4 * i + k] - (const int[]){ 230, 120, 30 }[k]) <= 3);
	ob_mesh_finish(&m);

	// Scaled, turned (a quarter: u becomes -v), moved
	m = read_textured(
		&png,
		"\"baseColorTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_transform\":{\"scale\":[2,4],"
		"\"rotation\":1.5707963267948966,\"offset\":[10,20]}}}",
		TEXTURES);
	CHECK_NEAR(m.vertex[m.index[0]].texture[0], 10 + 4 * .25, 1e-5);
	CHECK_NEAR(m.vertex[m.index[0]].texture[1], 20 - 2 * glb_cube[0], 1e-5);
	ob_mesh_finish(&m);

	// Coordinates that are not there: its corner everywhere
	m = read_textured(&png, "\"baseColorTexture\":{\"index\":0,\"texCoord\":1}", TEXTURES);
	CHECK(m.images == 1 && m.vertex[m.index[0]].texture[0] == 0);
	ob_mesh_finish(&m);
}

// The same picture, as its head says of another size.
static picture resized(picture p, uint32_t width, uint32_t height)
{
	put_big_endian(p.bytes + 16, width);
	put_big_endian(p.bytes + 20, height);
	put_big_endian(p.bytes + 29, (uint32_t)crc32(0, p.bytes + 12, 17));
	return p;
}

static void pictures_that_are_none_are_refused(void)
{
	static const char base[] = "\"baseColorTexture\":{\"index\":0}";
	const picture png = grey_png(), jpeg = orange_jpeg();
	picture p;
	for (size_t n = 0; n < png.size; n++) {
		p = png;
		p.size = n;
		refuse_textured(&p, base, TEXTURES, n < 8 ? "neither PNG nor JPEG" : "damaged PNG");
	}
	for (size_t n = 3; n < jpeg.size; n++) {
		p = jpeg;
		p.size = n;
		refuse_textured(&p, base, TEXTURES, "damaged JPEG");
	}
	p = png;
	((unsigned char *)memmem(p.bytes, p.size, "IDAT", 4))[6] ^= 1;
	refuse_textured(&p, base, TEXTURES, "damaged PNG");
	p = resized(png, 100000, 3);
	refuse_textured(&p, base, TEXTURES, "100000 x 3 pixels: expected at most 4096 x 4096");
	p = resized(png, 0x7fffffff, 0x7fffffff);
	refuse_textured(&p, base, TEXTURES, "expected at most 4096 x 4096");
	p = resized(png, 4096, 4096);
	refuse_textured(&p, base, TEXTURES, "more than 8388608 pixels");
	p = resized(png, 4096, 2048); // as large as may be, and not there
	refuse_textured(&p, base, TEXTURES, "damaged PNG");
	p = resized(png, 0, 3);
	refuse_textured(&p, base, TEXTURES, "damaged PNG");

	refuse_textured(&png, "\"baseColorTexture\":{\"index\":1}", TEXTURES, "no texture 1");
	refuse_textured(&png, base, "\"textures\":[{\"source\":1}],", "no picture 1");
	refuse_textured(&png, base, "\"textures\":[{}],", "no picture -1");
	refuse_textured(&png, base, "\"textures\":[{\"source\":0,\"sampler\":4}],", "no sampler 4");
	refuse_textured(&png,
			"\"baseColorTexture\":{\"index\":0},\"metallicRoughnessTexture\":{\"index\":0,\"texCoord\":1}",
			TEXTURES, "in different ways");
	refuse_cube(
		"{\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
		"\"material\":0}]}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}],"
		"\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"/etc/passwd\"}]," GLB_CUBE_REST "}",
		"another file");
	refuse_cube(
		"{\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
		"\"material\":0}]}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}],"
		"\"textures\":[{\"source\":0}],\"images\":[{\"bufferView\":0,\"mimeType\":\"image/"
		"webp\"}]," GLB_CUBE_REST "}",
		"neither PNG nor JPEG");
}

// A thousand times, for which there would be no time if the rest were read, too.
static void nothing_but_pixels_is_read(void)
{
	const picture png = wordy_png();
	CHECK(png.size > PICTURE_MAX / 2);
	for (int i = 0; i < 1000; i++) {
		ob_mesh m = read_textured(&png, "\"baseColorTexture\":{\"index\":0}", TEXTURES);
		CHECK(m.images == 1 && m.image[0].width == WIDTH && m.image[0].rgba[4] == shade(1, 0));
		ob_mesh_finish(&m);
	}
}

static void bytes_are_a_picture_once(void)
{
	const picture png = grey_png();
	ob_error e = { "" };
	ob_mesh m;
	glb g = sharing_cube(&png, 200, 0);
	CHECK(ob_mesh_read(&m, g.bytes, g.size, &e) && m.images == 1 && m.parts == 1 && m.indices == 200 * 36);
	ob_mesh_finish(&m);
	free(g.bytes);
	g = sharing_cube(&png, 2, 1);
	CHECK(ob_mesh_read(&m, g.bytes, g.size, &e) && m.images == 2 && m.parts == 2);
	ob_mesh_finish(&m);
	free(g.bytes);
	g = sharing_cube(&png, 200, 1);
	CHECK(!ob_mesh_read(&m, g.bytes, g.size, &e) && strstr(e.text, "its pictures overlap in the file"));
	free(g.bytes);
}

static void strips_fans_and_both_sides(void)
{
	// One face of the cube, as a strip, as a fan, and as what is seen from both sides; in our frame it lies at y =
	// 1
	struct {
		glb_cube_buffer cube;
		uint16_t strip[4], fan[4];
	} b = { glb_cube_of(1), { 0, 2, 1, 3 }, { 0, 2, 3, 1 } };
	static const char json[] =
		"{\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,"
		"\"mode\":%d,\"material\":0}]}],\"materials\":[{\"doubleSided\":%s}],\"asset\":{\"version\":\"2.0\"},"
		"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"},"
		"{\"bufferView\":1,\"byteOffset\":%d,\"componentType\":5123,\"count\":4,\"type\":\"SCALAR\"}],"
		"\"bufferViews\":[{\"buffer\":0,\"byteLength\":96},{\"buffer\":0,\"byteOffset\":168,\"byteLength\":16}]"
		","
		"\"buffers\":[{\"byteLength\":184}]}";
	for (int i = 0; i < 4; i++) {
		const bool fan = i & 1, both = i & 2;
		char text[sizeof json + 16];
		ob_mesh m;
		ob_error e = { "" };
		snprintf(text, sizeof text, json, fan ? 6 : 5, both ? "true" : "false", fan ? 8 : 0);
		glb g = glb_make(text, &b, sizeof b);
		CHECK(ob_mesh_read(&m, g.bytes, g.size, &e));
		CHECK(m.indices == (both ? 12u : 6u));
		CHECK_NEAR(volume(&m), both ? 0 : 4. / 3, 1e-6); // it is seen from outside
		CHECK_NEAR(m.vertex[m.index[0]].normal[1], 1, 1e-6);
		CHECK_NEAR(m.vertex[m.index[m.indices - 1]].normal[1], both ? -1 : 1, 1e-6);
		ob_mesh_finish(&m);
		free(g.bytes);
	}
}

static void refuse_bytes(const void *bytes, size_t size, const char *saying)
{
	ob_mesh m;
	ob_error e = { "" };
	CHECK(!ob_mesh_read(&m, bytes, size, &e));
	CHECK(strstr(e.text, saying));
	if (!strstr(e.text, saying))
		fprintf(stderr, "  expected %s\n  got %s\n", saying, e.text);
}

static void what_is_no_mesh_is_refused(void)
{
	glb_cube_buffer cube = glb_cube_of(1);
	glb g = glb_make(GLB_CUBE, &cube, sizeof cube);
	ob_mesh m;
	ob_error e;
	refuse_bytes("", 0, "no binary glTF");
	refuse_bytes(" {\"asset\":{}}", 13, "glTF as text");
	refuse_bytes("\x89PNG\r\n\x1a\n", 8, "no binary glTF");
	for (size_t n = 0; n < g.size; n++)
		CHECK(!ob_mesh_read(&m, g.bytes, n, &e));
	refuse_bytes(g.bytes, g.size - 1, "cut short");
	g.bytes[4] = 1;
	refuse_bytes(g.bytes, g.size, "version 1");
	free(g.bytes);

	refuse_cube("{" ONE_MESH GLB_CUBE_REST ",\"nodes\":[]}", "no triangles");
	refuse_cube(
		"{\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":0}]}]"
		"," GLB_CUBE_REST "}",
		"no triangles");
	refuse_cube("{\"nodes\":[{\"mesh\":1}]," ONE_MESH GLB_CUBE_REST "}", "no mesh 1");
	refuse_cube("{\"nodes\":[{\"mesh\":0,\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]," ONE_MESH GLB_CUBE_REST
		    "}",
		    "two parents");
	refuse_cube("{\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"nodes\":[{\"mesh\":0}]," ONE_MESH
			    GLB_CUBE_REST "}",
		    "the extension KHR_draco_mesh_compression");
	refuse_cube("{\"nodes\":[{\"mesh\":0}]," ONE_MESH GLB_CUBE_REST
		    ",\"buffers\":[{\"byteLength\":168},{\"byteLength\":168}]}",
		    "several buffers");
	refuse_cube("{\"nodes\":[{\"mesh\":0}]," ONE_MESH
		    "\"asset\":{\"version\":\"2.0\"},\"accessors\":[],\"bufferViews\":[],"
		    "\"buffers\":[{\"byteLength\":4,\"uri\":\"/etc/passwd\"}]}",
		    "damaged");
	cube.index[7] = 8;
	refuse(GLB_CUBE, &cube, sizeof cube, "an index is that of no vertex");
	cube = glb_cube_of(1);
	cube.corner[0][0] = NAN;
	for (int i = 0; i < 36; i++)
		cube.index[i] = (uint16_t)(i % 3);
	refuse(GLB_CUBE, &cube, sizeof cube, "no triangles");
	cube = glb_cube_of(2e6f);
	refuse(GLB_CUBE, &cube, sizeof cube, "1000 km");
}

static void what_would_be_large_is_refused(void)
{
	const glb_cube_buffer cube = glb_cube_of(1);
	enum { DEEP = 200000, NODES = 16000, OBJECTS = 66000 };
	char *text = malloc(OB_MESH_JSON_MAX + 100);
	int n = sprintf(text, "{\"extras\":");
	memset(text + n, '[', DEEP);
	text[n + DEEP] = 0;
	refuse(text, &cube, sizeof cube, "nested too deeply");
	memset(text, ' ', OB_MESH_JSON_MAX + 4);
	text[OB_MESH_JSON_MAX + 4] = 0;
	refuse(text, &cube, sizeof cube, "512 KiB");
	n = sprintf(text, "{" ONE_MESH GLB_CUBE_REST ",\"nodes\":[");
	for (int i = 0; i < NODES; i++)
		n += sprintf(text + n, "%s{\"mesh\":0}", i ? "," : "");
	sprintf(text + n, "]}");
	refuse(text, &cube, sizeof cube, "more than 500000 vertices");
	n = sprintf(text, "{" ONE_MESH GLB_CUBE_REST ",\"materials\":[{}");
	for (int i = 0; i < OBJECTS; i++)
		n += sprintf(text + n, ",{}");
	sprintf(text + n, "]}");
	refuse(text, &cube, sizeof cube, "more than 65536 objects and lists");
	free(text);
}

int main(void)
{
	nodes_place_what_they_have();
	it_is_scaled_turned_and_moved();
	materials_paint();
	strips_fans_and_both_sides();
	pictures_lie_on_it();
	what_is_no_mesh_is_refused();
	pictures_that_are_none_are_refused();
	nothing_but_pixels_is_read();
	bytes_are_a_picture_once();
	what_would_be_large_is_refused();
	return check_end();
}
