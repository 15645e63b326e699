// Fake engines for tests: one that moves by a closed form, and broken ones.
#ifndef OB_TESTS_LAB_FAKE_ENGINE_H
#define OB_TESTS_LAB_FAKE_ENGINE_H

#include "exact.h"

extern const ob_engine_kind exact_engine;
void exact_engine_use(exact_motion motion); // from now on, in all engines

extern const ob_engine_kind frozen_engine; // nothing ever moves
extern const ob_engine_kind blind_engine; // no contacts: each falls as if alone
extern const ob_engine_kind drunk_engine; // gives NaN from the third frame on
extern const ob_engine_kind bursting_engine; // accelerates without end
extern const ob_engine_kind dying_engine; // gives up in the third frame

#endif
