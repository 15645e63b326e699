// Looks of a model's bodies as binary glTF. Internal to the module.
#ifndef OB_IMPORT_LOOK_H
#define OB_IMPORT_LOOK_H

#include "import/load.h"

#include <ob/motion.h>

// Writes the geometries first .. end-1 that are looks alone, or all of them if all collide, in the frame of their object.
// Returns false and e if the file cannot be written.
bool ob_look_write(const ob_drawn *d, int first, int end, const ob_pose *object, const char *file, ob_error *e);

#endif
