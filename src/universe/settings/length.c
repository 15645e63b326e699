#include "settings/length.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool ob_length_read(const char *text, ob_length *out)
{
	static const struct {
		const char *name;
		double metres;
	} units[] = { { "", 1 }, { "m", 1 }, { "cm", 1e-2 }, { "mm", 1e-3 }, { "um", 1e-6 }, { "nm", 1e-9 } };
	char *unit;
	const bool hexadecimal = text[0] == '0' && tolower((unsigned char)text[1]) == 'x';
	if (hexadecimal || (!isdigit((unsigned char)text[0]) && text[0] != '.'))
		return false; // nor a sign, a blank, nan or inf
	const double x = strtod(text, &unit);
	if (unit == text || !isfinite(x))
		return false;
	unit += strspn(unit, " ");
	*out = (ob_length){ .share = x / 100 };
	if (strcmp(unit, "%") == 0)
		return out->share > 0 && out->share <= 1;
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (strcmp(unit, units[i].name) == 0) {
			*out = (ob_length){ .m = x * units[i].metres };
			return true;
		}
	return false;
}
