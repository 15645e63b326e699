// OpenGL side of a frame (3.3 core, linked through GLVND: libOpenGL exports every core function): shader programs from
// shaders/*, embedded at build time; render targets; buffers, and the passes that draw from them. Needs a current
// context.
#ifndef OB_RENDER_PASSES_H
#define OB_RENDER_PASSES_H

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include "render/frame.h"
#include "render/render.h"

// ---- shader programs

typedef enum ob_program {
	OB_PROGRAM_BODY,
	OB_PROGRAM_MESH, // a body with a mesh of the scene
	OB_PROGRAM_TEXTURED, // the same, with images
	OB_PROGRAM_PATTERNED, // a box with a pattern
	OB_PROGRAM_SHADOW,
	OB_PROGRAM_SKY_SHADOW,
	OB_PROGRAM_OCCLUSION,
	OB_PROGRAM_BLUR,
	OB_PROGRAM_PLANE,
	OB_PROGRAM_FAR_PLANE, // without shadows
	OB_PROGRAM_PATTERNED_PLANE,
	OB_PROGRAM_FAR_PATTERNED_PLANE,
	OB_PROGRAM_SKY,
	OB_PROGRAM_SEGMENT,
	OB_PROGRAM_ADD,
	OB_PROGRAM_RESOLVE,
	OB_PROGRAM_SIGHT, // number and depth of bodies
	OB_PROGRAM_SIGHT_PLANE, // and of a plane
	OB_PROGRAMS,
} ob_program;

enum { // texture units
	OB_UNIT_SHADOW,
	OB_UNIT_OCCLUSION,
	OB_UNIT_SOURCE,
	OB_UNIT_PLAIN,
	OB_UNIT_SKY,
	OB_UNIT_COLOUR_IMAGE,
	OB_UNIT_SURFACE_IMAGE,
};

// Methods of lighting: see shaders/light.glsl.
typedef enum ob_light {
	OB_LIGHT_DRAFT,
	OB_LIGHT_AVERAGED,
	OB_LIGHT_WHOLE,
} ob_light;

// Method for this quality with this context's driver.
ob_light ob_light_choose(ob_quality quality);
int ob_light_sky_maps(ob_light light);

// Compiles and links all programs; the frame block is bound to uniform buffer 0. Needs a current context.
bool ob_programs_create(GLuint program[OB_PROGRAMS], ob_light light, ob_error *e);
void ob_programs_destroy(GLuint program[OB_PROGRAMS]);

// ---- render targets: colour (multisampled and plain; one picture and the sum), and the maps

typedef struct ob_targets {
	int width, height, samples;
	GLuint plain, multi; // framebuffers; multi = 0: draw into plain
	GLuint plain_colour, multi_colour, depth; // renderbuffers
	GLuint shadow, shadow_depth; // shadow map: framebuffer and depth texture
	GLuint plain_sampler; // reads the shadow map without comparison
	GLuint occlusion[2], occlusion_texture[2]; // occlusion map, and the intermediate target of its blur
	int sky_maps, sky_texels;
	GLuint sky, sky_depth; // framebuffer, and an array of depth textures
	GLuint one, one_colour, sum, sum_colour; // of averaged pictures: framebuffers and float textures; else 0
	GLuint sight, sight_pixels,
		sight_depth; // of camera sensors: framebuffer, and its renderbuffers; 0 until it is needed
} ob_targets;

// Creates the targets. samples is lowered to the driver's limit, and ignored for averaged pictures.
bool ob_targets_create(ob_targets *t, int width, int height, int samples, ob_light light, ob_error *e);
// Creates the target of numbers and depths, unless it is there.
bool ob_targets_add_sight(ob_targets *t, ob_error *e);
void ob_targets_destroy(ob_targets *t);

// ---- passes

// Buffers of a mesh of the scene.
typedef struct ob_look_buffers {
	const ob_mesh *mesh;
	GLuint array, vertices, indices;
	GLuint *image; // [mesh->images]: textures
} ob_look_buffers;

typedef struct ob_passes {
	GLuint program[OB_PROGRAMS];
	GLuint frame_block;
	GLuint body_array, vertices, indices, instances;
	GLuint segment_array, segments;
	GLuint empty_array; // for geometry made from gl_VertexID alone
	ob_mesh_range mesh[OB_MESHES];
	GLuint hull_array, hull_vertices;
	uint32_t hulls, known_hulls; // number in the snapshot, number uploaded
	uint64_t hulls_of; // the snapshot's ob_snapshot.created
	uint32_t *hull_first; // [hulls + 1]: first vertex of each, in hull_vertices
	uint32_t looks; // meshes of the scene
	ob_look_buffers *look; // [looks]
	GLuint white; // texture of parts without one
} ob_passes;

// mesh: the scene's, which must outlive p.
bool ob_passes_create(ob_passes *p, ob_light light, const ob_mesh *mesh, uint32_t meshes, ob_error *e);
void ob_passes_destroy(ob_passes *p);

// Builds meshes of the snapshot's hulls; returns false if memory runs out.
bool ob_passes_take_hulls(ob_passes *p, const ob_snapshot *s);
void ob_passes_begin(const ob_passes *p, const ob_frame_block *block);
// Draws the shadow map, from all casters.
void ob_passes_shadow_map(const ob_passes *p, const ob_targets *t, const ob_instances *casters);
// Draws the map of sky direction number `layer`, from all casters there.
void ob_passes_sky_map(const ob_passes *p, const ob_targets *t, int layer, const ob_instances *casters);
// Draws the occlusion map, from bodies near the ground.
void ob_passes_occlusion_map(const ob_passes *p, const ob_targets *t, const ob_instances *low);
// Draws the colour target, without overlays.
void ob_passes_colour(const ob_passes *p, const ob_targets *t, const ob_instances *seen, const ob_draw_list *b,
		      const ob_frame *f, const ob_look_def *look);
// Draws bodies through which what is behind them shines; after the colour.
void ob_passes_through(const ob_passes *p, const ob_instances *seen);
// Adds one of count averaged pictures to the sum; the first clears it.
void ob_passes_add(const ob_passes *p, const ob_targets *t, int number, int count);
// Writes the average to the colour target.
void ob_passes_resolve(const ob_passes *p, const ob_targets *t);
void ob_passes_overlay(const ob_passes *p, const ob_overlay *o, bool hidden_by_bodies);
// Draws number and depth of each pixel's middle, of exact instances and planes, and reads them: depth (m), number; without an
// object infinity and -1. The top row first.
void ob_passes_sight(const ob_passes *p, const ob_targets *t, const ob_instances *seen, const ob_draw_list *b,
		     const ob_frame *f, float (*sight)[2]);
// Reads the picture. rgba: width * height * 4 bytes, top row first
void ob_passes_read(const ob_targets *t, uint8_t *rgba);

#endif
