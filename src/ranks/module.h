// What the module that knows MPI offers, by the name OB_WIRE_MODULE_ENTRY.
#ifndef OB_RANKS_MODULE_H
#define OB_RANKS_MODULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define OB_WIRE_MODULE "obsim-mpi.so"
#define OB_WIRE_MODULE_ENTRY "ob_wire_mpi"

typedef struct ob_wire_module {
	bool (*open)(uint32_t *rank, uint32_t *ranks);
	// size[r] := of each rank, the bytes that it has
	void (*sizes)(size_t mine, size_t *size);
	// From all into "all", where that of rank r begins at at[r] and ends at at[r + 1]
	void (*bytes)(const void *mine, char *all, const size_t *at);
	void (*close)(void);
} ob_wire_module;

#endif
