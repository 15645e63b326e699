#include "cli/quantity.h"

#include <math.h>
#include <stdio.h>

const char *ob_quantity_text(ob_quantity *q, double value, const char *unit)
{
	static const char *const prefixes[] = { "p", "n", "u", "m", "", "k", "M", "G", "T" };
	enum { UNITY = 4, LAST = sizeof prefixes / sizeof *prefixes - 1 };
	double size = fabs(value);
	if (isnan(value)) {
		snprintf(q->text, sizeof q->text, "-");
		return q->text;
	}
	if (size < 1e-12)
		value = size = 0;
	int p = UNITY;
	while (size > 0 && size < .9995 && p > 0) {
		size *= 1e3;
		value *= 1e3;
		p--;
	}
	while (size >= 999.5 && p < LAST) {
		size /= 1e3;
		value /= 1e3;
		p++;
	}
	int digits = size >= 99.95 || size == 0 ? 0 : size >= 9.995 ? 1 : 2;
	if (size < 1e4)
		snprintf(q->text, sizeof q->text, "%.*f %s%s", digits, value, prefixes[p], unit);
	else
		snprintf(q->text, sizeof q->text, "%.3g %s%s", value, prefixes[p], unit);
	return q->text;
}
