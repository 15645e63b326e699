// Which settings an engine is run at. Pure; any thread.
#ifndef OB_LAB_SWEEP_H
#define OB_LAB_SWEEP_H

#include "lab/case.h"

enum { OB_SWEEP_VALUES = 16, OB_SWEEP_SETTINGS = 288 }; // of one knob; of one engine in one case

typedef struct ob_sweep {
	bool own; // what is sensible for each engine; the lists below are empty then
	size_t substeps, iterations, tolerances, lags;
	uint32_t substeps_list[OB_SWEEP_VALUES], iterations_list[OB_SWEEP_VALUES], lag_list[OB_SWEEP_VALUES];
	double tolerance_list[OB_SWEEP_VALUES]; // m
} ob_sweep;

// "substeps=1,2,4,8,iterations=4,16,tolerance=5mm,.5mm,lag=0,1,2", each knob at most once; "none" = nothing but each
// engine's usual settings; NULL = what is sensible for each. false and e: not understood.
bool ob_sweep_parse(ob_sweep *s, const char *text, ob_error *e);

// The settings of an engine in a case, none twice, the usual ones first: every number of substeps with every number of
// iterations, then the tolerances. A knob that an engine does not have stays as it is. Returns how many; 0: this
// engine has nothing to do in this case.
size_t ob_sweep_settings(const ob_sweep *s, const ob_case *c, const ob_engine_kind *k,
			 ob_run_settings to[OB_SWEEP_SETTINGS]);


#endif
