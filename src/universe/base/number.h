// Numbers in messages. Pure; any thread.
#ifndef OB_BASE_NUMBER_H
#define OB_BASE_NUMBER_H

typedef struct ob_number {
	char text[32];
} ob_number;

// The shortest decimal that reads back as x, so that numbers that differ look different: "0.1", "0.30000000000000004"; "nan" has
// no sign, which differs between machines. For a call of printf: ob_number_text(x).text
ob_number ob_number_text(double x);

#endif
