// Engines for tests that know no physics: one that moves as a closed form says, and four that are broken.
#ifndef OB_TESTS_LAB_FAKE_ENGINE_H
#define OB_TESTS_LAB_FAKE_ENGINE_H

#include "exact.h"

extern const ob_engine_kind exact_engine;
void exact_engine_use(exact_motion motion); // from now on, by all of them

extern const ob_engine_kind frozen_engine; // nothing ever moves
extern const ob_engine_kind blind_engine; // no contacts: all fall as if alone
extern const ob_engine_kind drunk_engine; // gives NaN from the third frame on
extern const ob_engine_kind bursting_engine; // ever faster
extern const ob_engine_kind dying_engine; // breaks off in the third frame

#endif
