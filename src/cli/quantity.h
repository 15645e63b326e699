// Figures for people: three digits and the prefix that fits. 1.24e-6 "s" reads "1.24 us".
#ifndef OB_CLI_QUANTITY_H
#define OB_CLI_QUANTITY_H

typedef struct ob_quantity {
	char text[32];
} ob_quantity;

// Returns q->text; "-" for NaN. What is smaller than a pico-unit is 0.
const char *ob_quantity_text(ob_quantity *q, double value, const char *unit);

#endif
