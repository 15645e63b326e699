// Writer of Lua: text at its end, and random numbers in the order in which they are asked for.
#ifndef OB_TESTS_LIVES_WRITER_H
#define OB_TESTS_LIVES_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct writer {
	char *to;
	size_t size; // bytes of it
	int used;
	uint64_t seed;
} writer;

__attribute__((format(printf, 2, 3))) void put(writer *w, const char *format, ...);
double within(writer *w, double low, double high);
bool one_in(writer *w, unsigned n);
// " name = { x, y, z }," each between the two
void put_vector(writer *w, const char *name, double low, double high);

#endif
