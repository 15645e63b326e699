// A hard case: a scene (lab/scene.h), of scenes/lab/ or of a user, whose expectations are figures, each with its target.
//
// A case may consist of several runs (100 aims at a wall, three stacks). Its figures are the worst over all of them,
// except for averaged ones. Cases do not depend on engines: they read states.
#ifndef OB_LAB_CASE_H
#define OB_LAB_CASE_H

#include <stdio.h>

#include "engine/engine.h"
#include "lab/conservation.h"
#include "measure/measure.h"
#include "scene/scene.h"

enum { OB_FIGURES = 8 }; // per case, at most

typedef struct ob_figure_def {
	const char *name; // "worst penetration"
	const char *unit; // "mm", "1" for a ratio, "J", "rad"; as printed
	double target; // upper bound, in that unit, at 60 Hz; NAN = shown, but not promised
	const char *reference; // basis of comparison, and its source: "parabola", "Coulomb 1785: a = g (sin - mu cos)"
} ob_figure_def;

typedef struct ob_case_text ob_case_text;

typedef struct ob_case {
	int row; // in the table of hard cases
	const char *name; // as on the command line: "stack-10"
	const char *title; // "Stack of 10"
	const char *setup; // one or two sentences for the reader of the report
	const char *others; // figures seen with other engines; NULL: not measured elsewhere
	bool slow; // too slow for the subset that runs with the tests
	bool compared; // its cost at equal error is tabulated
	bool sleeps; // bodies at rest may sleep, whatever the settings
	double duration; // s
	uint32_t runs; // 0: one
	uint32_t figures; // plots show the first
	ob_figure_def figure[OB_FIGURES];
	unsigned averaged; // bit per figure: the mean over the runs counts, not the worst (a share)
	const ob_case_text *text; // its scene
} ob_case;

static const double ob_case_step = 1. / 60; // s: length of a frame

static inline uint32_t ob_case_runs(const ob_case *c)
{
	return c->runs ? c->runs : 1;
}

extern const ob_case *const *ob_cases; // in the order of their rows; ends with NULL
const ob_case *ob_case_find(const char *name);
// Reads those of the program, and of a user's files. Once, before others use the list. false and e: one is wrong.
bool ob_cases_open(const char *const *file, size_t files, ob_error *e);
// Digest of the texts of the user's files; 0: there are none.
uint32_t ob_cases_digest(void);

// Runs all of a case's runs with one engine. Returns false and e if the engine could not be created, or memory ran out.
// A run ends at its first failure. If the engine itself broke down (it gave up, NaN, faster than 1e5 m/s or rad/s), all
// figures are infinite.
typedef struct ob_case_result {
	double figure[OB_FIGURES];
	double conserved[OB_CONSERVED]; // worst of all runs; NAN: not conserved in the case's worlds
	double cpu_s, wall_s; // of stepping alone
	double body_seconds; // dynamic bodies times simulated time
	char failed[96]; // reason; "" = success
} ob_case_result;
bool ob_case_run(const ob_case *c, const ob_engine_kind *kind, const ob_run_settings *s, ob_case_result *out,
		 ob_error *e);
// Sets the figure to the larger of the two. NaN counts as the largest, and stays.
void ob_figure_keep(double *figure, double value);

// ---- list

// Cases and engines by their names on a command line. Pure except for printing; any thread.

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
