// The scenes that come with obsim: found by name, in the folder that is installed or in that of a build tree.
#ifndef OB_CLI_SHIPPED_H
#define OB_CLI_SHIPPED_H

#include <limits.h>
#include <stdbool.h>

// Path of a scene: the file with this name, or the scene of this name, or of scenes/NAME.lua or scenes/lab/NAME.lua, that comes with obsim; NULL for
// NULL. Valid until the next call of this thread.
const char *ob_shipped_find(const char *name);

#endif
