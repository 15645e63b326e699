// Properties of every diagram, however awkward: texts do not overlap, nothing is cut, every number is finite.
#include <string.h>

#include "../check.h"
#include "awkward.h"
#include <cairo.h>

#include "plot/drawing.h"
#include "plot/font.h"

static const char *text_of(const ob_drawing *d, const ob_item *item)
{
	return d->text + item->text;
}

static void check_texts(const awkward *a, int i, const ob_drawing *d)
{
	ob_rect page = { 0, 0, d->width, d->height };
	int over = 0, cut = 0;
	for (size_t j = 0; j < d->items; j++) {
		const ob_item *one = &d->item[j];
		if (one->kind != OB_ITEM_TEXT)
			continue;
		if (!ob_rect_within(one->box, page)) {
			cut++;
			fprintf(stderr, "%d %s: cut: %s\n", i, a->name, text_of(d, one));
		}
		for (size_t k = 0; k < j; k++) {
			const ob_item *other = &d->item[k];
			if (other->kind == OB_ITEM_TEXT && ob_rect_meet(one->box, other->box)) {
				over++;
				fprintf(stderr, "%d %s: %s covers %s\n", i, a->name, text_of(d, one),
					text_of(d, other));
			}
		}
	}
	CHECK(over == 0);
	CHECK(cut == 0);
}

static void check_dots(const awkward *a, int i, const ob_drawing *d)
{
	int wrong = 0;
	for (size_t j = 0; j < d->items; j++) {
		const ob_item *item = &d->item[j];
		double rim = item->kind == OB_ITEM_DISC ? item->radius : 0;
		for (size_t k = item->first; k < item->first + item->count; k++) {
			ob_dot at = d->dot[k];
			wrong += !(at.x >= rim - 1 && at.x <= d->width - rim + 1 && at.y >= rim - 1 &&
				   at.y <= d->height - rim + 1);
		}
	}
	CHECK(wrong == 0);
	if (wrong)
		fprintf(stderr, "%d %s: %d dots outside\n", i, a->name, wrong);
}

static size_t count_text(const ob_drawing *d, const char *text)
{
	size_t count = 0;
	for (size_t i = 0; i < d->items; i++)
		count += d->item[i].kind == OB_ITEM_TEXT && !strcmp(text_of(d, &d->item[i]), text);
	return count;
}

static size_t count_hints(const ob_drawing *d)
{
	size_t count = 0;
	for (size_t i = 0; i < d->items; i++)
		count += d->item[i].hint != 0;
	return count;
}

static void check_awkward(void)
{
	static awkward a;
	int made = 0;
	for (int i = 0; awkward_make(&a, i); i++) {
		ob_drawing d = { 0 };
		ob_error e;
		CHECK(ob_plot_layout(&a.plot, &d, &e));
		check_texts(&a, i, &d);
		check_dots(&a, i, &d);
		ob_drawing_finish(&d);
		made++;
	}
	CHECK(made == 31);
}

static ob_plot_point points[] = {
	{ .x = 1, .y = 3, .label = "first" },
	{ .x = 2, .y = 0 },
	{ .x = 4, .y = NAN, .failed = true, .label = "fell" },
	{ .x = 8, .y = NAN },
	{ .x = 9, .y = 2, .failed = true },
};
static const ob_plot_series curve = { .title = "one", .count = 5, .point = points, .line = true };
static const ob_plot plot = { .title = "Title",
			      .x = { .label = "x", .scale = OB_SCALE_LOG },
			      .y = { .label = "y", .scale = OB_SCALE_LOG },
			      .series = &curve,
			      .series_count = 1 };

// Failed points and zeros have bands of their own; values that are NaN without a failure are left out.
static void check_bands(void)
{
	ob_drawing d = { 0 };
	CHECK(ob_plot_layout(&plot, &d, NULL));
	CHECK(count_text(&d, "0") == 1);
	CHECK(count_text(&d, "failed") == 2); // the band, and the legend
	CHECK(count_text(&d, "first") == 1);
	CHECK(count_text(&d, "fell") == 1);
	CHECK(count_hints(&d) == 4);
	ob_drawing_finish(&d);

	ob_plot_series whole = curve;
	whole.count = 1;
	ob_plot p = plot;
	p.series = &whole;
	CHECK(ob_plot_layout(&p, &d, NULL));
	CHECK(count_text(&d, "0") == 0);
	CHECK(count_text(&d, "failed") == 0);
	ob_drawing_finish(&d);
}

// A failed point with a value stays where it is; one without lies above all that have one.
static void check_crosses(void)
{
	ob_drawing d = { 0 };
	double cross = -1, other = -1;
	CHECK(ob_plot_layout(&plot, &d, NULL));
	for (size_t i = 0; i < d.items; i++) {
		const char *hint = d.text + d.item[i].hint;
		if (strstr(hint, "fell"))
			cross = d.dot[d.item[i].first].y;
		else if (strstr(hint, "first"))
			other = d.dot[d.item[i].first].y;
	}
	CHECK(cross > 0 && other > cross + 10);
	ob_drawing_finish(&d);
}

// Each point of a falling curve has room for its label: above it to the right.
static void check_point_labels(void)
{
	static ob_plot_point falling[] = { { .x = .09, .y = 1860, .label = "finest" },
					   { .x = .75, .y = 1407, .label = "fine" },
					   { .x = 7.9, .y = 501, .label = "coarse" },
					   { .x = 23, .y = 366, .label = "coarsest" } };
	const ob_plot_series line = { .title = "one", .count = 4, .point = falling, .line = true };
	ob_drawing d = { 0 };
	ob_plot p = plot;
	p.series = &line;
	CHECK(ob_plot_layout(&p, &d, NULL));
	for (size_t i = 0; i < 4; i++)
		CHECK(count_text(&d, falling[i].label) == 1);
	ob_drawing_finish(&d);
}

// A target of zero has the whole band of zeros on its good side.
static void check_zero_target(void)
{
	ob_drawing d = { 0 };
	ob_plot_mark mark = { .at = 0, .label = "target 0", .tinted = true };
	ob_plot p = plot;
	p.mark = &mark;
	p.marks = 1;
	double line = -1, zero = -1, above = -1;
	CHECK(ob_plot_layout(&p, &d, NULL));
	for (size_t i = 0; i < d.items; i++) {
		const ob_item *item = &d.item[i];
		double y = d.dot[item->first].y;
		if (item->kind == OB_ITEM_PATH && item->pen.stroke == OB_PAINT_GOOD)
			line = y;
		if (strstr(d.text + item->hint, "2, 0"))
			zero = y;
		if (strstr(d.text + item->hint, "first"))
			above = y;
	}
	CHECK(above >= 0 && above < line && line < zero);
	ob_drawing_finish(&d);
}

static void check_lines(void)
{
	CHECK_NEAR(ob_font_width("Hi", 1000, false), 752 + 278, 1e-9);
	CHECK_NEAR(ob_font_width("Hi", 10, true), 11.8, 1e-9);
	char line[64];
	const char *rest = "one two three";
	CHECK(ob_font_fit_line(&rest, ob_font_width("one two", 10, false) + 1, 10, false, false, line, sizeof line));
	CHECK(!strcmp(line, "one two"));
	CHECK(ob_font_fit_line(&rest, 20, 10, false, true, line, sizeof line));
	CHECK(strstr(line, "\u2026") && ob_font_width(line, 10, false) <= 20);
	CHECK(!ob_font_fit_line(&rest, 20, 10, false, true, line, sizeof line));
	ob_font_clean_text("a\x01"
			   "b\xff"
			   "c\u00b5\xc0\x80",
			   line, sizeof line);
	CHECK(!strcmp(line, "a b?c\u00b5??"));
	ob_font_clean_text("\u00b5\u00b5", line, 4); // no partial letters
	CHECK(!strcmp(line, "\u00b5"));
}

// No font that may show a text is wider than the layout assumes: nothing has to be squeezed. Installed fonts replace
// missing ones.
static void check_fonts(void)
{
	static const char *const families[] = { "Liberation Sans", "Arial", "Helvetica", "DejaVu Sans", "sans-serif" };
	static const char *const texts[] = { "CPU per body and simulated second (\u00b5s)",
					     "\u221210.25 mm \u2264 2\u00d710",
					     "failed",
					     "stack of 10: obsim, 16 substeps",
					     "f(l) [tj] {!}",
					     "MWQ @ #%&",
					     "\u2248 \u221e \u2026 \u2014 \u03c0\u03c9\u03b8" };
	cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1);
	cairo_t *c = cairo_create(surface);
	cairo_font_options_t *options = cairo_font_options_create();
	cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
	cairo_set_font_options(c, options);
	cairo_set_font_size(c, 1000);
	for (size_t i = 0; i < 2 * sizeof families / sizeof *families; i++) {
		cairo_select_font_face(c, families[i / 2], CAIRO_FONT_SLANT_NORMAL,
				       i % 2 ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
		for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
			cairo_text_extents_t extents;
			cairo_text_extents(c, texts[k], &extents);
			CHECK(extents.x_advance > 0 && extents.x_advance <= ob_font_width(texts[k], 1000, i % 2));
		}
	}
	cairo_font_options_destroy(options);
	cairo_destroy(c);
	cairo_surface_destroy(surface);
}

int main(void)
{
	check_awkward();
	check_bands();
	check_crosses();
	check_point_labels();
	check_zero_target();
	check_lines();
	check_fonts();
	return check_end();
}
