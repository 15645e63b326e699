// Estimate of a step's error that knows no law: the island is solved again with fewer substeps (solver/probe.h), and longer
// partial ones, and the distance of surfaces between both solutions counts. It bounds the error of the finer solution, as
// that of either falls with the substeps: at first order it is that error. Where substeps were refined (solver/refinement.h), twice the distance from a solution
// with twice as many counts, as fewer may be of another order. Where an estimate takes a second of few bodies beyond the
// tolerance, it is made with more substeps, too, and the smaller one counts. Once the seconds of all bodies exceed it, none is.
//
// It is made in one of 16 steps of an island, where it stands for them all. A step in which contacts of one or two bodies
// change, or the forces on one, has one of its own, which stands for no other; so has one in which a body lands among a few. Each body's motion
// carries the sums since the second began, of place and of velocity (motion/deviation.h). A hit hands the larger ones of both
// bodies on, and adds to the velocity's.
// A lone body that rolls, or that a surface drives, has more of it: a step in which contacts or forces change is solved again, with
// four times as many substeps, while its error is large and falls at least as their number grows. The last solution stands.
// Errors of one step decide it, by the first of two solutions beside: neither a second nor a unit has a part in it.
//
// Errors of velocity count as far as they last. Among more bodies, what contacts and joints would take back in the next step does not
// (solver/probe.h). A body that lies on a face of another moves as that one does. A body in contact counts by where it is, not by where
// it would get to: it may come to rest before the second ends.
//
// Ids and steps decide, so it is the same for any worker, rank, kill and resume.
#ifndef OB_SOLVER_ESTIMATE_H
#define OB_SOLVER_ESTIMATE_H

#include "solver/solver.h"

// Creates what a run with a tolerance needs for it. Returns false if there is no memory.
bool ob_estimate_create(ob_solver *s);
void ob_estimate_finish(ob_solver *s);

// Estimates the error of the island's solution if that is due, and solves it finer if that pays. Updates its bodies' deviations
// and refinement, and counts what is within the tolerance.
void ob_estimate_update(ob_solver *s);
// Deviation of a body, and the largest speed (m/s) of a point of its surface.
typedef struct ob_deviant {
	ob_deviation deviation;
	double speed;
} ob_deviant;

// Counts a body's second as unbounded when its deviation takes it beyond the tolerance first, and returns it. before: as published.
// flies: alone, so that its error of velocity lasts, and counts up to the second's end at once. The largest deviation is no more than the
// body moves in a second.
ob_deviation ob_estimate_count(ob_solver *s, uint64_t step, ob_deviant before, ob_deviant now, bool flies);

#endif
