#include "experiment/words.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void ob_say(char *to, size_t room, const char *format, ...)
{
	size_t used = strlen(to);
	va_list args;
	va_start(args, format);
	vsnprintf(to + used, room - used, format, args);
	va_end(args);
}

// True if v is easier to read as digits than with an exponent.
static bool is_plain(double v)
{
	return v == 0 || (fabs(v) >= 9.995e-4 && fabs(v) < 99950);
}

// Prints three digits, as "0.412", "35.9", "12400".
static void print_plain(char *to, size_t room, double v)
{
	int before = v == 0 ? 1 : (int)floor(log10(fabs(v) * 1.0005)) + 1; // digits before the point
	int behind = before >= 3 ? 0 : 3 - before;
	snprintf(to, room, "%.*f", behind, v);
	char *point = strchr(to, '.');
	for (char *end = to + strlen(to) - 1; point && (*end == '0' || *end == '.'); end--) {
		bool was_point = *end == '.';
		*end = 0;
		if (was_point)
			break;
	}
}

// Splits v into a mantissa and a power of ten, rounded to three digits.
static int split(double v, double *mantissa)
{
	char text[40];
	snprintf(text, sizeof text, "%.2e", v);
	char *e = strchr(text, 'e');
	int power = atoi(e + 1);
	*e = 0;
	*mantissa = atof(text);
	return power;
}

ob_word ob_word_unit(const char *unit)
{
	ob_word w = { "" };
	for (; *unit; unit++) {
		const bool raised = *unit == '^' && (unit[1] == '2' || unit[1] == '3');
		unit += raised;
		OB_SAY(w.text, "%.*s", raised ? 2 : 1, !raised ? unit : *unit == '2' ? "\u00b2" : "\u00b3");
	}
	return w;
}

// Prints "1e-6", not "1e-06".
static void print_short(char *to, size_t room, double v)
{
	double mantissa;
	if (isfinite(v)) {
		int power = split(v, &mantissa);
		snprintf(to, room, "%.3ge%d", mantissa, power);
	} else {
		snprintf(to, room, "%s", isnan(v) ? "\u2013" : "\u221e");
	}
}

ob_word ob_word_quantity(double v, const char *unit)
{
	ob_word w;
	if (is_plain(v))
		print_plain(w.text, sizeof w.text, v);
	else
		print_short(w.text, sizeof w.text, v);
	if (strcmp(unit, "1"))
		OB_SAY(w.text, " %s", ob_word_unit(unit).text);
	return w;
}

ob_word ob_word_number(double v)
{
	return ob_word_quantity(v, "1");
}

ob_word ob_word_metric(double v, const ob_metric *m)
{
	return ob_word_quantity(v * m->scale, m->unit);
}

void ob_word_wrap(FILE *f, const char *before, const char *text, size_t width)
{
	size_t used = 0;
	while (*(text += strspn(text, " "))) {
		const size_t bytes = strcspn(text, " ");
		size_t letters = 0;
		for (size_t i = 0; i < bytes; i++)
			letters += (text[i] & 0xc0) != 0x80; // UTF-8
		const bool on = used && used + 1 + letters <= width;
		fprintf(f, "%s%s%.*s", on ? " " : used ? "\n" : "", on ? "" : before, (int)bytes, text);
		used = (on ? used + 1 : 0) + letters;
		text += bytes;
	}
	if (used)
		fputc('\n', f);
}
