#include "plot/frame.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"

// ---- ticks

static double transformed(ob_plot_scale scale, double v)
{
	return scale == OB_SCALE_LOG ? log10(v) : scale == OB_SCALE_LOG2 ? log2(v) : v;
}

double ob_ticks_along(const ob_ticks *t, double v)
{
	return (transformed(t->scale, v) - t->from) / (t->to - t->from);
}

static ob_tick *add_tick(ob_ticks *t, double value, bool major)
{
	double at = (value - t->from) / (t->to - t->from);
	if (!(at >= -1e-9 && at <= 1 + 1e-9) || t->count == OB_TICKS_MAX)
		return NULL;
	t->tick[t->count] = (ob_tick){ .at = fmin(fmax(at, 0), 1), .major = major };
	return &t->tick[t->count++];
}

// Prints a number with a minus as wide as a plus.
static void print_number(char *to, size_t room, double v, int decimals, const char *behind)
{
	snprintf(to, room, "%s%.*f%s", v < 0 ? "\u2212" : "", decimals, fabs(v), behind);
}

// Smallest step of 1, 2, 5 x 10^k from "least" up, and its k.
static double nice_step(double least, int *power)
{
	*power = (int)floor(log10(least));
	double unit = pow(10, *power);
	for (int i = 0; i < 3; i++) {
		double step = unit * (const int[]){ 1, 2, 5 }[i];
		if (step >= least * (1 - 1e-9))
			return step;
	}
	++*power;
	return pow(10, *power);
}

// Adds ticks at multiples of a step. On a logarithmic axis, values are placed by their logarithms.
static void add_steps(ob_ticks *t, double from, double to, int wanted)
{
	int power;
	double step = nice_step(to / wanted - from / wanted, &power), largest = fmax(fabs(from), fabs(to));
	int shown = largest >= 1e5 || largest < 1e-3 ? (int)floor(log10(largest)) : 0;
	double unit = pow(10, shown);
	int decimals = power < shown ? shown - power : 0;
	double begin = ceil(from / step - 1e-6), end = floor(to / step + 1e-6);
	for (double k = begin; k <= end && k < begin + 64; k++) {
		double value = k * step;
		if (t->scale != OB_SCALE_LINEAR && !(value > 0))
			continue;
		ob_tick *tick = add_tick(t, transformed(t->scale, value), true);
		if (!tick)
			continue;
		if (k == 0) {
			strcpy(tick->text, "0");
		} else if (shown) {
			print_number(tick->text, sizeof tick->text, value / unit, decimals, "\u00d710");
			print_number(tick->super, sizeof tick->super, shown, 0, "");
		} else {
			print_number(tick->text, sizeof tick->text, value, decimals, "");
		}
	}
}

static void choose_linear(ob_ticks *t, double from, double to, int wanted, bool fixed)
{
	if (!(to > from)) {
		double half = from == 0 ? 1 : fabs(from) / 2;
		from -= half;
		to += half;
	} else if (!fixed && from > 0 && from < to / 2) {
		from = 0;
	}
	if (!fixed) {
		int power;
		double step = nice_step(to / wanted - from / wanted, &power);
		from = floor(from / step + 1e-9) * step;
		to = ceil(to / step - 1e-9) * step;
	}
	t->from = from;
	t->to = to;
	add_steps(t, from, to, wanted);
}

static void label_decimal(ob_tick *tick, int digit, int power, bool plain)
{
	if (plain) {
		print_number(tick->text, sizeof tick->text, digit * pow(10, power), power < 0 ? -power : 0, "");
	} else {
		if (digit == 1)
			strcpy(tick->text, "10");
		else
			print_number(tick->text, sizeof tick->text, digit, 0, "\u00d710");
		print_number(tick->super, sizeof tick->super, power, 0, "");
	}
}

// Adds decades: every n-th if there are many; 1-2-5 if there are few.
static void add_decades(ob_ticks *t, int wanted)
{
	static const int strides[] = { 1, 2, 3, 5, 10, 20, 50, 100, 200 };
	double span = t->to - t->from;
	int stride = 1, first = (int)floor(t->from), last = (int)ceil(t->to);
	for (size_t i = 0; i < sizeof strides / sizeof *strides && span / (stride = strides[i]) > wanted; i++)
		;
	bool digits = span < 1.6, plain = first >= -3 && last <= 5;
	bool fine = span <= 40; // single decades, or digits, as minor ticks
	for (int power = first; power <= last; power++) {
		bool on = power % stride == 0;
		if (!on && !fine)
			continue;
		for (int digit = 1; digit <= (stride == 1 && span <= 12 ? 9 : 1); digit++) {
			bool major = on && (digit == 1 || (digits && (digit == 2 || digit == 5)));
			ob_tick *tick = add_tick(t, power + log10(digit), major);
			if (tick && major)
				label_decimal(tick, digit, power, plain);
		}
	}
}

static void add_powers_of_two(ob_ticks *t, int wanted)
{
	int stride = 1 + (int)((t->to - t->from) / (wanted + 1));
	for (int power = (int)floor(t->from); power <= t->to && power < t->from + 1 + OB_TICKS_MAX * stride; power++) {
		ob_tick *tick = power % stride ? NULL : add_tick(t, power, true);
		if (!tick)
			continue;
		if (power >= 0 && power <= 16) {
			print_number(tick->text, sizeof tick->text, ldexp(1, power), 0, "");
		} else if (power < 0 && power >= -4) {
			print_number(tick->text, sizeof tick->text, ldexp(1, power), -power, "");
		} else {
			strcpy(tick->text, "2");
			print_number(tick->super, sizeof tick->super, power, 0, "");
		}
	}
}

void ob_ticks_choose(ob_ticks *t, ob_plot_scale scale, double from, double to, int wanted, bool fixed)
{
	*t = (ob_ticks){ .scale = scale };
	if (scale == OB_SCALE_LINEAR || scale == OB_SCALE_CATEGORY) {
		choose_linear(t, from, to, wanted, fixed);
		return;
	}
	t->from = transformed(scale, from);
	t->to = transformed(scale, to);
	double least = !fixed ? (scale == OB_SCALE_LOG ? .9 : 2.1) : 1e-6;
	double more = fmax(0, least - (t->to - t->from)) / 2 + (fixed ? 0 : (t->to - t->from) * .04);
	t->from -= more;
	t->to += more;
	if (scale == OB_SCALE_LOG2)
		add_powers_of_two(t, wanted);
	else if (t->to - t->from < .75)
		add_steps(t, from, to, wanted);
	else
		add_decades(t, wanted);
}

// ---- frame

enum { LANE = 11, BAND_RIM = 8, BAND_GAP = 3 }; // px
#define LARGEST 1e300 // so that no difference overflows

bool ob_frame_logarithmic(const ob_side *s)
{
	return s->axis->scale == OB_SCALE_LOG || s->axis->scale == OB_SCALE_LOG2;
}

static bool is_low(const ob_side *s, double v)
{
	return ob_frame_logarithmic(s) && v <= 0;
}

static double bounded(double v)
{
	return fmin(fmax(v, -LARGEST), LARGEST);
}

static void include_value(ob_side *s, double v)
{
	if (!isfinite(v)) {
		s->high.used = true;
	} else if (is_low(s, v)) {
		s->low.used = true;
	} else {
		s->least = fmin(s->least, bounded(v));
		s->most = fmax(s->most, bounded(v));
	}
}

static bool has_bar(const ob_plot_point *p)
{
	return isfinite(p->low) && isfinite(p->high) && (p->low != 0 || p->high != 0);
}

static void include_points(ob_frame *f)
{
	for (size_t i = 0; i < f->spots; i++) {
		ob_spot *spot = &f->spot[i];
		const ob_plot_point *p = spot->point;
		spot->shown = p->failed || (isfinite(p->x) && isfinite(p->y));
		if (!spot->shown)
			continue;
		f->failed |= p->failed;
		include_value(&f->x, p->x);
		include_value(&f->y, p->y);
		if (has_bar(p)) {
			include_value(&f->y, p->low);
			include_value(&f->y, p->high);
		}
	}
}

static void choose_range(ob_side *s)
{
	const ob_plot_axis *a = s->axis;
	s->fixed = isfinite(a->from) && isfinite(a->to) && a->from < a->to && !is_low(s, a->from);
	if (s->fixed) {
		s->least = bounded(a->from);
		s->most = bounded(a->to);
	} else if (a->scale == OB_SCALE_CATEGORY) {
		s->least = -.5;
		s->most = fmax((double)a->categories, 1) - .5;
		s->fixed = true;
	} else if (!(s->least <= s->most)) { // no values on it
		s->least = ob_frame_logarithmic(s) ? 1 : 0;
		s->most = ob_frame_logarithmic(s) ? 10 : 1;
	}
}

// True inside a fixed range, and without one.
static bool is_within(const ob_side *s, double v)
{
	return !isfinite(v) || is_low(s, v) || !s->fixed || (v >= s->least && v <= s->most);
}

bool ob_frame_begin(ob_frame *f, const ob_plot *p)
{
	*f = (ob_frame){ .plot = p };
	f->x = (ob_side){ .axis = &p->x, .least = INFINITY, .most = -INFINITY };
	f->y = (ob_side){ .axis = &p->y, .least = INFINITY, .most = -INFINITY, .vertical = true };
	size_t count = 0;
	for (size_t i = 0; i < p->series_count; i++)
		count += p->series[i].count;
	f->spot = calloc(count + 1, sizeof *f->spot);
	if (!f->spot)
		return false;
	for (size_t i = 0; i < p->series_count; i++)
		for (size_t j = 0; j < p->series[i].count; j++)
			f->spot[f->spots++] = (ob_spot){ .series = &p->series[i], .point = &p->series[i].point[j] };
	include_points(f);
	for (size_t i = 0; i < p->marks; i++)
		if (isfinite(p->mark[i].at))
			include_value(p->mark[i].vertical ? &f->x : &f->y, p->mark[i].at);
	choose_range(&f->x);
	choose_range(&f->y);
	for (size_t i = 0; i < f->spots; i++)
		f->spot[i].shown &= is_within(&f->x, f->spot[i].point->x) && is_within(&f->y, f->spot[i].point->y);
	return true;
}

void ob_frame_finish(ob_frame *f)
{
	free(f->spot);
	free(f->take);
	*f = (ob_frame){ 0 };
}

static double thickness(ob_band b)
{
	return b.used ? BAND_RIM + LANE * (b.lanes ? b.lanes : 1) : 0;
}

void ob_frame_band(const ob_side *s, bool high, double *inner, double *outer)
{
	double away = (s->end > s->begin) == high ? 1 : -1;
	*inner = (high ? s->end : s->begin) + away * BAND_GAP;
	*outer = *inner + away * thickness(high ? s->high : s->low);
}

// Middle of a lane (px).
static double lane_at(const ob_side *s, bool high, int lane)
{
	double inner, outer;
	ob_frame_band(s, high, &inner, &outer);
	return inner + (outer > inner ? 1 : -1) * (BAND_RIM / 2. + LANE * (lane + .5));
}

double ob_frame_at(const ob_side *s, double value)
{
	if (!isfinite(value))
		return lane_at(s, true, 0);
	if (is_low(s, value))
		return lane_at(s, false, 0);
	double along = ob_ticks_along(&s->ticks, bounded(value));
	if (s->axis->scale == OB_SCALE_CATEGORY && s->vertical)
		along = 1 - along; // downwards
	along = fmin(fmax(along, -4), 5); // far outside a fixed range
	return s->begin + along * (s->end - s->begin);
}

double ob_frame_mark(const ob_side *s, double value)
{
	double inner, outer;
	ob_frame_band(s, false, &inner, &outer);
	return is_low(s, value) ? inner : ob_frame_at(s, value);
}

// Moves points of a band into lanes, so that points close along the rim lie side by side.
static void spread_over_lanes(ob_frame *f, ob_side *s, bool high)
{
	ob_band *band = high ? &s->high : &s->low;
	int lanes = 1;
	for (size_t i = 0; band->used && i < f->spots; i++) {
		ob_spot *one = &f->spot[i];
		double v = s->vertical ? one->point->y : one->point->x;
		if (!one->shown || (high ? isfinite(v) : !is_low(s, v)))
			continue;
		unsigned busy = 0; // a bit for each lane
		for (size_t j = 0; j < i; j++) {
			const ob_spot *other = &f->spot[j];
			double along = s->vertical ? other->at.x - one->at.x : other->at.y - one->at.y;
			double across = s->vertical ? other->at.y : other->at.x;
			for (int lane = 0; other->shown && fabs(along) < LANE && lane < OB_FRAME_LANES; lane++)
				busy |= (unsigned)(fabs(across - lane_at(s, high, lane)) < 1) << lane;
		}
		int lane = 0;
		while (lane < OB_FRAME_LANES - 1 && busy >> lane & 1)
			lane++;
		*(s->vertical ? &one->at.y : &one->at.x) = lane_at(s, high, lane);
		lanes = lane + 1 > lanes ? lane + 1 : lanes;
	}
	band->lanes = lanes;
}

static void place_side(ob_side *s, double begin, double end)
{
	double toward = end > begin ? 1 : -1;
	s->begin = begin + (s->low.used ? toward * (thickness(s->low) + BAND_GAP) : 0);
	s->end = end - (s->high.used ? toward * (thickness(s->high) + BAND_GAP) : 0);
	int wanted = (int)fmin(fmax(fabs(s->end - s->begin) / (s->vertical ? 42 : 74), 2), 12);
	ob_ticks_choose(&s->ticks, s->axis->scale, s->least, s->most, wanted, s->fixed);
}

void ob_frame_place(ob_frame *f, ob_rect outer)
{
	f->outer = outer;
	// the second time with the number of lanes found by the first
	for (int pass = 0; pass < 2; pass++) {
		place_side(&f->x, outer.x0, outer.x1);
		place_side(&f->y, outer.y1, outer.y0);
		for (size_t i = 0; i < f->spots; i++) {
			ob_spot *s = &f->spot[i];
			s->at = (ob_dot){ ob_frame_at(&f->x, s->point->x), ob_frame_at(&f->y, s->point->y) };
		}
		for (int high = 0; high < 2; high++) {
			spread_over_lanes(f, &f->y, high);
			spread_over_lanes(f, &f->x, high);
		}
	}
	f->area = (ob_rect){ f->x.begin, f->y.end, f->x.end, f->y.begin };
}

bool ob_frame_take(ob_frame *f, ob_rect r)
{
	if (!OB_MAKE_ROOM(f->take, f->taken, f->taken_max))
		return false;
	f->take[f->taken++] = r;
	return true;
}
