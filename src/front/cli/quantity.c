#include "cli/quantity.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The mark between an option and its value.
static const char *mark(const char *option)
{
	return strncmp(option, "set ", 4) == 0 ? "=" : " ";
}

bool ob_number_count(const char *option, const char *text, uint64_t least, uint64_t most, uint64_t *out, ob_error *e)
{
	if (!text)
		return true;
	char *end;
	errno = 0;
	uint64_t n = strtoull(text, &end, 10);
	if (!isdigit((unsigned char)*text) || *end)
		return ob_fail(e, "--%s%s%s: expected a whole number", option, mark(option), text);
	if (errno || n < least || n > most)
		return ob_fail(e, "--%s%s%s: expected %" PRIu64 " to %" PRIu64, option, mark(option), text, least,
			       most);
	*out = n;
	return true;
}

// A decimal number at *text, which moves behind it; NaN if there is none. No hex, no inf, no blanks.
static double read_decimal(const char **text)
{
	const char *digits = *text + (**text == '-' || **text == '+');
	if (!isdigit((unsigned char)*digits) && *digits != '.')
		return NAN;
	if (digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X'))
		return NAN;
	char *end;
	double x = strtod(*text, &end);
	if (end == *text)
		return NAN;
	*text = end;
	return x;
}

bool ob_number_real(const char *option, const char *text, double above, double most, double *out, ob_error *e)
{
	if (!text)
		return true;
	const char *at = text;
	double x = read_decimal(&at);
	if (*at == '/') {
		at++;
		x /= read_decimal(&at);
	}
	if (isnan(x) || *at)
		return ob_fail(e, "--%s%s%s: expected a number, as .5 or 1/60", option, mark(option), text);
	if (!(x > above && x <= most))
		return ob_fail(e, "--%s%s%s: expected more than %g, at most %g", option, mark(option), text, above,
			       most);
	*out = x;
	return true;
}

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
