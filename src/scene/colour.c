#include "scene/colour.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

void ob_colour_from_srgb(const double rgba[4], float linear[4])
{
	for (int i = 0; i < 3; i++) // IEC 61966-2-1
		linear[i] = (float)(rgba[i] <= .04045 ? rgba[i] / 12.92 : pow((rgba[i] + .055) / 1.055, 2.4));
	linear[3] = (float)rgba[3];
}

static int digit(char c)
{
	return isdigit((unsigned char)c) ? c - '0' : tolower((unsigned char)c) - 'a' + 10;
}

bool ob_colour_from_hex(const char *text, float linear[4])
{
	size_t n = strlen(text);
	if (text[0] != '#' || (n != 7 && n != 9))
		return false;
	double rgba[4] = { 0, 0, 0, 1 };
	for (size_t i = 1; i < n; i += 2) {
		if (!isxdigit((unsigned char)text[i]) || !isxdigit((unsigned char)text[i + 1]))
			return false;
		rgba[i / 2] = (16 * digit(text[i]) + digit(text[i + 1])) / 255.;
	}
	ob_colour_from_srgb(rgba, linear);
	return true;
}
