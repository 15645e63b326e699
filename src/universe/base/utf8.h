// UTF-8 (RFC 3629: no overlong forms, no surrogates, up to U+10FFFF) in texts from outside, valid or not. Texts end
// with 0. Pure; any thread.
#ifndef OB_BASE_UTF8_H
#define OB_BASE_UTF8_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define OB_UTF8_REPLACEMENT 0xfffdu

// Bytes of the character at s; 1 for the final 0; 0 = not UTF-8.
size_t ob_utf8_length(const char *s);
// Code point of the character at s, and its bytes; OB_UTF8_REPLACEMENT and 1 if it is not UTF-8.
uint32_t ob_utf8_decode(const char *s, size_t *bytes);
// Characters of a text; a byte that is not UTF-8 counts as one.
size_t ob_utf8_count(const char *s);
// True if a terminal shows the character and does nothing else. Not plain: control characters of ASCII and Latin-1
// (C1), line and paragraph separators, and marks that change the direction of text (Unicode's UAX #9). With those, a
// name could make a line read as something else.
bool ob_utf8_is_plain(uint32_t code);
// Turns a text into one line of plain characters, in place: blanks for ASCII control characters, '?' for other
// characters that are not plain, or not UTF-8.
void ob_utf8_make_plain(char *text);

#endif
