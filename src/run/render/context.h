// An OpenGL context without a window.
#ifndef OB_RENDER_CONTEXT_H
#define OB_RENDER_CONTEXT_H

#include <stdbool.h>

#include <ob/error.h>

typedef struct ob_context {
	void *display, *context; // EGLDisplay, EGLContext
} ob_context;

// Creates a context, which becomes current. device as in ob_render_setup; e lists every platform that was tried and why
// it failed.
bool ob_context_create(ob_context *c, const char *device, ob_error *e);
bool ob_context_make_current(const ob_context *c, ob_error *e);
// Lets another thread make it current.
void ob_context_release(const ob_context *c);
void ob_context_destroy(ob_context *c);

#endif
