// Checks of objects that are to exist. Pure functions.
#ifndef OB_HOST_OBJECT_CHECK_H
#define OB_HOST_OBJECT_CHECK_H

#include "scene/scene.h"

// True if the object is within the limits (scene/object_limits.h) and its name ends; e names it, and what is not.
bool ob_object_check(const ob_object_def *def, ob_error *e);
// Same for the properties that a checkpoint has of an object.
bool ob_object_check_saved(const ob_passport *p, ob_error *e);

#endif
