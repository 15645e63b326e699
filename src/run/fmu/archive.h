// FMU: a controller or another model as a file, by the standard FMI (2.0 and 3.0, co-simulation). A zip archive of a
// description (modelDescription.xml) and of a shared library.
//
//   controller.fmu ──ob_fmu_read──> names, library ──scene──> ob_fmu_model + library, in the universe, like a script
//                                                             │
//   worker: ob_fmu_open ──> one instance for all objects <────┘   ob_fmu_run: state out of the cell, step, state back
//
// libzip and expat are in a part of the program (base/part.h), obsim-fmu.so, loaded for scenes that have FMUs.
#ifndef OB_FMU_ARCHIVE_H
#define OB_FMU_ARCHIVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>

#define OB_FMU_LIBRARY_BYTES ((size_t)8 << 20) // most of a shared library
#define OB_FMU_DESCRIPTION_BYTES ((size_t)4 << 20) // most of a description
#define OB_FMU_NAME_MAX 64 // bytes of the library name, with the final 0
#define OB_FMU_TOKEN_MAX 128 // bytes of the key (guid, instantiationToken), with the final 0

typedef enum ob_fmu_causality {
	OB_FMU_OTHER, // computed, or not to be set
	OB_FMU_INPUT,
	OB_FMU_OUTPUT,
	OB_FMU_PARAMETER
} ob_fmu_causality;

// A scalar variable of 64-bit floating point.
typedef struct ob_fmu_variable {
	char *name;
	uint32_t reference;
	ob_fmu_causality causality;
} ob_fmu_variable;

typedef struct ob_fmu_file {
	uint32_t standard; // 2 or 3
	char identifier[OB_FMU_NAME_MAX], token[OB_FMU_TOKEN_MAX];
	uint32_t variables;
	ob_fmu_variable *variable; // [variables]
	unsigned char *library; // for this kind of machine
	uint32_t library_bytes;
} ob_fmu_file;

// Reads an FMU that is in memory; nothing of it runs. false and e, and nothing in out: it is damaged, or not such an FMU,
// or cannot hand out its state.
bool ob_fmu_read(const unsigned char *bytes, size_t size, ob_fmu_file *out, ob_error *e);
void ob_fmu_finish(ob_fmu_file *f);

#endif
