// Methods of a run, and the experiments among them. An experiment shows what a property of the solver is worth. Each has a
// file of its own, and nothing else names it:
//
//   neighbours as ghosts, or seen late    ghost.h
//   boxes in place of shapes              boxes.h
//   ODE's integrator                      ode_bodies.h; for bodies that touch nothing step/worker.c
#ifndef OB_SOLVER_METHODS_H
#define OB_SOLVER_METHODS_H

#include "solver/solver.h"

// Returns the methods that the settings ask for. Pure function.
ob_methods ob_methods_of(const ob_run_settings *run);

#endif
