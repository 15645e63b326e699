// Expectations of a scene for its run: expect { "way", below = .01, function(run) return ... end }. The functions are
// called while the run goes on, with what is measured of its snapshots, in the sandbox of the scene.
//
//      scene is read                  case, watch, expect: kept, with the sandbox
//      each step of the run           ob_expected_look: watches, and expectations with worst = true
//      its end, or its failure        ob_expected_end: the other expectations
//
// Thread-safety: one thread at a time per scene.
#ifndef OB_SCENE_EXPECT_H
#define OB_SCENE_EXPECT_H

#include "measure/measure.h"
#include "scene/scene.h"

enum {
	OB_EXPECTATIONS_MAX = 8, // in a scene, as figures in a case of the lab
	OB_CASE_RUNS_MAX = 100,
	OB_CASE_VARIANTS_MAX = 16,
	OB_CASE_NAME = 32,
};

typedef struct ob_expectation {
	char name[64], unit[16], source[160]; // "worst penetration", "mm", "no penetration"
	double limit; // the value is at most this; NaN: shown, but not promised
	bool worst; // looked at in each step: the largest counts, and 0 where all are below
	bool mean; // over the runs of a case the mean counts, not the worst
	int line, function; // of the scene; of Lua's registry
	double value; // so far
} ob_expectation;

// A scene as a case of the lab: case { ... }.
typedef struct ob_case_def {
	char name[OB_CASE_NAME]; // the file's, or the variant's
	char setup[600], others[160]; // for readers of the report; figures seen with other engines; "" = not known
	uint32_t row; // in the table of hard cases; 0: none
	uint32_t runs, run; // number of runs; this one, from 0
	bool slow, compared, sleeps;
	uint32_t variants;
	char variant[OB_CASE_VARIANTS_MAX][OB_CASE_NAME]; // their names
} ob_case_def;

// The expectations of a scene, and how they stand.
struct ob_expected {
	ob_case_def of;
	uint32_t count;
	ob_expectation expectation[OB_EXPECTATIONS_MAX];
	char failed[64]; // run:fail("fell"): the first text; "" = it did not fail
	bool ended; // final
	// private to expect.c
	struct ob_sandbox *sandbox; // set when the scene has been read
	const ob_scene *scene;
	const ob_snapshot *now; // during a call
	const ob_run_settings *settings; // likewise
	int watches, watch[OB_EXPECTATIONS_MAX], watch_line[OB_EXPECTATIONS_MAX], run;
	double got;
	char said[112]; // the value of a function, if it is no number; "" = it is one
};

// Looks at a snapshot of the run; the first is that of the start. settings: of the run. false and e, "file:line: ...": a
// function failed, or returned no number.
bool ob_expected_look(ob_expected *x, const ob_snapshot *now, const ob_run_settings *settings, ob_error *e);
// Looks at the last one, which ob_expected_look has seen. Has no effect after a failure of the run.
bool ob_expected_end(ob_expected *x, const ob_snapshot *now, const ob_run_settings *settings, ob_error *e);
// True if the value is within its limit, or has none.
bool ob_expectation_is_met(const ob_expectation *x);
void ob_expected_free(ob_expected *x); // NULL is allowed

#endif
