// Runs one trial in a process of its own, and records its result. Internal to the module.
#ifndef OB_EXPERIMENT_TRIAL_H
#define OB_EXPERIMENT_TRIAL_H

#include "experiment/experiment.h"
#include "experiment/process.h"

// Empty record of a trial; marked with machine and commit of "of".
ob_record ob_trial_record(const ob_records *of, const ob_trial *t);
// Limit of wall-clock time (s); CPU time is the actual limit.
double ob_trial_wall_limit(const ob_experiment *x);
// Runs a trial. meanwhile: callbacks (tick, hear); the rest is ignored. Returns false and e on a failure that is not
// the trial's own.
bool ob_trial_run(const ob_experiment *x, const ob_trial *t, const ob_process *meanwhile, ob_record *r, ob_error *e);

#endif
