// Compares the printed output of a function with the expected one: FILE *f = begin(); print(f); expect(f, "...");
#ifndef OB_TESTS_PRINTED_H
#define OB_TESTS_PRINTED_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"

static char *text;
static size_t length;

static FILE *begin(void)
{
	FILE *f = open_memstream(&text, &length);
	if (!f)
		abort();
	return f;
}

static void expect(FILE *f, const char *what)
{
	fclose(f);
	if (strcmp(text, what) != 0)
		fprintf(stderr, "printed:\n%s\ninstead of:\n%s\n", text, what);
	CHECK(strcmp(text, what) == 0);
	free(text);
}

#endif
