#include "render/context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEVICES_MAX = 32 };

// Attempts so far, as one line for the user.
typedef struct attempts {
	char text[800];
} attempts;

static bool note(attempts *tried, const char *name, const char *why)
{
	size_t used = strlen(tried->text);
	snprintf(tried->text + used, sizeof tried->text - used, "%s%s: %s", used ? "; " : "", name, why);
	return false;
}

static const char *egl_reason(void)
{
	switch (eglGetError()) {
	case EGL_NOT_INITIALIZED:
		return "no driver could be initialised";
	case EGL_BAD_ALLOC:
		return "out of resources";
	case EGL_BAD_MATCH:
	case EGL_BAD_CONFIG:
		return "the driver has no OpenGL 3.3 core";
	case EGL_BAD_ACCESS:
		return "access denied (is the user in the group render?)";
	default:
		return "refused by the driver";
	}
}

static bool has(const char *list, const char *extension)
{
	size_t n = strlen(extension);
	for (const char *at = list; at && (at = strstr(at, extension)); at += n)
		if ((at == list || at[-1] == ' ') && (at[n] == ' ' || at[n] == 0))
			return true;
	return false;
}

// All renderers of the process share a display, so it is never terminated.
static bool open_display(ob_context *c, EGLDisplay display, const char *name, attempts *tried)
{
	static const EGLint wanted[] = { EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE };
	static const EGLint version[] = { EGL_CONTEXT_MAJOR_VERSION,
					  3,
					  EGL_CONTEXT_MINOR_VERSION,
					  3,
					  EGL_CONTEXT_OPENGL_PROFILE_MASK,
					  EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
					  EGL_NONE };
	EGLConfig config;
	EGLint found = 0;
	if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL))
		return note(tried, name, egl_reason());
	if (!has(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context"))
		return note(tried, name, "the driver cannot draw without a surface");
	if (!eglBindAPI(EGL_OPENGL_API) || !eglChooseConfig(display, wanted, &config, 1, &found) || !found)
		return note(tried, name, "the driver has no desktop OpenGL");
	EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
	if (context == EGL_NO_CONTEXT)
		return note(tried, name, egl_reason());
	if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
		eglDestroyContext(display, context);
		return note(tried, name, egl_reason());
	}
	*c = (ob_context){ display, context };
	return true;
}

static bool try_surfaceless(ob_context *c, attempts *tried)
{
	if (!has(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_MESA_platform_surfaceless"))
		return note(tried, "surfaceless", "not offered by this EGL (Debian: libegl-mesa0, libgl1-mesa-dri)");
	EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
	return open_display(c, display, "surfaceless", tried);
}

// only = -1: any
static bool try_devices(ob_context *c, int only, attempts *tried)
{
	if (!has(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_EXT_platform_device"))
		return note(tried, "devices", "EGL_EXT_platform_device is not offered by this EGL");
	PFNEGLQUERYDEVICESEXTPROC query = (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
	EGLDeviceEXT device[DEVICES_MAX];
	EGLint count = 0;
	if (!query || !query(DEVICES_MAX, device, &count) || count == 0)
		return note(tried, "devices", "none found");
	for (int i = 0; i < count; i++) {
		char name[32];
		snprintf(name, sizeof name, "device %d", i);
		if ((only < 0 || only == i) &&
		    open_display(c, eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, device[i], NULL), name, tried))
			return true;
	}
	if (only >= count) {
		char why[64];
		snprintf(why, sizeof why, "there are only %d (0 to %d)", count, count - 1);
		note(tried, "devices", why);
	}
	return false;
}

bool ob_context_create(ob_context *c, const char *device, ob_error *e)
{
	attempts tried = { "" };
	bool surfaceless = !device || strcmp(device, "surfaceless") == 0;
	int only = -1;
	if (device && !surfaceless) {
		char *end;
		long number = strtol(device, &end, 10);
		if (end == device || *end || number < 0 || number >= DEVICES_MAX)
			return ob_fail(e, "GPU \"%s\": expected \"surfaceless\" or a number from 0 to %d", device,
				       DEVICES_MAX - 1);
		only = (int)number;
	}
	if (surfaceless && try_surfaceless(c, &tried))
		return true;
	if ((!device || only >= 0) && try_devices(c, only, &tried))
		return true;
	return ob_fail(e, "no way to draw off-screen; tried %s", tried.text);
}

bool ob_context_make_current(const ob_context *c, ob_error *e)
{
	if (eglGetCurrentContext() == c->context)
		return true;
	if (!eglBindAPI(EGL_OPENGL_API) || !eglMakeCurrent(c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, c->context))
		return ob_fail(e, "the OpenGL context cannot be used in this thread: another one draws with it");
	return true;
}

void ob_context_release(const ob_context *c)
{
	eglMakeCurrent(c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

void ob_context_destroy(ob_context *c)
{
	if (!c->context)
		return;
	ob_context_release(c);
	eglDestroyContext(c->display, c->context);
	c->context = NULL;
}
