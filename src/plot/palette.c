#include "plot/palette.h"

#include <math.h>

static const struct {
	const char *name;
	unsigned rgb;
} paints[OB_PAINTS] = {
	[OB_PAINT_NONE] = { "none", 0 },
	[OB_PAINT_PAPER] = { "paper", 0xffffff },
	[OB_PAINT_INK] = { "ink", 0x1f2328 },
	[OB_PAINT_MUTED] = { "muted", 0x59626e },
	[OB_PAINT_GRID] = { "grid", 0xe4e7eb },
	[OB_PAINT_BAND] = { "band", 0xf3f4f6 },
	[OB_PAINT_GOOD] = { "good", 0x1a7f37 },
	[OB_PAINT_MEADOW] = { "meadow", 0xeef8f0 },
	[OB_PAINT_SERIES + 0] = { "c0", 0x0072b2 }, // blue
	[OB_PAINT_SERIES + 1] = { "c1", 0x56b4e9 }, // sky blue
	[OB_PAINT_SERIES + 2] = { "c2", 0x009e73 }, // bluish green
	[OB_PAINT_SERIES + 3] = { "c3", 0xcc79a7 }, // reddish purple
	[OB_PAINT_SERIES + 4] = { "c4", 0x7a7a7a }, // grey
	[OB_PAINT_SERIES + 5] = { "c5", 0xd55e00 }, // vermilion
	[OB_PAINT_SERIES + 6] = { "c6", 0xe69f00 }, // orange
	[OB_PAINT_SERIES + 7] = { "c7", 0x222222 }, // black
};

static const double dashes[OB_DASHES][4] = { { 0 }, { 6, 3 }, { 1.5, 2.5 }, { 8, 3, 1.5, 3 } };
enum { DASH_SOLID, DASH_DASHED, DASH_DOTTED, DASH_DOT_DASHED, COLOURS = OB_PAINTS - OB_PAINT_SERIES, MARKERS = 8 };

const char *ob_palette_name(ob_paint paint)
{
	return paints[paint].name;
}

unsigned ob_palette_rgb(ob_paint paint)
{
	return paints[paint].rgb;
}

const double *ob_palette_dash(int dash, int *count)
{
	*count = dash == DASH_SOLID ? 0 : dash == DASH_DOT_DASHED ? 4 : 2;
	return dashes[dash];
}

ob_narrowphase_find ob_palette_look(int style, bool hollow)
{
	if (style < 0)
		return (ob_narrowphase_find){ .paint = OB_PAINT_MUTED, .marker = -1, .dash = DASH_DASHED, .width = 1 };
	int colour = style % COLOURS, round = style / COLOURS;
	ob_narrowphase_find look = { .paint = OB_PAINT_SERIES + colour, .marker = (style + round) % MARKERS, .hollow = hollow };
	look.dash = hollow ? DASH_DOTTED : (style + round) % 2 ? DASH_DASHED : DASH_SOLID;
	if (!hollow && (style + round) % 4 == 3)
		look.dash = DASH_DOT_DASHED;
	look.width = style ? 1.4 : 2.2;
	look.size = style ? 3.6 : 4.4;
	return look;
}

// Corners of a regular figure, or of a star where every second one lies nearer; the first at an angle (turns)
static void polygon(ob_drawing *d, ob_dot at, int corners, double turn, double radius, double inner, ob_pen pen)
{
	ob_dot dot[12];
	for (int i = 0; i < corners; i++) {
		double angle = 2 * M_PI * (turn + (double)i / corners), r = i % 2 ? inner : radius;
		dot[i] = (ob_dot){ at.x + r * sin(angle), at.y - r * cos(angle) };
	}
	ob_draw_path(d, dot, (size_t)corners, true, pen);
}

void ob_palette_marker(ob_drawing *d, ob_dot at, const ob_narrowphase_find *look)
{
	double r = look->size;
	ob_pen pen = { .stroke = OB_PAINT_PAPER, .fill = look->paint, .width = .8 };
	if (look->hollow)
		pen = (ob_pen){ .stroke = look->paint, .fill = OB_PAINT_PAPER, .width = 1.4 };
	switch (look->marker) {
	case 0:
		ob_draw_disc(d, at, r, pen);
		break;
	case 1: // square
		polygon(d, at, 4, .125, r * 1.25, r * 1.25, pen);
		break;
	case 2: // triangle
		polygon(d, at, 3, 0, r * 1.35, r * 1.35, pen);
		break;
	case 3: // diamond
		polygon(d, at, 4, 0, r * 1.35, r * 1.35, pen);
		break;
	case 4: // triangle on its head
		polygon(d, at, 3, .5, r * 1.35, r * 1.35, pen);
		break;
	case 5: // pentagon
		polygon(d, at, 5, 0, r * 1.2, r * 1.2, pen);
		break;
	case 6: // star
		polygon(d, at, 10, 0, r * 1.5, r * .75, pen);
		break;
	case 7: // hexagon
		polygon(d, at, 6, 0, r * 1.2, r * 1.2, pen);
		break;
	default: // a guide has none
		break;
	}
}

void ob_palette_cross(ob_drawing *d, ob_dot at, const ob_narrowphase_find *look)
{
	double r = 3.6;
	ob_pen pen = { .stroke = look->paint, .width = 1.8 };
	ob_dot one[] = { { at.x - r, at.y - r }, { at.x + r, at.y + r } };
	ob_dot two[] = { { at.x - r, at.y + r }, { at.x + r, at.y - r } };
	ob_draw_path(d, one, 2, false, pen);
	ob_draw_path(d, two, 2, false, pen);
}
