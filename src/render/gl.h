// OpenGL 3.3 core, linked through GLVND (libOpenGL exports every core function).
#ifndef OB_RENDER_GL_H
#define OB_RENDER_GL_H

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#endif
