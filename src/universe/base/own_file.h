// Files of the program itself, found from where the program lies: parts, scenes.
#ifndef OB_BASE_OWN_FILE_H
#define OB_BASE_OWN_FILE_H

#include <limits.h>
#include <stdbool.h>

// Finds a file beside the program, in the folder "installed" (relative to the program's), or in the folder "built"
// (relative to the root of the build tree that holds the program). False if there is none. Any thread.
bool ob_own_file_find(char path[PATH_MAX], const char *installed, const char *built, const char *name);

#endif
