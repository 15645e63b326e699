// UTF-8, as texts from outside may or may not be.
#ifndef OB_BASE_UTF8_H
#define OB_BASE_UTF8_H

// Bytes of the character at s, a text that ends with 0; 0 = not one (RFC 3629: no overlong forms, no surrogates, up to
// U+10FFFF).
int ob_utf8_length(const unsigned char *s);

#endif
