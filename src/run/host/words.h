// Text that child processes write on standard error, on its way to the host's.
#ifndef OB_HOST_WORDS_H
#define OB_HOST_WORDS_H

#include <stddef.h>

// Writes to standard error as much as it takes now, without blocking.
void ob_words_hand_on(const char *text, size_t n);

#endif
