// Numbers of the command line, and quantities as people read them.
#ifndef OB_CLI_QUANTITY_H
#define OB_CLI_QUANTITY_H

#include <stdbool.h>
#include <stdint.h>

#include <ob/error.h>

// A number of the command line: the whole text must be one, within its range; false and e otherwise. text NULL leaves
// *out as it is. option (without dashes; "set lag" = a setting) is for the message.
bool ob_number_count(const char *option, const char *text, uint64_t least, uint64_t most, uint64_t *out, ob_error *e);
// Takes fractions, too: "1/60". above < value <= most.
bool ob_number_real(const char *option, const char *text, double above, double most, double *out, ob_error *e);

typedef struct ob_quantity {
	char text[32];
} ob_quantity;

// Three digits and the prefix that fits: 1.24e-6 "s" reads "1.24 us". Returns q->text; "-" for NaN. Values below a
// pico-unit are 0.
const char *ob_quantity_text(ob_quantity *q, double value, const char *unit);

#endif
