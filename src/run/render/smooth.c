#include "render/smooth.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum {
	ONE = 256, // shares are parts of it
	LEAST_CONTRAST = 10, // of 255: below that there is no edge
	CONTRAST_SHARE = 8, // nor below this part of the brightest neighbour
	REACH = 24, // px along an edge, in which its ends are looked for
};

typedef struct picture {
	const uint8_t *rgba, *brightness;
	int width, height;
} picture;

typedef struct edge {
	ptrdiff_t along, across; // to the next pixel along the edge, and to the neighbour beyond it
	int middle, slope; // of the brightness: mean of both sides, and its change across, /4
} edge;

static int most(int a, int b)
{
	return a > b ? a : b;
}

static int least(int a, int b)
{
	return a < b ? a : b;
}

// Brightness of all pixels (weights of ITU-R BT.601).
static void find_brightness(const uint8_t *rgba, uint8_t *brightness, size_t pixels)
{
	for (size_t i = 0; i < pixels; i++)
		brightness[i] = (uint8_t)((77 * rgba[4 * i] + 150 * rgba[4 * i + 1] + 29 * rgba[4 * i + 2]) >> 8);
}

// Marks the pixels of a row where an edge may be; at: the row's second pixel.
static void mark_edges(const uint8_t *at, int width, int pixels, uint8_t *mark)
{
	for (int i = 0; i < pixels; i++) {
		const uint8_t c = at[i], n = at[i - width], s = at[i + width], w = at[i - 1], e = at[i + 1];
		const uint8_t high_v = n > s ? n : s, high_h = w > e ? w : e, low_v = n < s ? n : s,
			      low_h = w < e ? w : e;
		const uint8_t high_n = high_v > high_h ? high_v : high_h, low_n = low_v < low_h ? low_v : low_h;
		const uint8_t high = high_n > c ? high_n : c, low = low_n < c ? low_n : c;
		const uint8_t range = high - low, needed = high / CONTRAST_SHARE;
		mark[i] = range >= LEAST_CONTRAST && range >= needed;
	}
}

// Finds the direction of the edge at a pixel, and its steeper side.
static edge find_edge(const uint8_t *at, int width)
{
	const int c = at[0], n = at[-width], s = at[width], w = at[-1], e = at[1];
	const int nw = at[-width - 1], ne = at[-width + 1], sw = at[width - 1], se = at[width + 1];
	const int level = abs(nw + sw - 2 * w) + 2 * abs(n + s - 2 * c) + abs(ne + se - 2 * e);
	const int upright = abs(nw + ne - 2 * n) + 2 * abs(w + e - 2 * c) + abs(sw + se - 2 * s);
	const ptrdiff_t across = level >= upright ? width : 1;
	const int before = at[-across], after = at[across];
	const bool first = abs(before - c) >= abs(after - c);
	return (edge){ .along = level >= upright ? 1 : width,
		       .across = first ? -across : across,
		       .middle = c + (first ? before : after),
		       .slope = most(abs(before - c), abs(after - c)) };
}

// Goes along the edge by at most `steps` pixels until it ends. Returns the way, REACH if it does not end there, and how
// much brighter the end is.
static int find_end(const uint8_t *at, const edge *e, ptrdiff_t along, int steps, int *brighter)
{
	int i = 0;
	do {
		i++;
		*brighter = at[i * along] + at[i * along + e->across] - e->middle;
	} while (i < steps && 2 * abs(*brighter) < e->slope);
	return 2 * abs(*brighter) < e->slope ? REACH : i;
}

// Share of the neighbour beyond the edge by which the edge covers this pixel, of ONE.
static int covered(const uint8_t *at, const edge *e, int back, int on)
{
	int brighter_back, brighter_on;
	const int way_back = find_end(at, e, -e->along, least(REACH, back), &brighter_back);
	const int way_on = find_end(at, e, e->along, least(REACH, on), &brighter_on);
	const int brighter = way_back < way_on ? brighter_back : brighter_on;
	if ((brighter < 0) == (2 * at[0] < e->middle))
		return 0; // the edge steps away from this pixel
	return ONE / 2 - ONE * least(way_back, way_on) / (way_back + way_on);
}

// Mixes a pixel with its neighbour beyond the edge.
static void smooth_pixel(const picture *p, int x, int y, uint8_t *to)
{
	const size_t number = (size_t)y * (size_t)p->width + (size_t)x;
	const uint8_t *at = p->brightness + number, *own = p->rgba + 4 * number;
	const edge e = find_edge(at, p->width);
	const bool level = e.along == 1;
	const int back = level ? x : y, on = level ? p->width - 1 - x : p->height - 1 - y;
	const int share = covered(at, &e, back, on);
	for (int k = 0; k < 3; k++)
		to[4 * number + (size_t)k] = (uint8_t)(own[k] + (own[4 * e.across + k] - own[k]) * share / ONE);
}

void ob_smooth(const uint8_t *from, uint8_t *to, uint8_t *brightness, int width, int height)
{
	enum { PIECE = 1024 };
	uint8_t mark[PIECE];
	const size_t pixels = (size_t)width * (size_t)height;
	const picture p = { from, brightness, width, height };
	memcpy(to, from, 4 * pixels);
	find_brightness(from, brightness, pixels);
	for (int y = 1; y < height - 1; y++) {
		for (int x = 1, n; x < width - 1; x += n) {
			n = least(PIECE, width - 1 - x);
			mark_edges(brightness + (size_t)y * (size_t)width + (size_t)x, width, n, mark);
			for (int i = 0; i < n; i++)
				if (mark[i])
					smooth_pixel(&p, x + i, y, to);
		}
	}
}
