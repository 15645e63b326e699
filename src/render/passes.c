#include "render/passes.h"

#include <stddef.h>
#include <string.h>

#include "shaders.h"

// ---- shader programs

typedef struct source {
	const char *name, *vertex, *fragment;
} source;

static const source sources[OB_PROGRAMS] = {
	[OB_PROGRAM_BODY] = { "body", shader_body_vert, shader_body_frag },
	[OB_PROGRAM_SHADOW] = { "shadow", shader_shadow_vert, shader_shadow_frag },
	[OB_PROGRAM_OCCLUSION] = { "occlusion", shader_occlusion_vert, shader_occlusion_frag },
	[OB_PROGRAM_BLUR] = { "blur", shader_sky_vert, shader_blur_frag },
	[OB_PROGRAM_PLANE] = { "plane", shader_plane_vert, shader_plane_frag },
	[OB_PROGRAM_SKY] = { "sky", shader_sky_vert, shader_sky_frag },
	[OB_PROGRAM_SEGMENT] = { "segment", shader_segment_vert, shader_segment_frag },
};

// Mesa without a GPU: shaders then choose what is cheaper.
static bool is_software_renderer(void)
{
	const char *name = (const char *)glGetString(GL_RENDERER);
	return name && (strstr(name, "llvmpipe") || strstr(name, "softpipe"));
}

static bool compile_shader(GLuint program, GLenum stage, const char *name, const char *text, ob_error *e)
{
	GLuint shader = glCreateShader(stage);
	GLint good = 0;
	// After #version, which must come first.
	const char *body = strchr(text, '\n') + 1;
	const char *const part[] = { text, is_software_renderer() ? "#define OB_SOFTWARE\n" : "", body };
	const GLint length[] = { (GLint)(body - text), -1, -1 };
	glShaderSource(shader, 3, part, length);
	glCompileShader(shader);
	glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
	if (!good) {
		char log[800] = "";
		glGetShaderInfoLog(shader, sizeof log, NULL, log);
		ob_fail(e, "shader %s (%s) does not compile: %s", name,
			stage == GL_VERTEX_SHADER ? "vertex" : "fragment", log);
	}
	glAttachShader(program, shader);
	glDeleteShader(shader); // lives on with the program
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
	return true;
}

bool ob_programs_create(GLuint program[OB_PROGRAMS], ob_error *e)
{
	for (int i = 0; i < OB_PROGRAMS; i++) {
		const source *s = &sources[i];
		program[i] = glCreateProgram();
		if (!compile_shader(program[i], GL_VERTEX_SHADER, s->name, s->vertex, e) ||
		    !compile_shader(program[i], GL_FRAGMENT_SHADER, s->name, s->fragment, e) ||
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

static bool create_maps(ob_targets *t, ob_error *e)
{
	t->shadow = create_framebuffer();
	t->shadow_depth = create_texture(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
					 OB_SHADOW_TEXELS);
	glDrawBuffer(GL_NONE);
	glReadBuffer(GL_NONE);
	if (!is_complete("shadow map", e))
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

bool ob_targets_create(ob_targets *t, int width, int height, int samples, ob_error *e)
{
	GLint most = 1, widest = 0;
	glGetIntegerv(GL_MAX_SAMPLES, &most);
	glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &widest);
	if (width > widest || height > widest)
		return ob_fail(e, "frames of %dx%d: this driver draws at most %dx%d", width, height, widest, widest);
	*t = (ob_targets){ .width = width, .height = height, .samples = samples < most ? samples : most };
	t->plain = create_framebuffer();
	t->plain_colour = create_renderbuffer(GL_COLOR_ATTACHMENT0, GL_RGBA8, t, 0);
	if (t->samples > 1) {
		if (!is_complete("colour target", e))
			return false;
		t->multi = create_framebuffer();
		t->multi_colour = create_renderbuffer(GL_COLOR_ATTACHMENT0, GL_RGBA8, t, t->samples);
	}
	t->depth = create_renderbuffer(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24, t, t->samples > 1 ? t->samples : 0);
	return is_complete("colour target", e) && create_maps(t, e);
}

void ob_targets_destroy(ob_targets *t)
{
	const GLuint framebuffers[] = { t->plain, t->multi, t->shadow, t->occlusion[0], t->occlusion[1] };
	const GLuint renderbuffers[] = { t->plain_colour, t->multi_colour, t->depth };
	const GLuint textures[] = { t->shadow_depth, t->occlusion_texture[0], t->occlusion_texture[1] };
	glDeleteFramebuffers(5, framebuffers); // zeros are ignored
	glDeleteRenderbuffers(3, renderbuffers);
	glDeleteTextures(3, textures);
}

// ---- passes

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

bool ob_passes_create(ob_passes *p, ob_error *e)
{
	*p = (ob_passes){ 0 };
	if (!ob_programs_create(p->program, e))
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
	glGenVertexArrays(1, &p->segment_array);
	glBindVertexArray(p->segment_array);
	glBindBuffer(GL_ARRAY_BUFFER, p->segments);
	set_attribute(0, 3, sizeof(ob_segment), offsetof(ob_segment, from), 1);
	set_attribute(1, 3, sizeof(ob_segment), offsetof(ob_segment, to), 1);
	set_attribute(2, 4, sizeof(ob_segment), offsetof(ob_segment, colour), 1);
	set_attribute(3, 1, sizeof(ob_segment), offsetof(ob_segment, width), 1);
	return true;
}

void ob_passes_destroy(ob_passes *p)
{
	const GLuint buffers[] = { p->frame_block, p->vertices, p->indices, p->instances, p->segments };
	const GLuint arrays[] = { p->body_array, p->segment_array, p->empty_array };
	ob_programs_destroy(p->program);
	glDeleteBuffers(5, buffers);
	glDeleteVertexArrays(3, arrays);
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
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(i->first[OB_MESHES] * sizeof *i->instance), i->instance,
		     GL_STREAM_DRAW);
}

// Draws what upload_instances has uploaded.
static void draw_instances(const ob_passes *p, const ob_instances *i)
{
	for (int k = 0; k < OB_MESHES; k++) {
		uint32_t first = i->first[k], count = i->first[k + 1] - first;
		size_t at = first * sizeof(ob_instance);
		if (!count)
			continue;
		set_attribute(2, 4, sizeof(ob_instance), at + offsetof(ob_instance, position_radius), 1);
		set_attribute(3, 4, sizeof(ob_instance), at + offsetof(ob_instance, attitude), 1);
		set_attribute(4, 4, sizeof(ob_instance), at + offsetof(ob_instance, core), 1);
		set_attribute(5, 4, sizeof(ob_instance), at + offsetof(ob_instance, colour), 1);
		glDrawElementsInstanced(GL_TRIANGLES, (GLsizei)p->mesh[k].index_count, GL_UNSIGNED_SHORT,
					(const void *)(p->mesh[k].index_first * sizeof(uint16_t)), (GLsizei)count);
	}
}

void ob_passes_shadow_map(const ob_passes *p, const ob_targets *t, const ob_instances *casters)
{
	upload_instances(p, casters);
	glBindFramebuffer(GL_FRAMEBUFFER, t->shadow);
	glViewport(0, 0, OB_SHADOW_TEXELS, OB_SHADOW_TEXELS);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LESS);
	glFrontFace(GL_CCW);
	glClear(GL_DEPTH_BUFFER_BIT);
	glEnable(GL_POLYGON_OFFSET_FILL);
	glPolygonOffset(shadow_slope, shadow_offset);
	glUseProgram(p->program[OB_PROGRAM_SHADOW]);
	draw_instances(p, casters);
	glDisable(GL_POLYGON_OFFSET_FILL);
}

static void blur_occlusion(const ob_passes *p, const ob_targets *t, int from, float x, float y)
{
	GLuint program = p->program[OB_PROGRAM_BLUR];
	glBindFramebuffer(GL_FRAMEBUFFER, t->occlusion[1 - from]);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_SOURCE);
	glBindTexture(GL_TEXTURE_2D, t->occlusion_texture[from]);
	glUseProgram(program);
	glUniform2f(glGetUniformLocation(program, "direction"), x / OB_OCCLUSION_TEXELS, y / OB_OCCLUSION_TEXELS);
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

// Seen from below, the nearest thing counts: the greatest occlusion.
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
	draw_instances(p, low);
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

// Coordinates in a map (column-major 4x4, from positions relative to the eye) of points of a plane, from their own.
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

// A square round the point of the plane that is nearest to the eye, as large as one can see.
static void draw_plane(GLuint program, const ob_pose *pose, const ob_frame *f, const float colour[3], bool ground,
		       bool grid)
{
	ob_mat3 r = ob_quat_matrix(pose->q);
	ob_vec3 n = ob_column(&r, 2), x = ob_column(&r, 0), y = ob_column(&r, 1), d = ob_sub(pose->p, f->view.eye);
	double height = -ob_dot(d, n);
	if (height <= 0)
		return; // from below there is nothing to see
	ob_vec3 foot = ob_scale(n, -height), on_plane = ob_sub(foot, d);
	set_vec3_uniform(program, "foot", foot);
	set_vec3_uniform(program, "normal", n);
	set_vec3_uniform(program, "axis_x", x);
	set_vec3_uniform(program, "axis_y", y);
	set_plane_to_map(program, "shadow_of", f->block.shadow_map, foot, x, y);
	set_plane_to_map(program, "occlusion_of", f->block.occlusion_map, foot, x, y);
	glUniform1f(glGetUniformLocation(program, "reach"), (float)f->view.far_plane);
	glUniform2f(glGetUniformLocation(program, "grid_foot"), (float)remainder(ob_dot(on_plane, x), 10),
		    (float)remainder(ob_dot(on_plane, y), 10));
	glUniform4f(glGetUniformLocation(program, "colour"), colour[0], colour[1], colour[2], grid);
	glUniform1f(glGetUniformLocation(program, "occlusion_share"), ground ? .75f : 0);
	glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

void ob_passes_colour(const ob_passes *p, const ob_targets *t, const ob_instances *seen, const ob_draw_list *b,
		      const ob_frame *f, const ob_look_def *look)
{
	glBindFramebuffer(GL_FRAMEBUFFER, t->multi ? t->multi : t->plain);
	glViewport(0, 0, t->width, t->height);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LEQUAL);
	glFrontFace(GL_CW); // the image is upside down: see ob_view_projection
	glClear(GL_DEPTH_BUFFER_BIT);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_SHADOW);
	glBindTexture(GL_TEXTURE_2D, t->shadow_depth);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_OCCLUSION);
	glBindTexture(GL_TEXTURE_2D, t->occlusion_texture[0]);
	upload_instances(p, seen);
	glUseProgram(p->program[OB_PROGRAM_BODY]);
	draw_instances(p, seen);
	glDisable(GL_CULL_FACE);
	glBindVertexArray(p->empty_array);
	glUseProgram(p->program[OB_PROGRAM_PLANE]);
	for (int i = 0; i < b->planes; i++) {
		bool ground = i == f->ground;
		draw_plane(p->program[OB_PROGRAM_PLANE], &b->plane[i], f,
			   ground ? look->ground_colour : b->now->passport[b->plane_id[i]].colour, ground,
			   ground && look->grid);
	}
	glUseProgram(p->program[OB_PROGRAM_SKY]);
	glDrawArrays(GL_TRIANGLES, 0, 3);
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
