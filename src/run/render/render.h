// Frames: draws snapshots off-screen through EGL. Reads, never writes, the universe.
// One thread at a time for each renderer. ob_renderer_create loads the part that draws, and fails with one line if the
// part or EGL is missing.
#ifndef OB_RENDER_RENDER_H
#define OB_RENDER_RENDER_H

#include "measure/colouring.h"
#include "scene/scene.h"

typedef enum ob_quality {
	OB_QUALITY_DRAFT, // one picture; without a GPU with the cheapest light
	OB_QUALITY_FINE, // many pictures averaged: soft shadows, light of the sky, smooth edges
} ob_quality;

typedef struct ob_render_setup {
	int width, height;
	ob_quality quality;
	// draft: samples a pixel; 0 = 4 on a GPU, else 1, and edges are smoothed afterwards. fine: number of averaged
	// pictures, at least 1
	int samples;
	// NULL = try surfaceless, then devices, in turn; "surfaceless"; or the number of a GPU "0", "1", ..
	const char *device;
	bool overlay_aabb, overlay_contacts, overlay_joints;
	bool overlay_reads; // snapshots must have bounds
	const char *reader; // object whose readings are drawn, which must outlive the renderer; "" = all
	ob_colouring colouring; // its places must outlive the renderer
	// [meshes], the scene's, which must outlive the renderer; objects refer to them by the number in their body
	// properties. One with a number beyond these is drawn as its collision shape
	const ob_mesh *mesh;
	uint32_t meshes;
} ob_render_setup;

typedef struct ob_renderer ob_renderer;

// True if the drawing part can be loaded; false and e with the packages that are missing. Maps nothing.
bool ob_render_check(ob_error *e);
// Returns NULL and e, with all attempts, on failure.
ob_renderer *ob_renderer_create(const ob_render_setup *r, const ob_look_def *look, ob_error *e);
void ob_renderer_destroy(ob_renderer *r);
// Draws the snapshot "now" as seen by camera c at time t (s). prev: the snapshot one step earlier, for times between
// steps (NULL: t is now->time). Fills rgba (width * height * 4 bytes, top row first).
bool ob_renderer_draw(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t, const ob_camera_def *c,
		      uint8_t *rgba, ob_error *e);
// Draws the picture of a camera sensor likewise: colours without overlays, depths and objects. pixel: width * height. Sees neither
// hidden objects nor those with which nothing collides. Colours are those of looks, smoothed; depths and objects are those of a
// pixel's middle: of a look, or of the shape that collides.
bool ob_renderer_sense(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t,
		       const ob_sensor_passport *s, ob_pixel *pixel, ob_error *e);

// Sinks: destinations of finished frames. Encoding runs in the sink's own thread; put() blocks while 8 frames wait.
typedef struct ob_sink ob_sink;
// Writes DIR/frame-000000.png ..., tEXt: simulated time. Removes frames of an earlier run, except for those before
// "first", the number of the first new one.
ob_sink *ob_sink_png(const char *dir, int w, int h, uint64_t first, ob_error *e);
// Writes rgb24 to a pipe; name: the name of the pipe in errors; valid as long as the sink
ob_sink *ob_sink_raw(int fd, const char *name, int w, int h, ob_error *e);
// True if ffmpeg is there; else false, and e names the package.
bool ob_video_check(ob_error *e);
ob_sink *ob_sink_video(const char *path, int w, int h, double fps, ob_error *e); // through ffmpeg
bool ob_sink_put(ob_sink *s, uint64_t frame, double time, const uint8_t *rgba, ob_error *e);
// Waits for all frames, closes. Returns false and e if any frame was not written whole. Frees s either way.
bool ob_sink_close(ob_sink *s, ob_error *e);

#endif
