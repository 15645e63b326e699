// Meshes for the look of objects, independent of their collision shapes: triangles, and the pictures on them, read from
// a binary glTF 2.0 file. Physics ignores them; the renderer and the viewer's page draw them from the same bytes.
//
// Thread-safety: one thread at a time per mesh; any number may read a mesh that no thread changes.
#ifndef OB_MESH_MESH_H
#define OB_MESH_MESH_H

#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>
#include <ob/motion.h>

enum {
	OB_MESH_FILE_MAX = 32 << 20, // bytes of a file
	OB_MESH_JSON_MAX = 512 << 10, // bytes of its JSON
	OB_MESH_VERTICES_MAX = 500000, // as drawn: each triangle without normals has three of its own
	OB_MESH_TRIANGLES_MAX = 500000,
	OB_MESH_PARTS_MAX = 255,
	OB_MESH_IMAGES_MAX = 255,
	OB_MESH_IMAGE_SIDE_MAX = 4096, // pixels
	OB_MESH_PIXELS_MAX = 8 << 20, // of all images of a mesh
};

// Layout of the shaders (shaders/instance.glsl), of files and of messages: little-endian. 48 bytes.
typedef struct ob_mesh_vertex {
	float position[3]; // m, body frame
	float normal[3]; // unit, outward
	float colour[3]; // linear RGB; below 0: the object's
	float surface; // roughness and metal (ob_surface_pack); below 0: the object's
	float texture[2]; // place in its images: 0, 0 is the upper left corner, 1, 1 the lower right one
} ob_mesh_vertex;

// Continuation of an image beyond its sides.
typedef enum ob_mesh_wrap { OB_MESH_REPEAT, OB_MESH_MIRROR, OB_MESH_CLAMP, OB_MESH_WRAPS } ob_mesh_wrap;

// Triangles that have the same images, whose values multiply those of the vertices. 8 bytes.
typedef struct ob_mesh_part {
	uint32_t indices; // after those of the parts before it
	uint8_t colour; // 1 + the number of an image in sRGB; 0: none
	uint8_t surface; // the same for an image whose green is roughness and whose blue is metal, both linear
	uint8_t wrap[2]; // ob_mesh_wrap, along an image's width and height
} ob_mesh_part;

typedef struct ob_mesh_image {
	uint32_t width, height;
	uint8_t *rgba; // [height][width][4], the top row first; alpha is not drawn
} ob_mesh_image;

typedef struct ob_mesh {
	uint32_t vertices, indices;
	ob_mesh_vertex *vertex; // [vertices]
	uint32_t *index; // [indices]: three a triangle, counterclockwise seen from outside
	uint32_t parts, images;
	ob_mesh_part *part; // [parts]: cover all of index; none: there are no images
	ob_mesh_image *image; // [images]
	double radius; // m, of a ball round the origin that holds the mesh
	uint64_t key; // hash of file name, scale and pose (ob_mesh_key); 0: not set
} ob_mesh;

// Packs both, from 0 to 1, as one number: 15 times the metal, whole, and then the roughness, below 1.
float ob_surface_pack(float roughness, float metal);

// Reads a binary glTF file: all triangles of its scene, placed by its nodes, in m. glTF's y, which points up, becomes
// z, and its z becomes -y. Reads no other file. false and e, which explains the error without the file's name; m needs
// no finish then.
bool ob_mesh_load(ob_mesh *m, const char *path, ob_error *e);
// The same for the bytes of a file.
bool ob_mesh_read(ob_mesh *m, const void *bytes, size_t size, ob_error *e);
// Scales the mesh, then rotates and moves it. false and e: a vertex lies more than 1000 km away.
bool ob_mesh_place(ob_mesh *m, double scale, ob_pose pose, ob_error *e);
// True if a mesh from outside is valid: counts within the limits, indices of vertices, parts, numbers. Sets the radius.
bool ob_mesh_makes_sense(ob_mesh *m);
// Identifies a mesh in a running universe: a hash of its source, never 0. The same in all programs.
uint64_t ob_mesh_key(const char *file, double scale, ob_pose pose);
size_t ob_mesh_bytes(const ob_mesh *m); // total size of its arrays
void ob_mesh_finish(ob_mesh *m);

#endif
