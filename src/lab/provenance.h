// Where results come from. Reads /proc; any thread.
#ifndef OB_LAB_PROVENANCE_H
#define OB_LAB_PROVENANCE_H

#include <stddef.h>

// Processor, cores that may be used, kernel
void ob_provenance_machine(char *to, size_t room);
// The commit of the program. Where that does not tell what was built ("unknown", or files differed from it: "..+"), the
// hash of the program's file stands behind it.
void ob_provenance_commit(const char *commit, char *to, size_t room);

#endif
