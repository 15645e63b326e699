#include "paper/words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

ob_word ob_word_value(double v, ob_paper_metric m)
{
	return ob_word_metric(v, &ob_paper_metrics[m]);
}

// "1.9 to 2.4"; empty if unknown
static ob_word interval(double low, double high)
{
	ob_word w = { "no interval" };
	if (!isnan(low) && !isnan(high))
		snprintf(w.text, sizeof w.text, "%.20s to %.20s", ob_word_number(low).text, ob_word_number(high).text);
	return w;
}

ob_word ob_word_ratio(const ob_estimate *r)
{
	ob_word w;
	snprintf(w.text, sizeof w.text, "%.20s times (%.42s)", ob_word_number(r->value).text,
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
