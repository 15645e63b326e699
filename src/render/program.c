#include "render/program.h"

#include <string.h>

#include "shaders.h"

typedef struct source {
	const char *name, *vertex, *fragment;
} source;

static const source sources[OB_PROGRAMS] = {
	[OB_PROGRAM_BODY] = { "body", shader_body_vert, shader_body_frag },
	[OB_PROGRAM_SUN] = { "sun", shader_sun_vert, shader_sun_frag },
	[OB_PROGRAM_COVER] = { "cover", shader_cover_vert, shader_cover_frag },
	[OB_PROGRAM_BLUR] = { "blur", shader_sky_vert, shader_blur_frag },
	[OB_PROGRAM_PLANE] = { "plane", shader_plane_vert, shader_plane_frag },
	[OB_PROGRAM_SKY] = { "sky", shader_sky_vert, shader_sky_frag },
	[OB_PROGRAM_SEGMENT] = { "segment", shader_segment_vert, shader_segment_frag },
};

// Mesa without a GPU: shaders then choose what is cheaper.
static bool software(void)
{
	const char *name = (const char *)glGetString(GL_RENDERER);
	return name && (strstr(name, "llvmpipe") || strstr(name, "softpipe"));
}

static bool compile(GLuint program, GLenum stage, const char *name, const char *text, ob_error *e)
{
	GLuint shader = glCreateShader(stage);
	GLint good = 0;
	// After #version, which must come first.
	const char *body = strchr(text, '\n') + 1;
	const char *const part[] = { text, software() ? "#define OB_SOFTWARE\n" : "", body };
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
	glUniform1i(glGetUniformLocation(program, "sun_depth"), OB_UNIT_SUN_DEPTH);
	glUniform1i(glGetUniformLocation(program, "contact_cover"), OB_UNIT_CONTACT_COVER);
	glUniform1i(glGetUniformLocation(program, "source"), OB_UNIT_SOURCE);
	return true;
}

bool ob_programs_create(GLuint program[OB_PROGRAMS], ob_error *e)
{
	for (int i = 0; i < OB_PROGRAMS; i++) {
		const source *s = &sources[i];
		program[i] = glCreateProgram();
		if (!compile(program[i], GL_VERTEX_SHADER, s->name, s->vertex, e) ||
		    !compile(program[i], GL_FRAGMENT_SHADER, s->name, s->fragment, e) ||
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
