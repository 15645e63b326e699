// Frames per second off-screen, with readback: bench_render [OBJECTS [WIDTH HEIGHT [SAMPLES [draft|fine
// [PNG-DIRECTORY]]]]]
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "test_scene.h"

enum { FRAMES = 60 };

static int measure(ob_renderer *r, const ob_snapshot *s, const ob_render_setup *setup, uint8_t *rgba)
{
	ob_camera_def camera = test_scene_camera(ob_v3(-22, -26, 15), ob_v3(0, 0, 0));
	camera.velocity = ob_v3(.05, 0, 0);
	ob_error e;
	if (!ob_renderer_draw(r, NULL, s, 0, &camera, rgba, &e)) { // the first picture compiles the shaders
		fprintf(stderr, "%s\n", e.text);
		return 1;
	}
	double wall = ob_clock_wall(), cpu = ob_clock_process_cpu();
	for (int i = 0; i < FRAMES; i++)
		if (!ob_renderer_draw(r, NULL, s, i / 60., &camera, rgba, &e))
			return 1;
	wall = ob_clock_wall() - wall;
	cpu = ob_clock_process_cpu() - cpu;
	printf("%u objects, %dx%d, %d samples, %s: %.1f fps, %.2f ms wall, %.2f ms CPU a frame\n", s->count - 1,
	       setup->width, setup->height, setup->samples, setup->quality == OB_QUALITY_FINE ? "fine" : "draft",
	       FRAMES / wall, 1e3 * wall / FRAMES, 1e3 * cpu / FRAMES);
	return 0;
}

int main(int argc, char **argv)
{
	int objects = argc > 1 ? atoi(argv[1]) : 1000;
	ob_render_setup setup = { .width = argc > 3 ? atoi(argv[2]) : 1280,
				  .height = argc > 3 ? atoi(argv[3]) : 720,
				  .samples = argc > 4 ? atoi(argv[4]) : 4,
				  .quality = argc > 5 && strcmp(argv[5], "fine") == 0 ? OB_QUALITY_FINE
										      : OB_QUALITY_DRAFT };
	ob_look_def look = test_scene_look();
	ob_error e = { "" };
	ob_snapshot s;
	ob_renderer *r = ob_renderer_create(&setup, &look, &e);
	uint8_t *rgba = malloc(4 * (size_t)setup.width * (size_t)setup.height);
	test_scene_boxes(&s, (uint32_t)objects, 26, 1);
	int failed = !r || !rgba || measure(r, &s, &setup, rgba);
	ob_sink *png = !failed && argc > 6 ? ob_sink_png(argv[6], setup.width, setup.height, 0, &e) : NULL;
	if (png) {
		failed = !ob_sink_put(png, 0, 0, rgba, &e);
		failed |= !ob_sink_close(png, &e);
	}
	if (failed)
		fprintf(stderr, "%s\n", e.text);
	ob_renderer_destroy(r);
	test_scene_finish(&s);
	free(rgba);
	return failed;
}
