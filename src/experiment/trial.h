// One trial in a process of its own, and the record that comes of it. Internal to the module.
#ifndef OB_EXPERIMENT_TRIAL_H
#define OB_EXPERIMENT_TRIAL_H

#include "experiment/experiment.h"
#include "experiment/process.h"

// Of a trial that has not been run; marked with machine and commit of "of".
ob_record ob_trial_record(const ob_records *of, const ob_trial *t);
// CPU time decides; so much wall-clock time it may take, s.
double ob_trial_wall_limit(const ob_experiment *x);
// Runs it. meanwhile: what else is to be done (tick, hear), the rest is not looked at. false and e: it is not the trial
// that failed.
bool ob_trial_run(const ob_experiment *x, const ob_trial *t, const ob_process *meanwhile, ob_record *r, ob_error *e);

#endif
