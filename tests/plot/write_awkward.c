// write_awkward DIR: all awkward diagrams as NUMBER-NAME.svg and .png; for check_files.py.
#include <stdio.h>

#include "awkward.h"

int main(int argc, char **argv)
{
	static awkward a;
	for (int i = 0; argc == 2 && awkward_make(&a, i); i++) {
		char path[4096];
		ob_error e = { "" };
		snprintf(path, sizeof path, "%s/%02d-%s.svg", argv[1], i, a.name);
		bool ok = ob_plot_svg(&a.plot, path, &e);
		snprintf(path, sizeof path, "%s/%02d-%s.png", argv[1], i, a.name);
		ok = ok && ob_plot_png(&a.plot, path, i % 3 ? 1 : 2, &e);
		if (!ok) {
			fprintf(stderr, "%s\n", e.text);
			return 1;
		}
	}
	ob_error e = { "" };
	awkward_make(&a, 0);
	// an unwritable place is an error that names it
	if (ob_plot_svg(&a.plot, "/dev/null/x.svg", &e) || ob_plot_png(&a.plot, "/dev/null/x.png", 1, &e) || !e.text[0])
		return 1;
	return argc != 2;
}
