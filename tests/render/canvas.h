// A small renderer and its picture, for tests that read pixels.
#ifndef OB_TESTS_RENDER_CANVAS_H
#define OB_TESTS_RENDER_CANVAS_H

#include <stdlib.h>

#include "../check.h"
#include "test_scene.h"

enum { CANVAS_WIDTH = 320, CANVAS_HEIGHT = 180 };

typedef struct canvas {
	ob_renderer *renderer;
	uint8_t *rgba;
} canvas;

// Exits with 77 (skipped) on machines that cannot draw.
static inline canvas canvas_open(bool aabb, bool contacts)
{
	ob_render_setup setup = { .width = CANVAS_WIDTH,
				  .height = CANVAS_HEIGHT,
				  .samples = 4,
				  .overlay_aabb = aabb,
				  .overlay_contacts = contacts };
	ob_look_def look = test_scene_look();
	ob_error e = { "" };
	canvas c = { ob_renderer_create(&setup, &look, &e), malloc(4 * CANVAS_WIDTH * CANVAS_HEIGHT) };
	if (!c.renderer) {
		fprintf(stderr, "skipped: %s\n", e.text);
		exit(77);
	}
	return c;
}

static inline void canvas_draw(canvas *c, const ob_snapshot *prev, const ob_snapshot *now, double t,
			       const ob_camera_def *camera)
{
	ob_error e = { "" };
	CHECK(ob_renderer_draw(c->renderer, prev, now, t, camera, c->rgba, &e));
	if (e.text[0])
		fprintf(stderr, "%s\n", e.text);
}

static inline void canvas_close(canvas *c)
{
	ob_renderer_destroy(c->renderer);
	free(c->rgba);
}

// Mean of channel k (0..255) over the square of half side r round (x, y), in px from the top left.
static inline double canvas_mean(const canvas *c, int x, int y, int r, int k)
{
	double sum = 0;
	for (int j = y - r; j <= y + r; j++)
		for (int i = x - r; i <= x + r; i++)
			sum += c->rgba[4 * (j * CANVAS_WIDTH + i) + k];
	return sum / ((2 * r + 1) * (2 * r + 1));
}

// Centre of the pixels whose red exceeds their green and blue by more than 40, in px; returns their number.
static inline int canvas_find_red(const canvas *c, double *x, double *y)
{
	int n = 0;
	*x = *y = 0;
	for (int j = 0; j < CANVAS_HEIGHT; j++)
		for (int i = 0; i < CANVAS_WIDTH; i++) {
			const uint8_t *p = c->rgba + 4 * (j * CANVAS_WIDTH + i);
			if (p[0] > p[1] + 40 && p[0] > p[2] + 40) {
				*x += i;
				*y += j;
				n++;
			}
		}
	*x /= n ? n : 1;
	*y /= n ? n : 1;
	return n;
}

#endif
