// Shader programs; their sources are shaders/*, embedded at build time.
#ifndef OB_RENDER_PROGRAM_H
#define OB_RENDER_PROGRAM_H

#include <stdbool.h>

#include <ob/error.h>

#include "render/gl.h"

typedef enum ob_program {
	OB_PROGRAM_BODY,
	OB_PROGRAM_SUN,
	OB_PROGRAM_COVER,
	OB_PROGRAM_BLUR,
	OB_PROGRAM_PLANE,
	OB_PROGRAM_SKY,
	OB_PROGRAM_SEGMENT,
	OB_PROGRAMS,
} ob_program;

enum { OB_UNIT_SUN_DEPTH, OB_UNIT_CONTACT_COVER, OB_UNIT_SOURCE }; // texture units

// Compiles and links all programs; the frame block is bound to uniform buffer 0. A current context is needed.
bool ob_programs_create(GLuint program[OB_PROGRAMS], ob_error *e);
void ob_programs_destroy(GLuint program[OB_PROGRAMS]);

#endif
