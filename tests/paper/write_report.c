// write_report DIR: the report of made-up results, for check_report.py.
#include <stdio.h>
#include <string.h>

#include "made.h"
#include "paper/paper.h"

static double line(double n)
{
	return .01 * n;
}

int main(int argc, char **argv)
{
	ob_error e = { "" };
	if (argc != 2)
		return 2;
	ob_paper_results r = made_alike();
	made_growth(&r, OB_PAPER_COMMON, line);
	made_growth(&r, OB_PAPER_OBS, line);
	r.records.record[3].failure = OB_FAILURE_CRASH;
	strcpy(r.records.record[3].reason, "killed by \"signal\" <9>, alas");
	bool fine = ob_paper_report(&r, argv[1], &e);
	ob_records_finish(&r.records);
	if (!fine)
		fprintf(stderr, "%s\n", e.text);
	return !fine;
}
