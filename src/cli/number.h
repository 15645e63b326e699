// Numbers of the command line: the whole text must be one, and within its range.
#ifndef OB_CLI_NUMBER_H
#define OB_CLI_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

#include <ob/error.h>

// text NULL leaves *out as it is. option (without dashes) is for the message.
bool ob_number_count(const char *option, const char *text, uint64_t least, uint64_t most, uint64_t *out, ob_error *e);
// Takes fractions, too: "1/60". above < value <= most.
bool ob_number_real(const char *option, const char *text, double above, double most, double *out, ob_error *e);

// A length with its unit, m, mm or um, in m. least <= value <= most.
bool ob_number_length(const char *option, const char *text, double least, double most, double *out, ob_error *e);

#endif
