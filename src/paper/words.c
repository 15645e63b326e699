#include "paper/words.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "experiment/page.h"

void ob_say(char *to, size_t room, const char *format, ...)
{
	size_t used = strlen(to);
	va_list args;
	va_start(args, format);
	vsnprintf(to + used, room - used, format, args);
	va_end(args);
}

ob_word ob_word_number(double v)
{
	ob_word w;
	ob_page_print_quantity(w.text, sizeof w.text, v, "1");
	return w;
}

ob_word ob_word_value(double v, ob_paper_metric m)
{
	ob_word w;
	const ob_metric *def = &ob_paper_metrics[m];
	ob_page_print_quantity(w.text, sizeof w.text, v * def->scale, def->unit);
	return w;
}

// "1.9 to 2.4"; empty if unknown
static ob_word interval(double low, double high)
{
	ob_word w = { "no interval" };
	if (!isnan(low) && !isnan(high))
		snprintf(w.text, sizeof w.text, "%.20s to %.20s", ob_word_number(low).text, ob_word_number(high).text);
	return w;
}

ob_word ob_word_ratio(const ob_paper_ratio *r)
{
	ob_word w;
	snprintf(w.text, sizeof w.text, "%.20s times (%.42s)", ob_word_number(r->mean).text,
		 interval(r->low, r->high).text);
	return w;
}

ob_word ob_word_exponent(const ob_line *l)
{
	ob_word w;
	snprintf(w.text, sizeof w.text, "n^%.2f (%.2f to %.2f)", l->slope, l->slope_low, l->slope_high);
	return w;
}

ob_word ob_word_odds(double logarithm)
{
	static const double most = 1e6;
	ob_word w = { "more than a million to 1" };
	double odds = exp(fabs(logarithm));
	if (odds <= most)
		snprintf(w.text, sizeof w.text, "%.0f to 1", odds);
	return w;
}
