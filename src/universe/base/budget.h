// Budget of what files may make of the program: memory, and CPU time. A file may come from anybody, and name others. All
// readers ask here before they take memory in proportion to what a file says, so that all files together stay below it,
// whatever they are. Limits of a reader's own (docs/reliability.md) bound the rest: sizes of files, counts.
//
// Memory is what the allocator holds more than when the thread began to read: what is freed counts no more, and nobody keeps
// accounts. Thread-safe; what other threads take meanwhile counts, too. While nothing is read, as in a script, each request
// counts alone: what a script does depends on no other memory.
#ifndef OB_BASE_BUDGET_H
#define OB_BASE_BUDGET_H

#include <stdbool.h>
#include <stdint.h>

#include <ob/error.h>

#include "base/sanitizer.h"

#define OB_BUDGET_BYTES ((uint64_t)768 << 20)
// s of CPU, for a file with all that it names. A sanitizer needs three times as much for the same.
#if OB_SANITIZED
#define OB_BUDGET_SECONDS 30
#else
#define OB_BUDGET_SECONDS 10
#endif

// Begins to read a file, or a text that stands for one, with all that it names; ends. A file within another, as a checkpoint's
// scene, shares its budget.
void ob_budget_begin(void);
void ob_budget_end(void);
// True if so many bytes more fit; else e: "it needs more than 768 MiB of memory". A sanitizer's allocator counts nothing.
bool ob_budget_allows(uint64_t bytes, ob_error *e);

#endif
