#include "render/passes.h"

#include <stddef.h>

static const float shadow_slope = 1.6f, shadow_offset = 2; // glPolygonOffset: against acne on slopes

static void attribute(GLuint index, int size, size_t stride, size_t offset, GLuint divisor)
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
	attribute(0, 3, sizeof(ob_vertex), offsetof(ob_vertex, corner), 0);
	attribute(1, 3, sizeof(ob_vertex), offsetof(ob_vertex, normal), 0);
	glGenVertexArrays(1, &p->segment_array);
	glBindVertexArray(p->segment_array);
	glBindBuffer(GL_ARRAY_BUFFER, p->segments);
	attribute(0, 3, sizeof(ob_segment), offsetof(ob_segment, from), 1);
	attribute(1, 3, sizeof(ob_segment), offsetof(ob_segment, to), 1);
	attribute(2, 4, sizeof(ob_segment), offsetof(ob_segment, colour), 1);
	attribute(3, 1, sizeof(ob_segment), offsetof(ob_segment, width), 1);
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
		attribute(2, 4, sizeof(ob_instance), at + offsetof(ob_instance, position_radius), 1);
		attribute(3, 4, sizeof(ob_instance), at + offsetof(ob_instance, attitude), 1);
		attribute(4, 4, sizeof(ob_instance), at + offsetof(ob_instance, core), 1);
		attribute(5, 4, sizeof(ob_instance), at + offsetof(ob_instance, colour), 1);
		glDrawElementsInstanced(GL_TRIANGLES, (GLsizei)p->mesh[k].index_count, GL_UNSIGNED_SHORT,
					(const void *)(p->mesh[k].index_first * sizeof(uint16_t)), (GLsizei)count);
	}
}

void ob_passes_sun_map(const ob_passes *p, const ob_targets *t, const ob_instances *casters)
{
	upload_instances(p, casters);
	glBindFramebuffer(GL_FRAMEBUFFER, t->sun);
	glViewport(0, 0, OB_SUN_TEXELS, OB_SUN_TEXELS);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LESS);
	glFrontFace(GL_CCW);
	glClear(GL_DEPTH_BUFFER_BIT);
	glEnable(GL_POLYGON_OFFSET_FILL);
	glPolygonOffset(shadow_slope, shadow_offset);
	glUseProgram(p->program[OB_PROGRAM_SUN]);
	draw_instances(p, casters);
	glDisable(GL_POLYGON_OFFSET_FILL);
}

static void blur(const ob_passes *p, const ob_targets *t, int from, float x, float y)
{
	GLuint program = p->program[OB_PROGRAM_BLUR];
	glBindFramebuffer(GL_FRAMEBUFFER, t->cover[1 - from]);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_SOURCE);
	glBindTexture(GL_TEXTURE_2D, t->cover_texture[from]);
	glUseProgram(program);
	glUniform2f(glGetUniformLocation(program, "direction"), x / OB_CONTACT_TEXELS, y / OB_CONTACT_TEXELS);
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

// Seen from below, the nearest thing counts: the greatest cover.
void ob_passes_contact_map(const ob_passes *p, const ob_targets *t, const ob_instances *low)
{
	upload_instances(p, low);
	glBindFramebuffer(GL_FRAMEBUFFER, t->cover[0]);
	glViewport(0, 0, OB_CONTACT_TEXELS, OB_CONTACT_TEXELS);
	glDisable(GL_DEPTH_TEST);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT);
	glEnable(GL_BLEND);
	glBlendEquation(GL_MAX);
	glFrontFace(GL_CW); // undersides
	glUseProgram(p->program[OB_PROGRAM_COVER]);
	draw_instances(p, low);
	glBlendEquation(GL_FUNC_ADD);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
	glBindVertexArray(p->empty_array);
	blur(p, t, 0, 1, 0);
	blur(p, t, 1, 0, 1);
	glEnable(GL_CULL_FACE);
}

static void vector(GLuint program, const char *name, ob_vec3 v)
{
	glUniform3f(glGetUniformLocation(program, name), (float)v.x, (float)v.y, (float)v.z);
}

// Coordinates in a map (column-major 4x4, from positions relative to the eye) of points of a plane, from their own.
static void map_of_plane(GLuint program, const char *name, const float m[16], ob_vec3 foot, ob_vec3 x, ob_vec3 y)
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
	vector(program, "foot", foot);
	vector(program, "normal", n);
	vector(program, "axis_x", x);
	vector(program, "axis_y", y);
	map_of_plane(program, "sun_of", f->block.sun_map, foot, x, y);
	map_of_plane(program, "cover_of", f->block.contact_map, foot, x, y);
	glUniform1f(glGetUniformLocation(program, "reach"), (float)f->view.far_plane);
	glUniform2f(glGetUniformLocation(program, "grid_foot"), (float)remainder(ob_dot(on_plane, x), 10),
		    (float)remainder(ob_dot(on_plane, y), 10));
	glUniform4f(glGetUniformLocation(program, "colour"), colour[0], colour[1], colour[2], grid);
	glUniform1f(glGetUniformLocation(program, "cover_share"), ground ? .75f : 0);
	glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

void ob_passes_picture(const ob_passes *p, const ob_targets *t, const ob_instances *seen, const ob_bodies *b,
		       const ob_frame *f, const ob_look_def *look)
{
	glBindFramebuffer(GL_FRAMEBUFFER, t->multi ? t->multi : t->plain);
	glViewport(0, 0, t->width, t->height);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LEQUAL);
	glFrontFace(GL_CW); // the picture is upside down: see ob_view_projection
	glClear(GL_DEPTH_BUFFER_BIT);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_SUN_DEPTH);
	glBindTexture(GL_TEXTURE_2D, t->sun_depth);
	glActiveTexture(GL_TEXTURE0 + OB_UNIT_CONTACT_COVER);
	glBindTexture(GL_TEXTURE_2D, t->cover_texture[0]);
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
