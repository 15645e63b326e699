#include "plot/ticks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static double transformed(ob_plot_scale scale, double v)
{
	return scale == OB_SCALE_LOG ? log10(v) : scale == OB_SCALE_LOG2 ? log2(v) : v;
}

double ob_ticks_along(const ob_ticks *t, double v)
{
	return (transformed(t->scale, v) - t->from) / (t->to - t->from);
}

static ob_tick *add(ob_ticks *t, double value, bool major)
{
	double at = (value - t->from) / (t->to - t->from);
	if (!(at >= -1e-9 && at <= 1 + 1e-9) || t->count == OB_TICKS_MAX)
		return NULL;
	t->tick[t->count] = (ob_tick){ .at = fmin(fmax(at, 0), 1), .major = major };
	return &t->tick[t->count++];
}

// A number with a minus that is as wide as a plus
static void print(char *to, size_t room, double v, int decimals, const char *behind)
{
	snprintf(to, room, "%s%.*f%s", v < 0 ? "\u2212" : "", decimals, fabs(v), behind);
}

// The step of 1, 2, 5 x 10^k that is nearest above "least", and its k
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

// Ticks at multiples of a step. On a logarithmic axis the values are placed by their logarithms.
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
		ob_tick *tick = add(t, transformed(t->scale, value), true);
		if (!tick)
			continue;
		if (k == 0) {
			strcpy(tick->text, "0");
		} else if (shown) {
			print(tick->text, sizeof tick->text, value / unit, decimals, "\u00d710");
			print(tick->super, sizeof tick->super, shown, 0, "");
		} else {
			print(tick->text, sizeof tick->text, value, decimals, "");
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
		print(tick->text, sizeof tick->text, digit * pow(10, power), power < 0 ? -power : 0, "");
	} else {
		if (digit == 1)
			strcpy(tick->text, "10");
		else
			print(tick->text, sizeof tick->text, digit, 0, "\u00d710");
		print(tick->super, sizeof tick->super, power, 0, "");
	}
}

// Decades, or every so many of them where there are many; 1-2-5 where there are few.
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
			ob_tick *tick = add(t, power + log10(digit), major);
			if (tick && major)
				label_decimal(tick, digit, power, plain);
		}
	}
}

static void add_powers_of_two(ob_ticks *t, int wanted)
{
	int stride = 1 + (int)((t->to - t->from) / (wanted + 1));
	for (int power = (int)floor(t->from); power <= t->to && power < t->from + 1 + OB_TICKS_MAX * stride; power++) {
		ob_tick *tick = power % stride ? NULL : add(t, power, true);
		if (!tick)
			continue;
		if (power >= 0 && power <= 16) {
			print(tick->text, sizeof tick->text, ldexp(1, power), 0, "");
		} else if (power < 0 && power >= -4) {
			print(tick->text, sizeof tick->text, ldexp(1, power), -power, "");
		} else {
			strcpy(tick->text, "2");
			print(tick->super, sizeof tick->super, power, 0, "");
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
