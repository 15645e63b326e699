// Cases and engines by their names on a command line. Pure except for printing; any thread.
#ifndef OB_LAB_LIST_H
#define OB_LAB_LIST_H

#include <stdio.h>

#include "lab/case.h"

enum { OB_LIST_CASES = 128, OB_LIST_ENGINES = 32 };

typedef struct ob_case_list {
	size_t count;
	const ob_case *of[OB_LIST_CASES]; // in the order of ob_cases, without duplicates
} ob_case_list;

// Adds the cases that match a word: the one of this name; those of this row of the table of hard cases ("14"); those
// with a matching name ("*-10") or prefix ("stack"). Returns false if there are none.
bool ob_list_add_cases(ob_case_list *l, const char *word);
void ob_list_add_all(ob_case_list *l, bool quick_only);

typedef struct ob_engine_list {
	size_t count;
	const ob_engine_kind *of[OB_LIST_ENGINES]; // in the order of ob_engine_kinds, without duplicates
} ob_engine_list;

// Reads "all" (but free simulators, for two runs of them differ), or names with commas; "free": all free simulators. Returns false and *unknown (a copy in "word") for an unknown engine.
bool ob_list_engines(ob_engine_list *l, const char *names, char word[64]);

// Prints row, name, title, targets; * marks the quick subset.
void ob_list_print(FILE *f, const ob_case_list *l);

#endif
