#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <ob/error.h>

#include "render/part.h"
#include "render/passes.h"
#include "render/smooth.h"

// ---- context

// An OpenGL context without a window.

typedef struct ob_context {
	void *display, *context; // EGLDisplay, EGLContext
} ob_context;

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

// Creates a context, which becomes current. device as in ob_render_setup; e lists every platform that was tried and why
// it failed.
static bool context_create(ob_context *c, const char *device, ob_error *e)
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

static bool context_make_current(const ob_context *c, ob_error *e)
{
	if (eglGetCurrentContext() == c->context)
		return true;
	if (!eglBindAPI(EGL_OPENGL_API) || !eglMakeCurrent(c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, c->context))
		return ob_fail(e, "the OpenGL context cannot be used in this thread: another one draws with it");
	return true;
}

// Lets another thread make it current.
static void context_release(const ob_context *c)
{
	eglMakeCurrent(c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

static void context_destroy(ob_context *c)
{
	if (!c->context)
		return;
	context_release(c);
	eglDestroyContext(c->display, c->context);
	c->context = NULL;
}

// ---- renderer

enum { SAMPLES = 4 }; // a pixel, on a GPU, unless the setup says how many
// Renderers of a process take turns: contexts that draw side by side have crashed Mesa's software driver (22.3).
static pthread_mutex_t turn = PTHREAD_MUTEX_INITIALIZER;
static const double occlusion_height = .8; // m above the ground, up to which a body occludes it

struct ob_renderer {
	ob_renderer_base base;
	ob_render_setup setup;
	ob_look_def look;
	ob_context context;
	ob_targets targets;
	ob_passes passes;
	ob_draw_list list;
	ob_light light;
	ob_instances casters, near_ground, visible, exact;
	ob_overlay overlay;
	uint8_t *rough, *brightness; // a picture before its edges are smoothed; NULL: they are not
	uint8_t *rgba; // a camera sensor's picture, and
	float (*sight)[2]; // its depths and numbers; NULL until there is one
};

static void finish(ob_renderer *r)
{
	if (r->context.context && context_make_current(&r->context, NULL)) {
		ob_passes_destroy(&r->passes);
		ob_targets_destroy(&r->targets);
	}
	context_destroy(&r->context);
	ob_draw_list_finish(&r->list);
	ob_instances_finish(&r->casters);
	ob_instances_finish(&r->near_ground);
	ob_instances_finish(&r->visible);
	ob_instances_finish(&r->exact);
	ob_overlay_finish(&r->overlay);
	free(r->rgba);
	free(r->sight);
	free(r->rough);
	free(r->brightness);
	free(r);
}

// Gets memory to smooth edges, where no GPU takes several samples a pixel.
static bool prepare_samples(ob_renderer *r, ob_error *e)
{
	const size_t pixels = (size_t)r->setup.width * (size_t)r->setup.height;
	if (r->setup.samples > 0)
		return true;
	r->setup.samples = r->light == OB_LIGHT_DRAFT ? 1 : SAMPLES;
	if (r->light != OB_LIGHT_DRAFT)
		return true;
	r->rough = malloc(4 * pixels);
	r->brightness = malloc(pixels);
	return (r->rough && r->brightness) || ob_fail(e, "out of memory");
}

static ob_renderer *start(const ob_render_setup *setup, const ob_look_def *look, ob_error *e)
{
	if (setup->width < 1 || setup->height < 1 || setup->samples < 0) {
		ob_fail(e, "frames of %dx%d with %d samples: expected at least 1x1, and no less than 0 samples",
			setup->width, setup->height, setup->samples);
		return NULL;
	}
	ob_renderer *r = calloc(1, sizeof *r);
	if (!r) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	r->setup = *setup;
	r->look = *look;
	if (context_create(&r->context, setup->device, e)) {
		r->light = ob_light_choose(setup->quality);
		if (prepare_samples(r, e) &&
		    ob_targets_create(&r->targets, setup->width, setup->height, r->setup.samples, r->light, e) &&
		    ob_passes_create(&r->passes, r->light, setup->mesh, setup->meshes, e)) {
			r->list.mesh = setup->mesh;
			r->list.meshes = setup->meshes;
			r->list.colouring = setup->colouring;
			r->exact.exact = true;
			context_release(&r->context);
			return r;
		}
	}
	finish(r);
	return NULL;
}

static ob_renderer *create(const ob_render_setup *setup, const ob_look_def *look, ob_error *e)
{
	pthread_mutex_lock(&turn);
	ob_renderer *r = start(setup, look, e);
	pthread_mutex_unlock(&turn);
	return r;
}

static void destroy(ob_renderer *r)
{
	pthread_mutex_lock(&turn);
	if (r)
		finish(r);
	pthread_mutex_unlock(&turn);
}

static bool casts_shadow(const ob_draw_item *body, const void *ortho)
{
	return body->drawn == OB_DRAWN_SOLID && ob_ortho_contains(ortho, body);
}

static bool is_near_ground(const ob_draw_item *body, const void *frame)
{
	const ob_frame *f = frame;
	return body->drawn == OB_DRAWN_SOLID &&
	       ob_dot(body->pose.p, f->occlusion.z) - body->radius < f->level + occlusion_height &&
	       ob_ortho_contains(&f->occlusion, body);
}

static bool is_visible(const ob_draw_item *body, const void *view)
{
	return body->drawn == OB_DRAWN_SOLID && ob_view_in_frustum(view, body->pose.p, body->radius);
}

static bool is_seen_through(const ob_draw_item *body, const void *view)
{
	return body->drawn == OB_DRAWN_THROUGH && ob_view_in_frustum(view, body->pose.p, body->radius);
}

static bool draw_overlays(ob_renderer *r, const ob_snapshot *now, const ob_view *v)
{
	if (r->setup.overlay_aabb) {
		if (!ob_overlay_boxes(&r->overlay, &r->list, v))
			return false;
		ob_passes_overlay(&r->passes, &r->overlay, true);
	}
	if (r->setup.overlay_contacts) {
		if (!ob_overlay_contacts(&r->overlay, now, v, r->setup.height))
			return false;
		ob_passes_overlay(&r->passes, &r->overlay, false);
	}
	if (r->setup.overlay_reads) {
		if (!ob_overlay_reads(&r->overlay, &r->list, v, r->setup.reader))
			return false;
		ob_passes_overlay(&r->passes, &r->overlay, false);
	}
	if (r->setup.overlay_joints) {
		if (!ob_overlay_joints(&r->overlay, now, v, r->setup.height))
			return false;
		ob_passes_overlay(&r->passes, &r->overlay, false);
	}
	return true;
}

// Draws the maps of one picture, and the picture itself. Returns false if memory runs out.
static bool draw_share(ob_renderer *r, const ob_view *v, bool through, const ob_frame_share *share, ob_frame *f)
{
	const ob_passes *p = &r->passes;
	const ob_targets *to = &r->targets;
	int width = r->setup.width, height = r->setup.height;
	ob_frame_set(f, &r->list, &r->look, v, width, height, share, to->sky_texels);
	if (share->number == 0)
		ob_draw_list_sort(&r->list, f->view.eye);
	ob_passes_begin(p, &f->block);
	if (!ob_instances_fill(&r->casters, &r->list, &f->view, height, casts_shadow, &f->shadow))
		return false;
	ob_passes_shadow_map(p, to, &r->casters);
	for (int i = 0; i < f->sky_maps; i++) {
		if (!ob_instances_fill(&r->casters, &r->list, &f->view, height, casts_shadow, &f->sky[i]))
			return false;
		ob_passes_sky_map(p, to, i, &r->casters);
	}
	if (f->ground >= 0 && r->light == OB_LIGHT_DRAFT) {
		if (!ob_instances_fill(&r->near_ground, &r->list, &f->view, height, is_near_ground, f))
			return false;
		ob_passes_occlusion_map(p, to, &r->near_ground);
	}
	if (!ob_instances_fill(&r->visible, &r->list, &f->view, height, is_visible, &f->view))
		return false;
	ob_passes_colour(p, to, &r->visible, &r->list, f, &r->look);
	if (!through)
		return true;
	if (!ob_instances_fill(&r->visible, &r->list, &f->view, height, is_seen_through, &f->view))
		return false;
	ob_passes_through(p, &r->visible);
	return true;
}

// Takes the turn, makes the context current, and evaluates all motions. end follows.
static bool begin(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t, ob_error *e)
{
	pthread_mutex_lock(&turn);
	if (!context_make_current(&r->context, e))
		return false;
	return (ob_draw_list_fill(&r->list, prev, now, t) && ob_passes_take_hulls(&r->passes, now)) ||
	       ob_fail(e, "out of memory");
}

// Draws the picture, without overlays. through: with objects that are seen through.
static bool paint(ob_renderer *r, const ob_view *v, bool through, ob_frame *f, ob_error *e)
{
	const bool averaged = r->light == OB_LIGHT_AVERAGED;
	ob_frame_share share = { .count = averaged ? r->setup.samples : 1, .sky_maps = r->targets.sky_maps };
	for (; share.number < share.count; share.number++) {
		if (!draw_share(r, v, through, &share, f))
			return ob_fail(e, "out of memory");
		if (averaged)
			ob_passes_add(&r->passes, &r->targets, share.number, share.count);
	}
	if (averaged)
		ob_passes_resolve(&r->passes, &r->targets);
	return true;
}

// Lets go of the context, and of the turn. Returns drawn.
static bool end(ob_renderer *r, bool drawn)
{
	context_release(&r->context);
	pthread_mutex_unlock(&turn);
	return drawn;
}

static bool read_picture(ob_renderer *r, uint8_t *rgba, ob_error *e)
{
	ob_passes_read(&r->targets, r->rough ? r->rough : rgba);
	if (r->rough)
		ob_smooth(r->rough, rgba, r->brightness, r->setup.width, r->setup.height);
	const GLenum error = glGetError();
	return error == GL_NO_ERROR ? true : ob_fail(e, "the OpenGL driver reported error 0x%x while drawing", error);
}

static bool draw_all(ob_renderer *r, double t, const ob_camera_def *c, uint8_t *rgba, ob_error *e)
{
	ob_frame f = { 0 };
	const int width = r->setup.width, height = r->setup.height;
	const ob_camera_def camera = ob_camera_follow(c, &r->list, width, height);
	const ob_view view = ob_view_of_camera(&camera, t, width, height);
	return paint(r, &view, true, &f, e) &&
	       (draw_overlays(r, r->list.now, &f.view) || ob_fail(e, "out of memory")) && read_picture(r, rgba, e);
}

static bool draw(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t, const ob_camera_def *c,
		 uint8_t *rgba, ob_error *e)
{
	return end(r, begin(r, prev, now, t, e) && draw_all(r, t, c, rgba, e));
}

// Makes room for what a camera sensor sees.
static bool prepare_sight(ob_renderer *r, size_t pixels, ob_error *e)
{
	r->rgba = r->rgba ? r->rgba : malloc(4 * pixels);
	r->sight = r->sight ? r->sight : malloc(pixels * sizeof *r->sight);
	return (r->rgba && r->sight) || ob_fail(e, "out of memory");
}

static bool sense_all(ob_renderer *r, const ob_sensor_passport *s, ob_pose on, ob_pixel *pixel, ob_error *e)
{
	ob_frame f = { 0 };
	const size_t pixels = (size_t)r->setup.width * (size_t)r->setup.height;
	const ob_mat3 body = ob_quat_matrix(on.q);
	const ob_view view = ob_view_of_sensor(
		s, (ob_pose){ ob_add(on.p, ob_rotate(&body, s->pose.p)), ob_quat_mul(on.q, s->pose.q) });
	if (!prepare_sight(r, pixels, e) || !ob_targets_add_sight(&r->targets, e) || !paint(r, &view, false, &f, e))
		return false;
	if (!ob_instances_fill(&r->exact, &r->list, &view, r->setup.height, is_visible, &view))
		return ob_fail(e, "out of memory");
	ob_passes_sight(&r->passes, &r->targets, &r->exact, &r->list, &f, r->sight);
	if (!read_picture(r, r->rgba, e))
		return false;
	for (size_t i = 0; i < pixels; i++) {
		pixel[i] = (ob_pixel){ .depth = r->sight[i][0],
				       .id = r->sight[i][1] < 0 ? UINT32_MAX : (uint32_t)r->sight[i][1] };
		memcpy(pixel[i].rgba, r->rgba + 4 * i, 4);
	}
	return true;
}

static bool sense(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t,
		  const ob_sensor_passport *s, ob_pixel *pixel, ob_error *e)
{
	return end(r, begin(r, prev, now, t, e) && sense_all(r, s, ob_draw_pose(prev, now, s->object, t), pixel, e));
}

OB_PART(ob_render_part) = { OB_PART_HEAD(ob_render_part), .create = create, .destroy = destroy, .draw = draw,
			    .sense = sense };
