// Line of progress, common to all commands.
#include <math.h>
#include <string.h>

#include "check.h"
#include "experiment/progress.h"

static void expect(double done, double all, double left, const char *line)
{
	char text[200];
	ob_progress_print(text, sizeof text, done, all, left, "pile, obsim");
	if (strcmp(text, line) != 0)
		fprintf(stderr, "'%s' instead of '%s'\n", text, line);
	CHECK(strcmp(text, line) == 0);
}

int main(void)
{
	expect(0, 40, NAN, "[                    ] 0 of 40, - left: pile, obsim");
	expect(10, 40, 42.4, "[#####               ] 10 of 40, 42 s left: pile, obsim");
	expect(40, 40, 182, "[####################] 40 of 40, 3 min 2 s left: pile, obsim");
	expect(1, 2, 7200, "[##########          ] 1 of 2, 2.0 h left: pile, obsim");
	return check_end();
}
