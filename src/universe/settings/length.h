// Lengths as people write them, in scenes and on the command line alike. Pure; any thread.
#ifndef OB_SETTINGS_LENGTH_H
#define OB_SETTINGS_LENGTH_H

#include <stdbool.h>

// One of the two is above 0: a length (m), or a share of another length. Neither: not set.
typedef struct ob_length {
	double m, share;
} ob_length;

// Reads a length with its unit, or in metres, or a share up to 100%. The range of a length is the caller's.
bool ob_length_read(const char *text, ob_length *out);
#define OB_LENGTH_FORMS "a length, as .5mm or .0005 (m), or a share above 0%, up to 100%, as .1%"

#endif
