// Settings to run an engine at. Pure; any thread.
#ifndef OB_LAB_SWEEP_H
#define OB_LAB_SWEEP_H

#include "lab/case.h"

enum { OB_SWEEP_VALUES = 16, OB_SWEEP_SETTINGS = 288 }; // per setting; per engine and case

typedef struct ob_sweep {
	bool own; // a sensible default for each engine; the lists below are empty then
	struct {
		size_t n;
		double value[OB_SWEEP_VALUES];
	} of[OB_RUN_SETTINGS]; // substeps, iterations, tolerance (m) and lag
} ob_sweep;

// Parses "substeps=1,2,4,8,iterations=4,16,tolerance=5mm,.5mm,lag=0,1,2", each setting at most once; "none" = each
// engine's usual settings alone; NULL = a sensible default for each. Returns false and e if it is not valid.
bool ob_sweep_parse(ob_sweep *s, const char *text, ob_error *e);

// Lists the settings of an engine in a case without duplicates, the usual ones first: every number of substeps with
// every number of iterations, then the tolerances. Settings that an engine does not have keep their value. Returns
// their number; 0: the engine does not apply to this case.
size_t ob_sweep_settings(const ob_sweep *s, const ob_case *c, const ob_engine_kind *k,
			 ob_run_settings to[OB_SWEEP_SETTINGS]);

#endif
