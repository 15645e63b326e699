// Smoothing of edges: flat pictures stay, steps of an edge become ramps, the picture's brightness is kept.
#include "render/smooth.h"

#include <stdlib.h>
#include <string.h>

#include "../check.h"

enum { WIDE = 96, HIGH = 64 };

static uint8_t from[4 * WIDE * HIGH], to[4 * WIDE * HIGH], brightness[WIDE * HIGH];

static void put(int x, int y, uint8_t level)
{
	memset(from + 4 * (y * WIDE + x), level, 4);
}

// Draws white below the line y = HIGH / 2 + slope * (x - WIDE / 2), black above, one sample a pixel.
static void draw_edge(double slope)
{
	for (int y = 0; y < HIGH; y++)
		for (int x = 0; x < WIDE; x++)
			put(x, y, y + .5 > HIGH / 2. + slope * (x + .5 - WIDE / 2.) ? 240 : 16);
}

// Mean difference of a picture from the exact cover of each pixel by the edge.
static double error_of(const uint8_t *picture, double slope)
{
	double sum = 0;
	for (int y = 4; y < HIGH - 4; y++)
		for (int x = 4; x < WIDE - 4; x++) {
			double cover = 0;
			for (int i = 0; i < 64; i++)
				cover += (y + (i / 8 + .5) / 8 >
					  HIGH / 2. + slope * (x + (i % 8 + .5) / 8 - WIDE / 2.)) /
					 64.;
			sum += abs(picture[4 * (y * WIDE + x)] - (int)(16 + 224 * cover));
		}
	return sum / (WIDE * HIGH);
}

static void test_flat(void)
{
	for (int y = 0; y < HIGH; y++)
		for (int x = 0; x < WIDE; x++)
			put(x, y, (uint8_t)(100 + x / 2 + y / 4)); // slow changes are no edges
	ob_smooth(from, to, brightness, WIDE, HIGH);
	CHECK(memcmp(from, to, sizeof to) == 0);
}

static void test_edges(void)
{
	static const double slopes[] = { .05, .11, .3, .7, 1.7, 6 };
	for (size_t i = 0; i < sizeof slopes / sizeof *slopes; i++) {
		draw_edge(slopes[i]);
		ob_smooth(from, to, brightness, WIDE, HIGH);
		CHECK(error_of(to, slopes[i]) < .7 * error_of(from, slopes[i]));
	}
}

// An edge along the pixels is sharp already; tiny pictures have no inside.
static void test_sharp(void)
{
	draw_edge(0);
	ob_smooth(from, to, brightness, WIDE, HIGH);
	CHECK(memcmp(from, to, sizeof to) == 0);
	for (int size = 1; size < 4; size++)
		ob_smooth(from, to, brightness, size, size);
}

int main(void)
{
	test_flat();
	test_edges();
	test_sharp();
	return check_end();
}
