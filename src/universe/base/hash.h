// A hash of bytes that is the same on every machine: FNV-1a of 64 bits (Fowler, Noll and Vo). It detects accidental
// differences, not forged ones. Pure function.
#ifndef OB_BASE_HASH_H
#define OB_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

#define OB_HASH_BEGIN UINT64_C(0xcbf29ce484222325) // the hash of nothing

// Continues a hash with these bytes.
static inline uint64_t ob_hash_on(uint64_t hash, const void *bytes, size_t size)
{
	for (const unsigned char *at = bytes; size > 0; size--)
		hash = (hash ^ *at++) * UINT64_C(0x100000001b3);
	return hash;
}

#endif
