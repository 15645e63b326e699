#include "render/passes.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "shaders.h"

// ---- shader programs

typedef struct source {
	const char *name, *vertex, *fragment;
	const char *define; // NULL = no more
} source;

static const source sources[OB_PROGRAMS] = {
	[OB_PROGRAM_BODY] = { "body", shader_body_vert, shader_body_frag, NULL },
	[OB_PROGRAM_TEXTURED] = { "textured body", shader_body_vert, shader_body_frag,
				  "#define OB_TEXTURED\n#define OB_SOFT\n" },
	[OB_PROGRAM_MESH] = { "mesh", shader_body_vert, shader_body_frag, "#define OB_SOFT\n" },
	[OB_PROGRAM_PATTERNED] = { "patterned box", shader_body_vert, shader_body_frag, "#define OB_PATTERNED\n" },
	[OB_PROGRAM_SHADOW] = { "shadow", shader_shadow_vert, shader_shadow_frag, NULL },
	[OB_PROGRAM_SKY_SHADOW] = { "sky shadow", shader_sky_shadow_vert, shader_shadow_frag, NULL },
	[OB_PROGRAM_OCCLUSION] = { "occlusion", shader_occlusion_vert, shader_occlusion_frag, NULL },
	[OB_PROGRAM_BLUR] = { "blur", shader_sky_vert, shader_blur_frag, NULL },
	[OB_PROGRAM_PLANE] = { "plane", shader_plane_vert, shader_plane_frag, NULL },
	[OB_PROGRAM_FAR_PLANE] = { "far plane", shader_plane_vert, shader_plane_frag, "#define OB_FAR\n" },
	[OB_PROGRAM_PATTERNED_PLANE] = { "patterned plane", shader_plane_vert, shader_plane_frag,
					 "#define OB_PATTERNED\n" },
	[OB_PROGRAM_FAR_PATTERNED_PLANE] = { "far patterned plane", shader_plane_vert, shader_plane_frag,
					     "#define OB_FAR\n#define OB_PATTERNED\n" },
	[OB_PROGRAM_SKY] = { "sky", shader_sky_vert, shader_sky_frag, NULL },
	[OB_PROGRAM_SEGMENT] = { "segment", shader_segment_vert, shader_segment_frag, NULL },
	[OB_PROGRAM_ADD] = { "add", shader_sky_vert, shader_add_frag, NULL },
	[OB_PROGRAM_RESOLVE] = { "resolve", shader_sky_vert, shader_resolve_frag, NULL },
	[OB_PROGRAM_SIGHT] = { "sight", shader_sight_vert, shader_sight_frag, NULL },
	[OB_PROGRAM_SIGHT_PLANE] = { "sight of a plane", shader_sky_vert, shader_sight_frag, "#define OB_PLANE\n" },
};

// Mesa without a GPU: shaders then choose cheaper methods.
static bool is_software_renderer(void)
{
	const char *name = (const char *)glGetString(GL_RENDERER);
	return name && (strstr(name, "llvmpipe") || strstr(name, "softpipe"));
}

ob_light ob_light_choose(ob_quality quality)
{
	if (quality == OB_QUALITY_FINE)
		return OB_LIGHT_AVERAGED;
	return is_software_renderer() ? OB_LIGHT_DRAFT : OB_LIGHT_WHOLE;
}

int ob_light_sky_maps(ob_light light)
{
	return light == OB_LIGHT_DRAFT      ? 0
	       : light == OB_LIGHT_AVERAGED ? 4
					    : OB_SKY_MAPS_MAX; // as in shaders/light.glsl
}

static bool compile_shader(GLuint program, GLenum stage, const source *s, ob_light light, ob_error *e)
{
	const char *text = stage == GL_VERTEX_SHADER ? s->vertex : s->fragment;
	GLuint shader = glCreateShader(stage);
	GLint good = 0;
	// Inserts after #version, which must come first.
	const char *body = strchr(text, '\n') + 1;
	static const char *const define[] = { [OB_LIGHT_DRAFT] = "#define OB_DRAFT\n",
					      [OB_LIGHT_AVERAGED] = "#define OB_AVERAGED\n",
					      [OB_LIGHT_WHOLE] = "" };
	const char *const part[] = { text, define[light], s->define ? s->define : "", body };
	const GLint length[] = { (GLint)(body - text), -1, -1, -1 };
	glShaderSource(shader, 4, part, length);
	glCompileShader(shader);
	glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
	if (!good) {
		char log[800] = "";
		glGetShaderInfoLog(shader, sizeof log, NULL, log);
		ob_fail(e, "shader %s (%s) does not compile: %s", s->name,
			stage == GL_VERTEX_SHADER ? "vertex" : "fragment", log);
	}
	glAttachShader(program, shader);
	glDeleteShader(shader); // the program keeps it alive
	return good;
}

static bool link_program(GLuint program, const char *name, ob_error *e)
{
	GLint good = 0;
	glLinkProgram(program);
	glGetProgramiv(program, GL_LINK_STATUS, &good);
	if (!good) {
		char log[800] = "";
		glGetProgramInfoLog(program, sizeof log, NULL, log);
		return ob_fail(e, "shader %s does not link: %s", name, log);
	}
	GLuint block = glGetUniformBlockIndex(program, "Frame");
	if (block != GL_INVALID_INDEX)
		glUniformBlockBinding(program, block, 0);
	glUseProgram(program);
	glUniform1i(glGetUniformLocation(program, "shadow_depth"), OB_UNIT_SHADOW);
	glUniform1i(glGetUniformLocation(program, "occlusion"), OB_UNIT_OCCLUSION);
	glUniform1i(glGetUniformLocation(program, "source"), OB_UNIT_SOURCE);
	glUniform1i(glGetUniformLocation(program, "shadow_plain"), OB_UNIT_PLAIN);
	glUniform1i(glGetUniformLocation(program, "sky_depth"), OB_UNIT_SKY);
	glUniform1i(glGetUniformLocation(program, "colour_image"), OB_UNIT_COLOUR_IMAGE);
	glUniform1i(glGetUniformLocation(program, "surface_image"), OB_UNIT_SURFACE_IMAGE);
	return true;
}

bool ob_programs_create(GLuint program[OB_PROGRAMS], ob_light light, ob_error *e)
{
	for (int i = 0; i < OB_PROGRAMS; i++) {
		const source *s = &sources[i];
		program[i] = glCreateProgram();
		if (!compile_shader(program[i], GL_VERTEX_SHADER, s, light, e) ||
		    !compile_shader(program[i], GL_FRAGMENT_SHADER, s, light, e) ||
		    !link_program(program[i], s->name, e))
			return false;
	}
	return true;
}

void ob_programs_destroy(GLuint program[OB_PROGRAMS])
{
	for (int i = 0; i < OB_PROGRAMS; i++)
		glDeleteProgram(program[i]); // 0 is ignored
}

// ---- render targets

static GLuint create_renderbuffer(GLenum attachment, GLenum format, const ob_targets *t, int samples)
{
	GLuint id;
	glGenRenderbuffers(1, &id);
	glBindRenderbuffer(GL_RENDERBUFFER, id);
	glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, t->width, t->height);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, id);
	return id;
}

static GLuint create_texture(GLenum attachment, GLenum inner, GLenum format, GLenum type, int texels)
{
	GLuint id;
	bool depth = attachment == GL_DEPTH_ATTACHMENT;
	glGenTextures(1, &id);
	glBindTexture(GL_TEXTURE_2D, id);
	glTexImage2D(GL_TEXTURE_2D, 0, (GLint)inner, texels, texels, 0, format, type, NULL);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE); // the maps' margins are empty
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	if (depth) {
		glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
		glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
	}
	glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, id, 0);
	return id;
}

// Creates a float colour texture, as large as the frame.
static GLuint create_float_texture(GLenum inner, const ob_targets *t)
{
	GLuint id;
	glGenTextures(1, &id);
	glBindTexture(GL_TEXTURE_2D, id);
	glTexImage2D(GL_TEXTURE_2D, 0, (GLint)inner, t->width, t->height, 0, GL_RGBA, GL_FLOAT, NULL);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, id, 0);
	return id;
}

static GLuint create_framebuffer(void)
{
	GLuint id;
	glGenFramebuffers(1, &id);
	glBindFramebuffer(GL_FRAMEBUFFER, id);
	return id;
}

static bool is_complete(const char *name, ob_error *e)
{
	if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
		return true;
	return ob_fail(e, "the driver cannot draw into the %s (is there enough graphics memory?)", name);
}

static bool create_sky_maps(ob_targets *t, ob_error *e)
{
	t->sky = create_framebuffer();
	glGenTextures(1, &t->sky_depth);
	glBindTexture(GL_TEXTURE_2D_ARRAY, t->sky_depth);
	glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT16, t->sky_texels, t->sky_texels, t->sky_maps, 0,
		     GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, NULL);
	glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
	glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
	glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, t->sky_depth, 0, 0);
	glDrawBuffer(GL_NONE);
	glReadBuffer(GL_NONE);
	return is_complete("maps of the sky", e);
}

static bool create_maps(ob_targets *t, ob_error *e)
{
	t->shadow = create_framebuffer();
	t->shadow_depth = create_texture(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
					 OB_SHADOW_TEXELS);
	glDrawBuffer(GL_NONE);
	glReadBuffer(GL_NONE);
	if (!is_complete("shadow map", e))
		return false;
	glGenSamplers(1, &t->plain_sampler);
	glSamplerParameteri(t->plain_sampler, GL_TEXTURE_COMPARE_MODE, GL_NONE);
	glSamplerParameteri(t->plain_sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glSamplerParameteri(t->plain_sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glSamplerParameteri(t->plain_sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glSamplerParameteri(t->plain_sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	if (t->sky_maps > 0 && !create_sky_maps(t, e))
		return false;
	for (int i = 0; i < 2; i++) {
		t->occlusion[i] = create_framebuffer();
		t->occlusion_texture[i] =
			create_texture(GL_COLOR_ATTACHMENT0, GL_R8, GL_RED, GL_UNSIGNED_BYTE, OB_OCCLUSION_TEXELS);
		if (!is_complete("occlusion map", e))
			return false;
	}
	return true;
}

// Creates the textures of one picture and the sum; both use the depth of the plain colour target.
static bool create_sum(ob_targets *t, ob_error *e)
{
	t->one = create_framebuffer();
	t->one_colour = create_float_texture(GL_RGBA16F, t);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, t->depth);
	if (!is_complete("picture to average", e))
		return false;
	t->sum = create_framebuffer();
	t->sum_colour = create_float_texture(GL_RGBA32F, t);
	return is_complete("average of pictures", e);
}

bool ob_targets_add_sight(ob_targets *t, ob_error *e)
{
	if (t->sight)
		return true;
	t->sight = create_framebuffer();
	t->sight_pixels = create_renderbuffer(GL_COLOR_ATTACHMENT0, GL_RG32F, t, 0);
	t->sight_depth = create_renderbuffer(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT32F, t, 0);
	return is_complete("target of depths", e);
}

bool ob_targets_create(ob_targets *t, int width, int height, int samples, ob_light light, ob_error *e)
{
	GLint most = 1, widest = 0;
	glGetIntegerv(GL_MAX_SAMPLES, &most);
	glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &widest);
	if (width > widest || height > widest)
		return ob_fail(e, "frames of %dx%d: this driver draws at most %dx%d", width, height, widest, widest);
	*t = (ob_targets){
		.width = width,
		.height = height,
		.samples = light == OB_LIGHT_AVERAGED ? 1
			   : samples < most           ? samples
						      : most,
		.sky_maps = ob_light_sky_maps(light),
		.sky_texels = light == OB_LIGHT_AVERAGED ? 1024 : 512,
	};
	t->plain = create_framebuffer();
	t->plain_colour = create_renderbuffer(GL_COLOR_ATTACHMENT0, GL_RGBA8, t, 0);
	if (t->samples > 1) {
		if (!is_complete("colour target", e))
			return false;
		t->multi = create_framebuffer();
		t->multi_colour = create_renderbuffer(GL_COLOR_ATTACHMENT0, GL_RGBA8, t, t->samples);
	}
	t->depth = create_renderbuffer(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24, t, t->samples > 1 ? t->samples : 0);
	return is_complete("colour target", e) && (light != OB_LIGHT_AVERAGED || create_sum(t, e)) && create_maps(t, e);
}

void ob_targets_destroy(ob_targets *t)
{
	const GLuint framebuffers[] = { t->plain, t->multi, t->shadow, t->occlusion[0], t->occlusion[1],
					t->sky,   t->one,   t->sum,    t->sight };
	const GLuint renderbuffers[] = { t->plain_colour, t->multi_colour, t->depth, t->sight_pixels, t->sight_depth };
	const GLuint textures[] = { t->shadow_depth, t->occlusion_texture[0], t->occlusion_texture[1],
				    t->sky_depth,    t->one_colour,           t->sum_colour };
	glDeleteFramebuffers(9, framebuffers); // zeros are ignored
	glDeleteRenderbuffers(5, renderbuffers);
	glDeleteTextures(6, textures);
	glDeleteSamplers(1, &t->plain_sampler);
}

// ---- passes

static const float sensor_share = .35f; // a sensor's share of the light, before what is behind it
static const float shadow_slope = 1.6f, shadow_offset = 2; // glPolygonOffset: against acne on slopes

static void set_attribute(GLuint index, int size, size_t stride, size_t offset, GLuint divisor)
{
	glEnableVertexAttribArray(index);
	glVertexAttribPointer(index, size, GL_FLOAT, GL_FALSE, (GLsizei)stride, (const void *)offset);
	glVertexAttribDivisor(index, divisor);
}

static bool create_meshes(ob_passes *p, ob_error *e)
{
	ob_mesh_set set;
	bool built = ob_mesh_set_build(&set);
	if (built) {
		glBindBuffer(GL_ARRAY_BUFFER, p->vertices);
		glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(set.vertices * sizeof *set.vertex), set.vertex,
			     GL_STATIC_DRAW);
		glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, p->indices);
		glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(set.indices * sizeof *set.index), set.index,
			     GL_STATIC_DRAW);
		for (int k = 0; k < OB_MESHES; k++)
			p->mesh[k] = set.mesh[k];
	}
	ob_mesh_set_finish(&set);
	return built ? true : ob_fail(e, "out of memory");
}

// form: GL_SRGB8_ALPHA8 or GL_RGBA8. Mipmaps serve distant surfaces.
static GLuint create_image(const ob_mesh_image *image, GLint form)
{
	GLuint id;
	glGenTextures(1, &id);
	glBindTexture(GL_TEXTURE_2D, id);
	glTexImage2D(GL_TEXTURE_2D, 0, form, (GLsizei)image->width, (GLsizei)image->height, 0, GL_RGBA,
		     GL_UNSIGNED_BYTE, image->rgba);
	glGenerateMipmap(GL_TEXTURE_2D);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	return id;
}

static void create_images(ob_look_buffers *l)
{
	for (uint32_t i = 0; i < l->mesh->parts; i++) {
		const ob_mesh_part *p = &l->mesh->part[i];
		if (p->colour && !l->image[p->colour - 1])
			l->image[p->colour - 1] = create_image(&l->mesh->image[p->colour - 1], GL_SRGB8_ALPHA8);
		if (p->surface && !l->image[p->surface - 1])
			l->image[p->surface - 1] = create_image(&l->mesh->image[p->surface - 1], GL_RGBA8);
	}
}

static bool create_look(ob_look_buffers *l, const ob_mesh *m)
{
	l->mesh = m;
	l->image = calloc(m->images + 1, sizeof *l->image);
	if (!l->image)
		return false;
	create_images(l);
	glGenVertexArrays(1, &l->array);
	glGenBuffers(1, &l->vertices);
	glGenBuffers(1, &l->indices);
	glBindVertexArray(l->array);
	glBindBuffer(GL_ARRAY_BUFFER, l->vertices);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(m->vertices * sizeof *m->vertex), m->vertex, GL_STATIC_DRAW);
	set_attribute(0, 3, sizeof(ob_mesh_vertex), offsetof(ob_mesh_vertex, position), 0);
	set_attribute(1, 3, sizeof(ob_mesh_vertex), offsetof(ob_mesh_vertex, normal), 0);
	set_attribute(6, 4, sizeof(ob_mesh_vertex), offsetof(ob_mesh_vertex, colour), 0);
	set_attribute(7, 2, sizeof(ob_mesh_vertex), offsetof(ob_mesh_vertex, texture), 0);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, l->indices);
	glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(m->indices * sizeof *m->index), m->index, GL_STATIC_DRAW);
	return true;
}

static bool create_looks(ob_passes *p, const ob_mesh *mesh, uint32_t meshes)
{
	p->white = create_image(&(ob_mesh_image){ 1, 1, (uint8_t[]){ 255, 255, 255, 255 } }, GL_RGBA8);
	while (p->looks < meshes) {
		const uint32_t i = p->looks++;
		if (!create_look(&p->look[i], &mesh[i]))
			return false;
	}
	return true;
}

bool ob_passes_create(ob_passes *p, ob_light light, const ob_mesh *mesh, uint32_t meshes, ob_error *e)
{
	*p = (ob_passes){ .look = calloc(meshes + 1, sizeof *p->look) };
	if (!p->look)
		return ob_fail(e, "out of memory");
	if (!ob_programs_create(p->program, light, e))
		return false;
	glGenVertexArrays(1, &p->empty_array);
	glGenBuffers(1, &p->frame_block);
	glGenBuffers(1, &p->vertices);
	glGenBuffers(1, &p->indices);
	glGenBuffers(1, &p->instances);
	glGenBuffers(1, &p->segments);
	glGenVertexArrays(1, &p->body_array);
	glBindVertexArray(p->body_array);
	if (!create_meshes(p, e))
		return false;
	set_attribute(0, 3, sizeof(ob_vertex), offsetof(ob_vertex, corner), 0);
	set_attribute(1, 3, sizeof(ob_vertex), offsetof(ob_vertex, normal), 0);
	glGenBuffers(1, &p->hull_vertices);
	glGenVertexArrays(1, &p->hull_array);
	glBindVertexArray(p->hull_array);
	glBindBuffer(GL_ARRAY_BUFFER, p->hull_vertices);
	set_attribute(0, 3, sizeof(ob_vertex), offsetof(ob_vertex, corner), 0);
	set_attribute(1, 3, sizeof(ob_vertex), offsetof(ob_vertex, normal), 0);
	glGenVertexArrays(1, &p->segment_array);
	glBindVertexArray(p->segment_array);
	glBindBuffer(GL_ARRAY_BUFFER, p->segments);
	set_attribute(0, 3, sizeof(ob_segment), offsetof(ob_segment, from), 1);
	set_attribute(1, 3, sizeof(ob_segment), offsetof(ob_segment, to), 1);
	set_attribute(2, 4, sizeof(ob_segment), offsetof(ob_segment, colour), 1);
	set_attribute(3, 1, sizeof(ob_segment), offsetof(ob_segment, width), 1);
	return create_looks(p, mesh, meshes) || ob_fail(e, "out of memory");
}

void ob_passes_destroy(ob_passes *p)
{
	const GLuint buffers[] = {
		p->frame_block, p->vertices, p->indices, p->instances, p->segments, p->hull_vertices
	};
	const GLuint arrays[] = { p->body_array, p->segment_array, p->empty_array, p->hull_array };
	ob_programs_destroy(p->program);
	glDeleteBuffers(6, buffers);
	glDeleteVertexArrays(4, arrays);
	for (uint32_t i = 0; i < p->looks; i++) {
		glDeleteVertexArrays(1, &p->look[i].array);
		glDeleteBuffers(2, (const GLuint[]){ p->look[i].vertices, p->look[i].indices });
		if (p->look[i].image)
			glDeleteTextures((GLsizei)p->look[i].mesh->images, p->look[i].image);
		free(p->look[i].image);
	}
	glDeleteTextures(1, &p->white);
	free(p->look);
	free(p->hull_first);
}

static uint32_t known_hulls(const ob_snapshot *s)
{
	uint32_t known = 0;
	for (uint32_t i = 0; i < s->hulls; i++)
		known += s->hull[i] != NULL;
	return known;
}

// Makes the triangles of a hull, of a compound those of its parts; vertex NULL: none. Returns the number of vertices.
static uint32_t mesh_of(const ob_snapshot *s, uint32_t hull, ob_vertex *vertex)
{
	const ob_hull *h = s->hull[hull];
	uint32_t n = 0;
	if (!h || !h->parts)
		return h ? ob_mesh_of_hull(h, vertex) : 0;
	for (uint32_t i = hull + 1; i <= hull + h->parts && i < s->hulls; i++)
		n += s->hull[i] ? ob_mesh_of_hull(s->hull[i], vertex ? vertex + n : NULL) : 0;
	return n;
}

bool ob_passes_take_hulls(ob_passes *p, const ob_snapshot *s)
{
	const uint32_t known = known_hulls(s);
	if (p->hulls == s->hulls && p->known_hulls == known && p->hulls_of == s->created)
		return true;
	if (!OB_GROW(p->hull_first, s->hulls + 1))
		return false;
	uint32_t *first = p->hull_first, vertices = 0;
	for (uint32_t i = 0; i < s->hulls; i++) {
		first[i] = vertices;
		vertices += mesh_of(s, i, NULL);
	}
	first[s->hulls] = vertices;
	ob_vertex *vertex = malloc((vertices + 1) * sizeof *vertex);
	if (!vertex)
		return false;
	for (uint32_t i = 0; i < s->hulls; i++)
		mesh_of(s, i, vertex + first[i]);
	glBindBuffer(GL_ARRAY_BUFFER, p->hull_vertices);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(vertices * sizeof *vertex), vertex, GL_STATIC_DRAW);
	free(vertex);
	p->hulls = s->hulls, p->known_hulls = known, p->hulls_of = s->created;
	return true;
}

void ob_passes_begin(const ob_passes *p, const ob_frame_block *block)
{
	glBindBuffer(GL_UNIFORM_BUFFER, p->frame_block);
	glBufferData(GL_UNIFORM_BUFFER, sizeof *block, block, GL_STREAM_DRAW);
	glBindBufferBase(GL_UNIFORM_BUFFER, 0, p->frame_block);
	glEnable(GL_CULL_FACE);
	glDepthMask(GL_TRUE);
	glDisable(GL_BLEND);
}

static void upload_instances(const ob_passes *p, const ob_instances *i)
{
	glBindVertexArray(p->body_array);
	glBindBuffer(GL_ARRAY_BUFFER, p->instances);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(i->first[i->meshes] * sizeof *i->instance), i->instance,
		     GL_STREAM_DRAW);
}

// Points the instances' attributes at the data from "first" on.
static void set_instances(uint32_t first)
{
	const size_t at = first * sizeof(ob_instance);
	set_attribute(2, 4, sizeof(ob_instance), at + offsetof(ob_instance, position_radius), 1);
	set_attribute(3, 4, sizeof(ob_instance), at + offsetof(ob_instance, attitude), 1);
	set_attribute(4, 4, sizeof(ob_instance), at + offsetof(ob_instance, core), 1);
	set_attribute(5, 4, sizeof(ob_instance), at + offsetof(ob_instance, colour), 1);
}

static void draw_hulls(const ob_passes *p, const ob_instances *i)
{
	glBindVertexArray(p->hull_array);
	for (uint32_t hull = 0; hull < p->hulls; hull++) {
		const uint32_t *first = &i->first[OB_MESHES + hull], count = first[1] - first[0];
		if (!count)
			continue;
		set_instances(first[0]);
		glDrawArraysInstanced(GL_TRIANGLES, (GLint)p->hull_first[hull],
				      (GLsizei)(p->hull_first[hull + 1] - p->hull_first[hull]), (GLsizei)count);
	}
}

static void bind_image(GLenum unit, GLuint image, const uint8_t wrap[2])
{
	static const GLint modes[OB_MESH_WRAPS] = {
		[OB_MESH_REPEAT] = GL_REPEAT, [OB_MESH_MIRROR] = GL_MIRRORED_REPEAT, [OB_MESH_CLAMP] = GL_CLAMP_TO_EDGE
	};
	glActiveTexture(GL_TEXTURE0 + unit);
	glBindTexture(GL_TEXTURE_2D, image);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, modes[wrap[0]]);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, modes[wrap[1]]);
}

// Draws the parts of a mesh with images, each with its own.
static void draw_textured(const ob_passes *p, const ob_look_buffers *l, GLsizei count)
{
	size_t first = 0;
	glUseProgram(p->program[OB_PROGRAM_TEXTURED]);
	for (uint32_t i = 0; i < l->mesh->parts; i++) {
		const ob_mesh_part *part = &l->mesh->part[i];
		bind_image(OB_UNIT_COLOUR_IMAGE, part->colour ? l->image[part->colour - 1] : p->white, part->wrap);
		bind_image(OB_UNIT_SURFACE_IMAGE, part->surface ? l->image[part->surface - 1] : p->white, part->wrap);
		glDrawElementsInstanced(GL_TRIANGLES, (GLsizei)part->indices, GL_UNSIGNED_INT,
					(const void *)(first * sizeof(uint32_t)), count);
		first += part->indices;
	}
	glUseProgram(p->program[OB_PROGRAM_MESH]);
}

static void draw_looks(const ob_passes *p, const ob_instances *i, bool in_colour)
{
	if (in_colour)
		glUseProgram(p->program[OB_PROGRAM_MESH]);
	for (uint32_t k = 0; k < p->looks; k++) {
		const uint32_t *first = &i->first[OB_MESHES + p->hulls + k], count = first[1] - first[0];
		if (!count)
			continue;
		glBindVertexArray(p->look[k].array);
		set_instances(first[0]);
		if (in_colour && p->look[k].mesh->parts)
			draw_textured(p, &p->look[k], (GLsizei)count);
		else
			glDrawElementsInstanced(GL_TRIANGLES, (GLsizei)p->look[k].mesh->indices, GL_UNSIGNED_INT, NULL,
						(GLsizei)count);
	}
}

// Draws the instances uploaded by upload_instances. in_colour: with the programs for bodies, else with the present one.
static void draw_instances(const ob_passes *p, const ob_instances *i, bool in_colour)
{
	for (uint32_t k = 0; k < OB_MESHES; k++) {
		uint32_t first = i->first[k], count = i->first[k + 1] - first;
		if (!count)
			continue;
		set_instances(first);
		if (in_colour)
			glUseProgram(p->program[k == OB_MESH_PATTERNED_BOX ? OB_PROGRAM_PATTERNED : OB_PROGRAM_BODY]);
		glDrawElementsInstanced(GL_TRIANGLES, (GLsizei)p->mesh[k].index_count, GL_UNSIGNED_SHORT,
					(const void *)(p->mesh[k].index_first * sizeof(uint16_t)), (GLsizei)count);
	}
	if (i->first[i->meshes] > i->first[OB_MESHES]) {
		if (in_colour)
			glUseProgram(p->program[OB_PROGRAM_BODY]);
		draw_hulls(p, i);
		draw_looks(p, i, in_colour);
	}
}

static void draw_depth(const ob_passes *p, ob_program program, const ob_instances *casters, int texels)
{
	upload_instances(p, casters);
	glViewport(0, 0, texels, texels);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LESS);
	glFrontFace(GL_CCW);
	glClear(GL_DEPTH_BUFFER_BIT);
	glEnable(GL_POLYGON_OFFSET_FILL);
	glPolygonOffset(shadow_slope, shadow_offset);
	glUseProgram(p->program[program]);
	draw_instances(p, casters, false);
	glDisable(GL_POLYGON_OFFSET_FILL);
}

void ob_passes_shadow_map(const ob_passes *p, const ob_targets *t, const ob_instances *casters)
{
	glBindFramebuffer(GL_FRAMEBUFFER, t->shadow);
	draw_depth(p, OB_PROGRAM_SHADOW, casters, OB_SHADOW_TEXELS);
}

void ob_passes_sky_map(const ob_passes *p, const ob_targets *t, int layer, const ob_instances *casters)
{
	GLuint program = p->program[OB_PROGRAM_SKY_SHADOW];
	glBindFramebuffer(GL_FRAMEBUFFER, t->sky);
	glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, t->sky_depth, 0, layer);
	glUseProgram(program);
	glUniform1i(glGetUniformLocation(program, "layer"), layer);
	draw_depth(p, OB_PROGRAM_SKY_SHADOW, casters, t->sky_texels);
}

static void blur_occlusion(const ob_passes *p, const ob_targets *t, int from, float x, float y)
{
	GLuint program = p->program[OB_PROGRAM_BLUR];
	glBindFramebuffer(GL_FRAMEBUFFER, t->occlusion[1 - from]);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_SOURCE);
	glBindTexture(GL_TEXTURE_2D, t->occlusion_texture[from]);
	glUseProgram(program);
	glUniform2f(glGetUniformLocation(program, "direction"), .5f * x / OB_OCCLUSION_TEXELS,
		    .5f * y / OB_OCCLUSION_TEXELS);
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

// Seen from below, the nearest surface counts: the greatest occlusion.
void ob_passes_occlusion_map(const ob_passes *p, const ob_targets *t, const ob_instances *low)
{
	upload_instances(p, low);
	glBindFramebuffer(GL_FRAMEBUFFER, t->occlusion[0]);
	glViewport(0, 0, OB_OCCLUSION_TEXELS, OB_OCCLUSION_TEXELS);
	glDisable(GL_DEPTH_TEST);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT);
	glEnable(GL_BLEND);
	glBlendEquation(GL_MAX);
	glFrontFace(GL_CW); // undersides
	glUseProgram(p->program[OB_PROGRAM_OCCLUSION]);
	draw_instances(p, low, false);
	glBlendEquation(GL_FUNC_ADD);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
	glBindVertexArray(p->empty_array);
	blur_occlusion(p, t, 0, 1, 0);
	blur_occlusion(p, t, 1, 0, 1);
	glEnable(GL_CULL_FACE);
}

static void set_vec3_uniform(GLuint program, const char *name, ob_vec3 v)
{
	glUniform3f(glGetUniformLocation(program, name), (float)v.x, (float)v.y, (float)v.z);
}

// Sets the matrix from a plane's own coordinates to coordinates in a map (column-major 4x4, from positions relative to
// the eye).
static void set_plane_to_map(GLuint program, const char *name, const float m[16], ob_vec3 foot, ob_vec3 x, ob_vec3 y)
{
	const ob_vec3 from[3] = { x, y, foot };
	float to[9];
	for (int column = 0; column < 3; column++)
		for (int row = 0; row < 3; row++)
			to[3 * column + row] = (float)(m[row] * from[column].x + m[4 + row] * from[column].y +
						       m[8 + row] * from[column].z + (column == 2 ? m[12 + row] : 0));
	glUniformMatrix3fv(glGetUniformLocation(program, name), 1, GL_FALSE, to);
}

// Part of the plane on which casters in the shadow map can cast shadows: low x, low y, high x, high y, m from the foot
// along the plane's axes, within reach.
static void find_patch(const ob_frame *f, ob_vec3 foot, ob_vec3 n, ob_vec3 x, ob_vec3 y, float patch[4])
{
	const ob_ortho *m = &f->shadow;
	float reach = (float)f->view.far_plane;
	double slope = ob_dot(m->z, n);
	bool grazes = slope < .02;
	patch[0] = patch[1] = grazes ? -reach : reach;
	patch[2] = patch[3] = -patch[0];
	for (int corner = 0; corner < 4 && !grazes; corner++) {
		ob_vec3 p = ob_scale(m->x, m->centre_x + (corner & 1 ? m->half_x : -m->half_x));
		p = ob_madd(p, m->centre_y + (corner & 2 ? m->half_y : -m->half_y), m->y);
		p = ob_sub(p, ob_add(f->view.eye, foot));
		p = ob_madd(p, -ob_dot(p, n) / slope, m->z);
		float at_x = (float)ob_dot(p, x), at_y = (float)ob_dot(p, y);
		patch[0] = fminf(patch[0], at_x);
		patch[1] = fminf(patch[1], at_y);
		patch[2] = fmaxf(patch[2], at_x);
		patch[3] = fmaxf(patch[3], at_y);
	}
	for (int i = 0; i < 4; i++)
		patch[i] = fmaxf(-reach, fminf(reach, patch[i]));
}

static const double grid_period = 10, pattern_period = 768; // m; as in shaders/pattern.glsl

// ink: 1 with the grid, or the pattern.
static void draw_plane(GLuint program, const ob_pose *pose, const ob_frame *f, const float colour[3], bool ground,
		       float ink, double period, bool far)
{
	ob_mat3 r = ob_quat_matrix(pose->q);
	ob_vec3 n = ob_column(&r, 2), x = ob_column(&r, 0), y = ob_column(&r, 1), d = ob_sub(pose->p, f->view.eye);
	double height = -ob_dot(d, n);
	if (height <= 0)
		return; // invisible from below
	ob_vec3 foot = ob_scale(n, -height), on_plane = ob_sub(foot, d);
	float patch[4];
	find_patch(f, foot, n, x, y, patch);
	glUseProgram(program);
	set_vec3_uniform(program, "foot", foot);
	set_vec3_uniform(program, "normal", n);
	set_vec3_uniform(program, "axis_x", x);
	set_vec3_uniform(program, "axis_y", y);
	set_plane_to_map(program, "shadow_of", f->block.shadow_map, foot, x, y);
	set_plane_to_map(program, "occlusion_of", f->block.occlusion_map, foot, x, y);
	glUniform4fv(glGetUniformLocation(program, "patch_ends"), 1, patch);
	glUniform1f(glGetUniformLocation(program, "reach"), (float)f->view.far_plane);
	glUniform2f(glGetUniformLocation(program, "grid_foot"), (float)remainder(ob_dot(on_plane, x), period),
		    (float)remainder(ob_dot(on_plane, y), period));
	glUniform4f(glGetUniformLocation(program, "colour"), colour[0], colour[1], colour[2], ink);
	glUniform1f(glGetUniformLocation(program, "occlusion_share"), ground ? .75f : 0);
	glDrawArrays(GL_TRIANGLE_STRIP, 0, far ? 10 : 4);
}

static const double level_enough = 1e-6; // rise of the view's axis to the right

// Above a level ground, draws the sky only in the rows from its horizon on: llvmpipe shades hidden pixels, too.
static void draw_sky(const ob_passes *p, const ob_targets *t, const ob_frame *f, const ob_draw_list *b)
{
	int rows = t->height;
	double height = f->ground >= 0 ? f->view.eye.z - b->plane[f->ground].p.z : 0;
	if (height > 0 && fabs(f->view.right.z) < level_enough) {
		double longest = sqrt(1 + f->view.tan_x * f->view.tan_x + f->view.tan_y * f->view.tan_y);
		double lowest =
			-1.1 * longest * height / f->view.far_plane; // slope of a ray that just passes the ground's end
		double up = -f->block.ray_up[2]; // rows run down
		double end = ceil(.5 * t->height * (1 + (f->view.forward.z - lowest) / up));
		rows = (int)fmax(0, fmin(t->height, end));
	}
	glEnable(GL_SCISSOR_TEST);
	glScissor(0, 0, t->width, rows);
	glUseProgram(p->program[OB_PROGRAM_SKY]);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glDisable(GL_SCISSOR_TEST);
}

void ob_passes_colour(const ob_passes *p, const ob_targets *t, const ob_instances *seen, const ob_draw_list *b,
		      const ob_frame *f, const ob_look_def *look)
{
	glBindFramebuffer(GL_FRAMEBUFFER, t->one ? t->one : t->multi ? t->multi : t->plain);
	glViewport(0, 0, t->width, t->height);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LEQUAL);
	glFrontFace(GL_CW); // the image is upside down: see ob_view_projection
	glClear(GL_DEPTH_BUFFER_BIT);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_SHADOW);
	glBindTexture(GL_TEXTURE_2D, t->shadow_depth);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_PLAIN);
	glBindTexture(GL_TEXTURE_2D, t->shadow_depth);
	glBindSampler(OB_UNIT_PLAIN, t->plain_sampler);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_SKY);
	glBindTexture(GL_TEXTURE_2D_ARRAY, t->sky_depth);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_OCCLUSION);
	glBindTexture(GL_TEXTURE_2D, t->occlusion_texture[0]);
	upload_instances(p, seen);
	draw_instances(p, seen, true);
	glDisable(GL_CULL_FACE);
	glBindVertexArray(p->empty_array);
	for (int i = 0; i < 2 * b->planes; i++) {
		int plane = i / 2;
		bool ground = plane == f->ground, far = i % 2;
		const ob_passport *pass = &b->now->passport[b->plane_id[plane]];
		const ob_pattern pattern = ob_passport_pattern(pass);
		const ob_program program = pattern ? far ? OB_PROGRAM_FAR_PATTERNED_PLANE : OB_PROGRAM_PATTERNED_PLANE
					   : far   ? OB_PROGRAM_FAR_PLANE
						   : OB_PROGRAM_PLANE;
		draw_plane(p->program[program], &b->plane[plane], f, ground ? look->ground_colour : pass->colour,
			   ground, pattern ? (float)pattern : ground && look->grid,
			   pattern ? pattern_period : grid_period, far);
	}
	draw_sky(p, t, f, b);
}

void ob_passes_through(const ob_passes *p, const ob_instances *seen)
{
	upload_instances(p, seen);
	glEnable(GL_CULL_FACE);
	glEnable(GL_BLEND);
	glBlendColor(0, 0, 0, sensor_share);
	glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
	glDepthMask(GL_FALSE);
	draw_instances(p, seen, true);
	glDepthMask(GL_TRUE);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
}

void ob_passes_add(const ob_passes *p, const ob_targets *t, int number, int count)
{
	GLuint program = p->program[OB_PROGRAM_ADD];
	glBindFramebuffer(GL_FRAMEBUFFER, t->sum);
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_CULL_FACE);
	if (number > 0) {
		glEnable(GL_BLEND);
		glBlendFunc(GL_ONE, GL_ONE);
	}
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_SOURCE);
	glBindTexture(GL_TEXTURE_2D, t->one_colour);
	glBindVertexArray(p->empty_array);
	glUseProgram(program);
	glUniform1f(glGetUniformLocation(program, "share"), 1.f / (float)count);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glDisable(GL_BLEND);
}

void ob_passes_resolve(const ob_passes *p, const ob_targets *t)
{
	glBindFramebuffer(GL_FRAMEBUFFER, t->plain);
	glDisable(GL_DEPTH_TEST);
	glDepthMask(GL_FALSE); // the depth of the last picture hides overlays
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_SOURCE);
	glBindTexture(GL_TEXTURE_2D, t->sum_colour);
	glBindVertexArray(p->empty_array);
	glUseProgram(p->program[OB_PROGRAM_RESOLVE]);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glDepthMask(GL_TRUE);
	glEnable(GL_DEPTH_TEST);
}

void ob_passes_overlay(const ob_passes *p, const ob_overlay *o, bool hidden_by_bodies)
{
	glBindVertexArray(p->segment_array);
	glBindBuffer(GL_ARRAY_BUFFER, p->segments);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(o->count * sizeof *o->segment), o->segment, GL_STREAM_DRAW);
	glDepthMask(GL_FALSE);
	if (!hidden_by_bodies)
		glDisable(GL_DEPTH_TEST);
	glEnable(GL_BLEND);
	glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
	glUseProgram(p->program[OB_PROGRAM_SEGMENT]);
	glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)o->count);
	glDepthMask(GL_TRUE);
}

void ob_passes_sight(const ob_passes *p, const ob_targets *t, const ob_instances *seen, const ob_draw_list *b,
		     const ob_frame *f, float (*sight)[2])
{
	const GLuint program = p->program[OB_PROGRAM_SIGHT_PLANE];
	glBindFramebuffer(GL_FRAMEBUFFER, t->sight);
	glViewport(0, 0, t->width, t->height);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LEQUAL);
	glEnable(GL_CULL_FACE);
	glFrontFace(GL_CW);
	glClearBufferfv(GL_COLOR, 0, (const GLfloat[]){ INFINITY, -1, 0, 0 });
	glClear(GL_DEPTH_BUFFER_BIT);
	upload_instances(p, seen);
	glUseProgram(p->program[OB_PROGRAM_SIGHT]);
	draw_instances(p, seen, false);
	glDisable(GL_CULL_FACE);
	glBindVertexArray(p->empty_array);
	glUseProgram(program);
	for (int i = 0; i < b->planes; i++) {
		const ob_mat3 r = ob_quat_matrix(b->plane[i].q);
		const ob_vec3 n = ob_column(&r, 2);
		const double height = ob_dot(ob_sub(f->view.eye, b->plane[i].p), n);
		set_vec3_uniform(program, "foot", ob_scale(n, -height));
		set_vec3_uniform(program, "normal", n);
		glUniform1f(glGetUniformLocation(program, "number"), (float)b->plane_id[i]);
		glUniform1f(glGetUniformLocation(program, "reach"), (float)f->view.far_plane);
		if (height > 0)
			glDrawArrays(GL_TRIANGLES, 0, 3);
	}
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, t->width, t->height, GL_RG, GL_FLOAT, sight);
}

void ob_passes_read(const ob_targets *t, uint8_t *rgba)
{
	if (t->multi) {
		glBindFramebuffer(GL_READ_FRAMEBUFFER, t->multi);
		glBindFramebuffer(GL_DRAW_FRAMEBUFFER, t->plain);
		glBlitFramebuffer(0, 0, t->width, t->height, 0, 0, t->width, t->height, GL_COLOR_BUFFER_BIT,
				  GL_NEAREST);
	}
	glBindFramebuffer(GL_READ_FRAMEBUFFER, t->plain);
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, t->width, t->height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}
