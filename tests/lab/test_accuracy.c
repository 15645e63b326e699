// accuracy CASE: obsim at its usual settings meets all targets of the case. Cost is ignored.
#include <string.h>

#include "check.h"
#include "lab/case.h"

int main(int argc, char **argv)
{
	ob_error e = { "" };
	const ob_case *c = argc == 2 && ob_cases_open(NULL, 0, &e) ? ob_case_find(argv[1]) : NULL;
	if (!c) {
		fprintf(stderr, "usage: accuracy CASE\n%s\n", e.text);
		return 2;
	}
	const ob_engine_kind *kind = ob_engine_find(strcmp(c->name, "lag") ? "obsim" : "obsim-lag");
	ob_run_settings settings = kind->usual;
	settings.lag = 0; // the targets hold for engines without late partners
	ob_case_result out;
	if (!ob_case_run(c, kind, &settings, &out, &e)) {
		fprintf(stderr, "%s\n", e.text);
		return 1;
	}
	printf("row %d, %s: %.2f s of CPU\n", c->row, c->title, out.cpu_s);
	for (uint32_t i = 0; i < c->figures; i++) {
		const ob_figure_def *f = &c->figure[i];
		bool missed = !isnan(f->target) && !(out.figure[i] <= f->target);
		printf("%s %-36s %.3g %s", missed ? "*" : " ", f->name, out.figure[i], f->unit);
		if (isnan(f->target))
			printf("\n");
		else
			printf(" (at most %.3g)\n", f->target);
		CHECK(!missed);
	}
	if (*out.failed)
		printf("* %s\n", out.failed);
	CHECK(!*out.failed);
	return check_end();
}
