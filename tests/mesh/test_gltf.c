// Binary glTF files: where nodes place their triangles, which way these look, what paints them; and files that are
// none.
#include <math.h>

#include "check.h"
#include "glb.h"
#include "mesh/mesh.h"

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
		"\"baseColorFactor\":[0.5,0.25,1,1],\"metallicFactor\":1,\"roughnessFactor\":0.25%s}}],"
		"\"asset\":{\"version\":\"2.0\"},\"accessors\":["
		"{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"},"
		"{\"bufferView\":1,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"},"
		"{\"bufferView\":2,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"},"
		"{\"bufferView\":3,\"componentType\":5121,\"normalized\":true,\"count\":8,\"type\":\"VEC4\"}],"
		"\"bufferViews\":[{\"buffer\":0,\"byteLength\":96},{\"buffer\":0,\"byteOffset\":96,\"byteLength\":72},"
		"{\"buffer\":0,\"byteOffset\":168,\"byteLength\":96},{\"buffer\":0,\"byteOffset\":264,\"byteLength\":"
		"32}],"
		"\"buffers\":[{\"byteLength\":296}]}";
	static const char texture[] = ",\"baseColorTexture\":{\"index\":0}";
	for (int i = 0; i < 8; i++) {
		memcpy(b.normal[i], b.cube.corner[i], sizeof b.normal[i]);
		memcpy(b.colour[i], (uint8_t[]){ 255, 0, 51, 255 }, 4);
	}
	for (int textured = 0; textured < 2; textured++) {
		char text[sizeof json + sizeof texture];
		ob_mesh m;
		ob_error e = { "" };
		snprintf(text, sizeof text, json, textured ? texture : "");
		glb g = glb_make(text, &b, sizeof b);
		CHECK(ob_mesh_read(&m, g.bytes, g.size, &e));
		CHECK(m.vertices == 8 && m.indices == 36);
		check_normals(&m, ob_v3(0, 0, 0));
		const ob_mesh_vertex *v = m.vertex;
		CHECK_NEAR(v->colour[0], textured ? -1 : .5, 1e-6); // what a texture says is the object's to say
		CHECK_NEAR(v->colour[1], textured ? -1 : 0, 1e-6);
		CHECK_NEAR(v->colour[2], textured ? -1 : .2, 1e-6);
		CHECK_NEAR(v->surface, 15.25, 1e-6);
		ob_mesh_finish(&m);
		free(g.bytes);
	}
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

static void refuse(const char *json, const void *buffer, size_t size, const char *saying)
{
	glb g = glb_make(json, buffer, size);
	ob_mesh m;
	ob_error e = { "" };
	CHECK(!ob_mesh_read(&m, g.bytes, g.size, &e));
	CHECK(strstr(e.text, saying));
	if (!strstr(e.text, saying))
		fprintf(stderr, "  expected %s\n  got %s\n", saying, e.text);
	CHECK(!m.vertex && !m.index);
	free(g.bytes);
}

static void refuse_cube(const char *json, const char *saying)
{
	const glb_cube_buffer cube = glb_cube_of(1);
	refuse(json, &cube, sizeof cube, saying);
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
	enum { DEEP = 200000, NODES = 16000 };
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
	free(text);
}

int main(void)
{
	if (!ob_mesh_can_read()) {
		fprintf(stderr, "skipped: built without tinygltf\n");
		return 77;
	}
	nodes_place_what_they_have();
	it_is_scaled_turned_and_moved();
	materials_paint();
	strips_fans_and_both_sides();
	what_is_no_mesh_is_refused();
	what_would_be_large_is_refused();
	return check_end();
}
