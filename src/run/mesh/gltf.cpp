// glTF through tinygltf, which turns the JSON into structures and checks little more than its form. So sizes are
// bounded before the call (look_through); tinygltf may open no other file and decodes no picture (image.c does). Every
// index, count and offset in the file is checked here before use.
#include <math.h> // C++'s own must not come in with C linkage
#include <exception>
#include <memory>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string>
#include <string.h>
#include <vector>

#include <tiny_gltf.h>

extern "C" {
#include "base/budget.h"
#include "mesh/gltf.h"
#include "mesh/image.h"
}

namespace
{

enum { DEPTH_MAX = 32, STRIDE_MAX = 65536 };
// Limit of the work to read a file: corners of triangles, plus WORK_OF_PART for each part. Nodes that share a mesh
// multiply both.
enum { WORK_MAX = 4 * 3 * OB_MESH_TRIANGLES_MAX, WORK_OF_PART = 16 };
enum { JSON_OBJECTS_MAX = 65536, BYTES_OF_OBJECT = 3500 }; // memory of each object, at most

// Error text of a damaged file, thrown.
struct fault {
	std::string text;
};

[[noreturn]] void fail(const std::string &text)
{
	throw fault{ text };
}

// ---- checks before tinygltf

// Counts brackets and buffers: tinygltf recurses once a bracket, makes a large structure of each, and copies all bytes
// for each buffer. Returns the number of objects and lists.
size_t look_through(const char *json, size_t size)
{
	std::string text, key;
	size_t depth = 0, buffers = 0, objects = 0;
	for (size_t i = 0; i < size; i++) {
		const char c = json[i];
		if (c == '"') {
			const size_t from = ++i;
			for (; i < size && json[i] != '"'; i++)
				if (json[i] == '\\')
					i++;
			if (depth == 1)
				text.assign(json + from, (i < size ? i : size) - from);
			if (depth == 1 && text.find('\\') != std::string::npos)
				fail("its JSON has a name with \\");
		} else if (c == ':' && depth == 1) {
			key = text;
		} else if (c == '{' || c == '[') {
			if (++depth > DEPTH_MAX)
				fail("its JSON is nested too deeply");
			if (++objects > JSON_OBJECTS_MAX)
				fail("its JSON has more than " + std::to_string(JSON_OBJECTS_MAX) +
				     " objects and lists");
			buffers += depth == 3 && c == '{' && key == "buffers";
		} else if ((c == '}' || c == ']') && depth > 0) {
			depth--;
		}
	}
	if (buffers > 1)
		fail("it has several buffers: expected one, in the file itself");
	return objects;
}

bool starts_with(const std::string &text, const char *with)
{
	return text.compare(0, strlen(with), with) == 0;
}

// Refuses files with required extensions that are not supported here.
void check_extensions(const tinygltf::Model &model)
{
	for (const std::string &name : model.extensionsRequired)
		if (name != "KHR_mesh_quantization" && name != "KHR_texture_transform" &&
		    !starts_with(name, "KHR_materials_"))
			fail("it needs the extension " + name + ", which is not read here");
}

bool skip_picture(tinygltf::Image *, const int, std::string *, std::string *, int, int, const unsigned char *, int,
		  void *)
{
	return true;
}

void parse(tinygltf::Model &model, const unsigned char *bytes, size_t size)
{
	tinygltf::TinyGLTF loader;
	std::string error, warning;
	uint32_t json;
	memcpy(&json, bytes + 12, sizeof json);
	const size_t objects = look_through(reinterpret_cast<const char *>(bytes) + 20, json);
	ob_error e;
	if (!ob_budget_allows(objects * BYTES_OF_OBJECT + size, &e))
		fail(e.text);
	loader.SetImageLoader(skip_picture, nullptr);
	loader.SetFsCallbacks({ nullptr, nullptr, nullptr, nullptr, nullptr });
	if (!loader.LoadBinaryFromMemory(&model, &error, &warning, bytes, static_cast<unsigned>(size)))
		fail("it is damaged: " + error.substr(0, error.find('\n')));
	if (!starts_with(model.asset.version, "2."))
		fail("it is glTF of version " + model.asset.version + ": expected 2");
	check_extensions(model);
}

template <class T> const T &at(const std::vector<T> &list, int index, const char *what)
{
	if (index < 0 || static_cast<size_t>(index) >= list.size())
		fail(std::string("it is damaged: it has no ") + what + " " + std::to_string(index));
	return list[static_cast<size_t>(index)];
}

// ---- numbers in a buffer

struct vec {
	double x, y, z;
};

struct numbers {
	const unsigned char *bytes;
	size_t stride, count;
	int type, parts;
	bool normalized;
};

// Returns the buffer of a view, if the buffer holds all of it.
const std::vector<unsigned char> &buffer_of(const tinygltf::Model &model, const tinygltf::BufferView &view,
					    const char *what)
{
	const std::vector<unsigned char> &data = at(model.buffers, view.buffer, "buffer").data;
	if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
		fail(std::string("it is damaged: its ") + what + " are not all there");
	return data;
}

numbers open(const tinygltf::Model &model, int index, const char *what)
{
	const tinygltf::Accessor &a = at(model.accessors, index, "accessor");
	if (a.sparse.isSparse)
		fail(std::string("its ") + what + " are sparse, which is not read here");
	const tinygltf::BufferView &view = at(model.bufferViews, a.bufferView, "buffer view");
	const std::vector<unsigned char> &data = buffer_of(model, view, what);
	const int bytes = tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(a.componentType));
	const int parts = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(a.type));
	if (bytes <= 0 || parts <= 0 || parts > 4 || view.byteStride > STRIDE_MAX ||
	    (view.byteStride && view.byteStride < static_cast<size_t>(bytes * parts)))
		fail(std::string("it is damaged: its ") + what + " are of no known type");
	const size_t one = static_cast<size_t>(bytes * parts), stride = view.byteStride ? view.byteStride : one;
	const bool inside = a.byteOffset <= view.byteLength && one <= view.byteLength - a.byteOffset;
	if (!inside || a.count == 0 || a.count - 1 > (view.byteLength - a.byteOffset - one) / stride)
		fail(std::string("it is damaged: its ") + what + " are not all there");
	return { data.data() + view.byteOffset + a.byteOffset, stride, a.count, a.componentType, parts, a.normalized };
}

template <class T> T raw(const unsigned char *bytes)
{
	T value;
	memcpy(&value, bytes, sizeof value);
	return value;
}

double number(const numbers &n, size_t i, int part)
{
	const unsigned char *row = n.bytes + i * n.stride;
	switch (n.type) {
	case TINYGLTF_COMPONENT_TYPE_FLOAT:
		return static_cast<double>(raw<float>(row + 4 * part));
	case TINYGLTF_COMPONENT_TYPE_BYTE:
		return raw<int8_t>(row + part) / (n.normalized ? 127. : 1.);
	case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
		return raw<uint8_t>(row + part) / (n.normalized ? 255. : 1.);
	case TINYGLTF_COMPONENT_TYPE_SHORT:
		return raw<int16_t>(row + 2 * part) / (n.normalized ? 32767. : 1.);
	case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
		return raw<uint16_t>(row + 2 * part) / (n.normalized ? 65535. : 1.);
	case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
		return static_cast<double>(raw<uint32_t>(row + 4 * part));
	default:
		fail("it is damaged: it has numbers of no known type");
	}
}

vec triple(const numbers &n, size_t i)
{
	return { number(n, i, 0), number(n, i, 1), number(n, i, 2) };
}

// ---- transforms of nodes

vec operator-(vec a, vec b)
{
	return { a.x - b.x, a.y - b.y, a.z - b.z };
}
vec operator*(double s, vec a)
{
	return { s * a.x, s * a.y, s * a.z };
}
vec cross(vec a, vec b)
{
	return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
double dot(vec a, vec b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Columns and a translation: p is x p.x + y p.y + z p.z + at.
struct transform {
	vec x, y, z, at;
};

vec turned(const transform &t, vec p)
{
	return { t.x.x * p.x + t.y.x * p.y + t.z.x * p.z, t.x.y * p.x + t.y.y * p.y + t.z.y * p.z,
		 t.x.z * p.x + t.y.z * p.y + t.z.z * p.z };
}

vec moved(const transform &t, vec p)
{
	const vec q = turned(t, p);
	return { q.x + t.at.x, q.y + t.at.y, q.z + t.at.z };
}

transform after(const transform &t, const transform &first)
{
	return { turned(t, first.x), turned(t, first.y), turned(t, first.z), moved(t, first.at) };
}

// Normals transform by the cofactors, which equal the transposed inverse times a factor. Its sign is the sign of the
// volume, so that normals of mirrored meshes point outward, too.
transform of_normals(const transform &t)
{
	const double side = dot(t.x, cross(t.y, t.z)) < 0 ? -1 : 1;
	return { side * cross(t.y, t.z), side * cross(t.z, t.x), side * cross(t.x, t.y), { 0, 0, 0 } };
}

// y points up in glTF; z does here.
const transform upright = { { 1, 0, 0 }, { 0, 0, 1 }, { 0, -1, 0 }, { 0, 0, 0 } };

transform of_node(const tinygltf::Node &n)
{
	const std::vector<double> &m = n.matrix, &q = n.rotation, &s = n.scale, &p = n.translation;
	if ((!m.empty() && m.size() != 16) || (!q.empty() && q.size() != 4) || (!s.empty() && s.size() != 3) ||
	    (!p.empty() && p.size() != 3))
		fail("it is damaged: a node has a transform of the wrong length");
	if (!m.empty())
		return { { m[0], m[1], m[2] }, { m[4], m[5], m[6] }, { m[8], m[9], m[10] }, { m[12], m[13], m[14] } };
	transform t = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 } };
	if (!q.empty()) {
		const double x = q[0], y = q[1], z = q[2], w = q[3];
		t.x = { 1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y) };
		t.y = { 2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x) };
		t.z = { 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y) };
	}
	if (!s.empty())
		t = { s[0] * t.x, s[1] * t.y, s[2] * t.z, t.at };
	if (!p.empty())
		t.at = { p[0], p[1], p[2] };
	return t;
}

// ---- the growing mesh

struct release {
	void operator()(uint8_t *bytes) const { free(bytes); }
};

struct picture {
	size_t at, bytes; // in the file's buffer
	bool surface; // a surface: green and blue are numbers
	uint32_t width, height;
	std::unique_ptr<uint8_t, release> rgba;
};

struct group {
	ob_mesh_part part;
	std::vector<uint32_t> index;
};

struct builder {
	std::vector<ob_mesh_vertex> vertex;
	std::vector<group> groups;
	std::vector<picture> pictures;
	std::vector<uint32_t> known,
		known_in; // by index in the primitive: index in vertex, and its round
	size_t indices = 0; // of all groups
	size_t pixels = 0, picture_bytes = 0; // of all pictures, packed
	uint32_t round = 0;
	size_t work = 0;
};

void spend(builder &b, size_t more)
{
	b.work += more;
	if (b.work > WORK_MAX)
		fail("it has more parts, or more triangles, than are read here");
}

// Returns the number of the group of these images.
size_t group_of(builder &b, const ob_mesh_part &part)
{
	size_t i = 0;
	while (i < b.groups.size() && memcmp(&b.groups[i].part, &part, sizeof part) != 0)
		i++;
	if (i == OB_MESH_PARTS_MAX)
		fail("it has more than " + std::to_string(OB_MESH_PARTS_MAX) + " materials with pictures of their own");
	if (i == b.groups.size())
		b.groups.push_back({ part, {} });
	return i;
}

template <class T> T *copy(const T *from, size_t count)
{
	T *to = static_cast<T *>(malloc(count * sizeof *from));
	if (!to)
		throw std::bad_alloc();
	memcpy(to, from, count * sizeof *from);
	return to;
}

void move_to(builder &b, ob_mesh *m)
{
	std::vector<uint32_t> index;
	std::vector<ob_mesh_part> part;
	if (b.indices == 0)
		fail("it has no triangles");
	for (group &g : b.groups) {
		g.part.indices = static_cast<uint32_t>(g.index.size());
		index.insert(index.end(), g.index.begin(), g.index.end());
		part.push_back(g.part);
	}
	m->vertex = copy(b.vertex.data(), b.vertex.size());
	m->vertices = static_cast<uint32_t>(b.vertex.size());
	m->index = copy(index.data(), index.size());
	m->indices = static_cast<uint32_t>(index.size());
	if (b.pictures.empty())
		return;
	m->part = copy(part.data(), part.size());
	m->parts = static_cast<uint32_t>(part.size());
	m->image = static_cast<ob_mesh_image *>(malloc(b.pictures.size() * sizeof *m->image));
	if (!m->image)
		throw std::bad_alloc();
	for (picture &p : b.pictures)
		m->image[m->images++] = { p.width, p.height, p.rgba.release() };
}

// ---- materials of triangles

// u and v are each x u + y v + at, of the file's u and v.
struct coordinates {
	int set;
	double u[3], v[3];
};

// Material of a primitive's triangles.
struct paint {
	float colour[3], surface; // below 0: the object's
	ob_mesh_part part;
	coordinates where; // in its images
};

float share(double x)
{
	return static_cast<float>(fmin(fmax(x, 0), 1)); // NaN becomes 0
}

// Returns 1 + the number of a texture's picture, and reads it if it is new. Images of the same bytes are one picture.
// No byte is unpacked more than twice: once as a colour, once as a surface.
uint8_t picture_of(builder &b, const tinygltf::Model &model, int index, bool surface)
{
	const tinygltf::Image &image = at(model.images, index, "picture");
	ob_mesh_image read;
	ob_error e;
	if (image.bufferView < 0)
		fail("a picture of it lies in another file: expected all in one");
	const tinygltf::BufferView &view = at(model.bufferViews, image.bufferView, "buffer view");
	const std::vector<unsigned char> &data = buffer_of(model, view, "pictures");
	for (size_t i = 0; i < b.pictures.size(); i++) {
		const picture &p = b.pictures[i];
		if (p.at == view.byteOffset && p.bytes == view.byteLength && p.surface == surface)
			return static_cast<uint8_t>(i + 1);
	}
	if (b.pictures.size() == OB_MESH_IMAGES_MAX)
		fail("it has more than " + std::to_string(OB_MESH_IMAGES_MAX) + " pictures");
	b.picture_bytes += view.byteLength;
	if (b.picture_bytes > 2 * data.size())
		fail("its pictures overlap in the file");
	b.pictures.reserve(b.pictures.size() + 1); // so that a picture has an owner as soon as it is read
	if (!ob_image_read(&read, data.data() + view.byteOffset, view.byteLength, OB_MESH_PIXELS_MAX - b.pixels, &e))
		fail(e.text);
	b.pictures.push_back({ view.byteOffset, view.byteLength, surface, read.width, read.height,
			       std::unique_ptr<uint8_t, release>(read.rgba) });
	b.pixels += static_cast<size_t>(read.width) * read.height;
	return static_cast<uint8_t>(b.pictures.size());
}

uint8_t wrap_of(int mode)
{
	return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? OB_MESH_CLAMP
	       : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? OB_MESH_MIRROR
							       : OB_MESH_REPEAT;
}

double member(const tinygltf::Value &v, const char *name, size_t k, double otherwise)
{
	if (!v.Has(name))
		return otherwise;
	const tinygltf::Value &pair = v.Get(name);
	const tinygltf::Value &one = pair.IsArray() && k < pair.ArrayLen() ? pair.Get(k) : pair;
	return one.IsNumber() ? one.GetNumberAsDouble() : otherwise;
}

// Applies the extension KHR_texture_transform: scale, rotation, offset.
coordinates coordinates_of(const tinygltf::TextureInfo &info)
{
	const auto found = info.extensions.find("KHR_texture_transform");
	if (found == info.extensions.end() || !found->second.IsObject())
		return { info.texCoord, { 1, 0, 0 }, { 0, 1, 0 } };
	const tinygltf::Value &t = found->second;
	const double turn = member(t, "rotation", 0, 0), c = cos(turn), s = sin(turn);
	const double x = member(t, "scale", 0, 1), y = member(t, "scale", 1, 1);
	const double set = member(t, "texCoord", 0, info.texCoord);
	return { set >= 0 && set < 100 ? static_cast<int>(set) : 0,
		 { c * x, s * y, member(t, "offset", 0, 0) },
		 { -s * x, c * y, member(t, "offset", 1, 0) } };
}

// Adds an image. All images of a part share one mapping.
void add_texture(builder &b, const tinygltf::Model &model, const tinygltf::TextureInfo &info, bool surface, paint &out)
{
	const tinygltf::Texture &t = at(model.textures, info.index, "texture");
	const tinygltf::Sampler none, &s = t.sampler < 0 ? none : at(model.samplers, t.sampler, "sampler");
	const uint8_t wrap[2] = { wrap_of(s.wrapS), wrap_of(s.wrapT) };
	const coordinates where = coordinates_of(info);
	const bool other = out.where.set != where.set || memcmp(out.where.u, where.u, sizeof where.u) != 0 ||
			   memcmp(out.where.v, where.v, sizeof where.v) != 0 || memcmp(out.part.wrap, wrap, 2) != 0;
	if (out.part.colour && other)
		fail("the two textures of a material lie on it in different ways, which is not read here");
	(surface ? out.part.surface : out.part.colour) = picture_of(b, model, t.source, surface);
	memcpy(out.part.wrap, wrap, 2);
	out.where = where;
}

paint paint_of(builder &b, const tinygltf::Model &model, const tinygltf::Primitive &p)
{
	paint out = { { -1, -1, -1 }, -1, {}, {} };
	if (p.material < 0)
		return out;
	const tinygltf::PbrMetallicRoughness &m = at(model.materials, p.material, "material").pbrMetallicRoughness;
	for (size_t k = 0; k < 3; k++)
		out.colour[k] = m.baseColorFactor.size() >= 3 ? share(m.baseColorFactor[k]) : 1;
	out.surface = ob_surface_pack(share(m.roughnessFactor), share(m.metallicFactor));
	if (m.baseColorTexture.index >= 0)
		add_texture(b, model, m.baseColorTexture, false, out);
	if (m.metallicRoughnessTexture.index >= 0)
		add_texture(b, model, m.metallicRoughnessTexture, true, out);
	return out;
}

// ---- triangles

// Vertices of one primitive. Triangles of one side share them where possible.
struct corners {
	numbers position, normal, colour, texture;
	bool has_normal, has_colour, has_texture;
	transform place, place_of_normal;
	paint look;
	size_t group;
};

uint32_t add_vertex(builder &b, const corners &c, uint32_t i, vec n)
{
	if (b.vertex.size() == OB_MESH_VERTICES_MAX)
		fail("it has more than " + std::to_string(OB_MESH_VERTICES_MAX) + " vertices");
	const vec p = moved(c.place, triple(c.position, i));
	n = 1 / sqrt(dot(n, n)) * n;
	ob_mesh_vertex v = { { static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z) },
			     { static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z) },
			     { c.look.colour[0], c.look.colour[1], c.look.colour[2] },
			     c.look.surface,
			     { 0, 0 } };
	for (int k = 0; k < 3 && c.has_colour && v.colour[k] >= 0; k++)
		v.colour[k] *= share(number(c.colour, i, k));
	if (c.has_texture) {
		const double s = number(c.texture, i, 0), t = number(c.texture, i, 1);
		const coordinates &w = c.look.where;
		v.texture[0] = static_cast<float>(w.u[0] * s + w.u[1] * t + w.u[2]);
		v.texture[1] = static_cast<float>(w.v[0] * s + w.v[1] * t + w.v[2]);
	}
	b.vertex.push_back(v);
	return static_cast<uint32_t>(b.vertex.size() - 1);
}

// Adds a corner with the primitive's normal or, where it has none, the triangle's.
uint32_t corner(builder &b, const corners &c, uint32_t i, vec flat, double side)
{
	const vec own = c.has_normal ? turned(c.place_of_normal, triple(c.normal, i)) : vec{ 0, 0, 0 };
	const double size = dot(own, own);
	if (!(size > 0 && size < INFINITY))
		return add_vertex(b, c, i, flat);
	if (b.known_in[i] != b.round) {
		b.known[i] = add_vertex(b, c, i, side * own);
		b.known_in[i] = b.round;
	}
	return b.known[i];
}

void add_triangle(builder &b, const corners &c, const uint32_t i[3], double side)
{
	const vec a = moved(c.place, triple(c.position, i[0]));
	const vec flat =
		cross(moved(c.place, triple(c.position, i[1])) - a, moved(c.place, triple(c.position, i[2])) - a);
	const double size = dot(flat, flat);
	if (!(size > 0 && size < INFINITY))
		return; // a degenerate triangle
	if (b.indices == 3 * static_cast<size_t>(OB_MESH_TRIANGLES_MAX))
		fail("it has more than " + std::to_string(OB_MESH_TRIANGLES_MAX) + " triangles");
	for (int k = 0; k < 3; k++)
		b.groups[c.group].index.push_back(corner(b, c, i[k], flat, side));
	b.indices += 3;
}

// Starts a new set of vertices: a primitive, or its other side, shares none with earlier ones.
void begin_round(builder &b, size_t vertices)
{
	b.round++;
	b.known.resize(vertices > b.known.size() ? vertices : b.known.size());
	b.known_in.resize(b.known.size());
}

// Adds lists, strips or fans; mirrored ones are reversed. side: 1, or -1 for the back.
void add_triangles(builder &b, const corners &c, const std::vector<uint32_t> &list, int mode, double side)
{
	const bool turn = (dot(c.place.x, cross(c.place.y, c.place.z)) < 0) != (side < 0);
	const size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
	begin_round(b, c.position.count);
	spend(b, list.size());
	for (size_t k = 0; k + 2 < list.size(); k += step) {
		uint32_t i[3] = { list[k], list[k + 1], list[k + 2] };
		if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
			i[0] = list[0];
		const bool odd = mode == TINYGLTF_MODE_TRIANGLE_STRIP && k % 2 == 1;
		if (turn != odd)
			std::swap(i[1], i[2]);
		add_triangle(b, c, i, side);
	}
}

std::vector<uint32_t> indices_of(const tinygltf::Model &model, const tinygltf::Primitive &p, size_t vertices)
{
	const size_t most = 3 * static_cast<size_t>(OB_MESH_TRIANGLES_MAX);
	std::vector<uint32_t> out;
	if (p.indices < 0 && vertices > most)
		fail("it has more than " + std::to_string(OB_MESH_TRIANGLES_MAX) + " triangles");
	if (p.indices < 0) {
		for (size_t i = 0; i < vertices; i++)
			out.push_back(static_cast<uint32_t>(i));
		return out;
	}
	const numbers n = open(model, p.indices, "indices");
	if (n.parts != 1 || n.type == TINYGLTF_COMPONENT_TYPE_FLOAT || n.normalized)
		fail("it is damaged: its indices are no whole numbers");
	if (n.count > most)
		fail("it has more than " + std::to_string(OB_MESH_TRIANGLES_MAX) + " triangles");
	for (size_t i = 0; i < n.count; i++) {
		const double k = number(n, i, 0);
		if (!(k >= 0 && k < static_cast<double>(vertices)))
			fail("it is damaged: an index is that of no vertex");
		out.push_back(static_cast<uint32_t>(k));
	}
	return out;
}

numbers find(const tinygltf::Model &model, const tinygltf::Primitive &p, const char *name, const char *what, int least,
	     bool *there)
{
	const auto found = p.attributes.find(name);
	*there = found != p.attributes.end();
	if (!*there)
		return numbers();
	const numbers n = open(model, found->second, what);
	if (n.parts < least)
		fail(std::string("it is damaged: its ") + what + " are no vectors");
	return n;
}

void add_primitive(builder &out, const tinygltf::Model &model, const tinygltf::Primitive &p, const transform &place)
{
	const int mode = p.mode < 0 ? TINYGLTF_MODE_TRIANGLES : p.mode;
	corners c = {};
	bool there;
	spend(out, WORK_OF_PART);
	if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
	    mode != TINYGLTF_MODE_TRIANGLE_FAN)
		return; // points and lines
	c.position = find(model, p, "POSITION", "positions", 3, &there);
	if (!there)
		return;
	c.normal = find(model, p, "NORMAL", "normals", 3, &c.has_normal);
	c.colour = find(model, p, "COLOR_0", "colours", 3, &c.has_colour);
	c.look = paint_of(out, model, p);
	if (c.look.part.colour || c.look.part.surface)
		c.texture = find(model, p, ("TEXCOORD_" + std::to_string(c.look.where.set)).c_str(),
				 "texture coordinates", 2, &c.has_texture);
	if ((c.has_normal && c.normal.count < c.position.count) ||
	    (c.has_colour && c.colour.count < c.position.count) ||
	    (c.has_texture && c.texture.count < c.position.count))
		fail("it is damaged: it has more positions than normals, colours or texture coordinates");
	c.place = place;
	c.place_of_normal = of_normals(place);
	c.group = group_of(out, c.look.part);
	const std::vector<uint32_t> list = indices_of(model, p, c.position.count);
	add_triangles(out, c, list, mode, 1);
	if (p.material >= 0 && model.materials[static_cast<size_t>(p.material)].doubleSided)
		add_triangles(out, c, list, mode, -1);
}

std::vector<int> roots_of(const tinygltf::Model &model)
{
	if (!model.scenes.empty())
		return at(model.scenes, model.defaultScene < 0 ? 0 : model.defaultScene, "scene").nodes;
	std::vector<bool> child(model.nodes.size());
	for (const tinygltf::Node &n : model.nodes)
		for (int k : n.children)
			if (k >= 0 && static_cast<size_t>(k) < child.size())
				child[static_cast<size_t>(k)] = true;
	std::vector<int> roots;
	for (size_t i = 0; i < child.size(); i++)
		if (!child[i])
			roots.push_back(static_cast<int>(i));
	return roots;
}

// Adds each node once: nodes must form trees (glTF 2.0, 3.5.2), without a cycle.
void add_scene(builder &out, const tinygltf::Model &model)
{
	struct visit {
		int node;
		transform place;
	};
	std::vector<bool> seen(model.nodes.size());
	std::vector<visit> due;
	for (int root : roots_of(model))
		due.push_back({ root, upright });
	while (!due.empty()) {
		const visit now = due.back();
		due.pop_back();
		const tinygltf::Node &node = at(model.nodes, now.node, "node");
		if (seen[static_cast<size_t>(now.node)])
			fail("it is damaged: a node has two parents");
		seen[static_cast<size_t>(now.node)] = true;
		const transform place = after(now.place, of_node(node));
		if (node.mesh >= 0)
			for (const tinygltf::Primitive &p : at(model.meshes, node.mesh, "mesh").primitives)
				add_primitive(out, model, p, place);
		for (int child : node.children)
			due.push_back({ child, place });
	}
}

} // namespace

static bool read_gltf(ob_mesh *m, const unsigned char *bytes, size_t size, ob_error *e)
{
	try {
		tinygltf::Model model;
		builder out;
		parse(model, bytes, size);
		add_scene(out, model);
		move_to(out, m);
		return true;
	} catch (const fault &f) {
		ob_fail(e, "%s", f.text.c_str());
	} catch (const std::bad_alloc &) {
		ob_fail(e, "no memory for it");
	} catch (const std::exception &x) {
		ob_fail(e, "it is damaged: %s", x.what());
	}
	ob_mesh_finish(m);
	return false;
}

extern "C" {
OB_PART(ob_gltf_part) = { OB_PART_HEAD(ob_gltf_part), .read = read_gltf };
}
