// A model of the tests: its variables by reference, all of them 64-bit numbers, and its step. fmi2.c and fmi3.c give it
// the interface of an FMU.
#ifndef TESTS_FMU_MODEL_H
#define TESTS_FMU_MODEL_H

#include <stdbool.h>

#include "fmu/fmi.h"

enum { MODEL_VALUES = 8 };

extern const double model_start[MODEL_VALUES];
// From time to time + length, s. false: it reports an error.
bool model_step(double value[MODEL_VALUES], double time, double length);

// Called at further moments, by a model that has them: when it is instantiated, initialized, freed; when its state is taken.
__attribute__((weak)) void model_at(const char *moment);
__attribute__((weak)) void model_give_state(const double value[MODEL_VALUES]);
static inline void model_pass(const char *moment)
{
	if (model_at)
		model_at(moment);
}

#define EXPORT __attribute__((visibility("default")))

#endif
