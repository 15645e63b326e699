#include "base/number.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

ob_number ob_number_text(double x)
{
	ob_number out = { "nan" };
	for (int digits = 10; !isnan(x) && digits <= DBL_DECIMAL_DIG; digits++) {
		snprintf(out.text, sizeof out.text, "%.*g", digits, x);
		if (strtod(out.text, NULL) == x)
			break;
	}
	return out;
}
