// Deeds of three visitors of a life: 1 watches, 2 takes part, 3 operates. Their requests take the way of viewers' commands.
#ifndef OB_TESTS_LIVES_DEEDS_H
#define OB_TESTS_LIVES_DEEDS_H

#include "run.h"

// false: the run has failed.
bool deed_happen(run *r, const life_event *event);

#endif
