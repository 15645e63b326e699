// Measurements along a run: from successive snapshots to the figures of the report.
#ifndef OB_CLI_OBSERVE_H
#define OB_CLI_OBSERVE_H

#include <stdio.h>

#include "checkpoint/saved_run.h"
#include "cli/report.h"
#include "host/host.h"
#include "measure/measure.h"
#include "scene/scene.h"

typedef struct ob_observer {
	ob_vec3 gravity;
	bool started;
	bool energy_stays; // no objects are added or removed, no force changes in time, so that energy only falls
	bool closed; // no external forces, so that momentum is constant
	uint64_t last_step;
	double energy_start, energy, energy_top; // J
	ob_vec3 momentum_start; // kg m/s
	double momentum_scale; // kg m/s, sum of the sizes at the start
	double momentum_error; // largest so far, relative to the scale
	ob_penetration now;
	double worst, worst_time; // m, s; NaN: too much work to measure
	FILE *series; // a line for each snapshot; NULL = none
	const char *series_path;
} ob_observer;

// Logs a warning if objects of the universe, which has not begun, are inside each other by more than what contacts
// explain. An observer does so by itself.
void ob_warn_of_overlap(ob_host *h);
// path: the CSV file, which outlives the observer; NULL = none
bool ob_observer_open(ob_observer *o, const ob_scene *scene, const char *path, ob_error *e);
// For a checkpoint at the step of the last snapshot. A run that resumes there measures it again.
void ob_observer_save(const ob_observer *o, ob_saved_figures *out);
void ob_observer_resume(ob_observer *o, const ob_saved_figures *from);
// Measures a snapshot; the first is the start. Skips one that has been measured already. If penetration is too much
// work to measure, it warns once, and penetration is NaN from then on. false and e: the host is interrupted.
bool ob_observer_measure(ob_observer *o, const ob_snapshot *s, const ob_host *host, ob_error *e);
// Puts the figures into the report. each_step: every step was measured, so that maxima are valid.
void ob_observer_report(const ob_observer *o, bool each_step, ob_report *r);
bool ob_observer_close(ob_observer *o, ob_error *e); // once, also after a failed open

#endif
