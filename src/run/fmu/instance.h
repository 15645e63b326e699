// An FMU that runs: its library, and an instance of it that takes the state of one object after the other. The state lies
// outside between two steps, as bytes; so any process can run any object, and none is missed.
//
// The library is foreign code. It runs in a process of its own (script/foreign.c), which is ended by a kill alone:
// nothing is freed.
//
// Thread-safety: one thread.
#ifndef OB_FMU_INSTANCE_H
#define OB_FMU_INSTANCE_H

#include <stdbool.h>
#include <stdint.h>

#include <ob/error.h>

#include "fmu/archive.h"

enum { OB_FMU_INPUTS_MAX = 16, OB_FMU_OUTPUTS_MAX = 8, OB_FMU_STATE_BYTES = 1024 };

// First byte of a model's form in memory; no text begins with it.
#define OB_FMU_MARK 0x7f

typedef struct ob_fmu_port {
	uint32_t reference; // of the variable
	uint32_t quantity; // the user's number for what it is connected with
} ob_fmu_port;

// An FMU that is connected, as the universe keeps it; `library_bytes` follow.
typedef struct ob_fmu_model {
	uint8_t mark, standard, inputs, outputs; // standard: 2 or 3
	uint32_t library_bytes;
	ob_fmu_port input[OB_FMU_INPUTS_MAX], output[OB_FMU_OUTPUTS_MAX];
	char identifier[OB_FMU_NAME_MAX], token[OB_FMU_TOKEN_MAX];
} ob_fmu_model;

// A value that a variable has from the start.
typedef struct ob_fmu_start {
	uint32_t reference, zero;
	double value;
} ob_fmu_start;

typedef struct ob_fmu_turn {
	double time, length; // s: the step that begins
	double input[OB_FMU_INPUTS_MAX];
	double output[OB_FMU_OUTPUTS_MAX]; // as of the step's end; any values, also NaN
	uint32_t first; // 1: the state holds starts, ob_fmu_start
	uint32_t state_bytes;
	unsigned char state[OB_FMU_STATE_BYTES]; // in: starts, or the state after the step before; out: after this one
} ob_fmu_turn;

typedef struct ob_fmu ob_fmu;

// Reads a model from its form in memory, of "size" bytes. false and e: it is damaged.
bool ob_fmu_model_read(const void *model, size_t size, ob_fmu_model *out, ob_error *e);
// Loads the library of a model in its form in memory, of "size" bytes. NULL and e: it cannot be loaded.
ob_fmu *ob_fmu_open(const void *model, size_t size, ob_error *e);
// One step of an object. false and e: the FMU has refused, or its state does not fit.
bool ob_fmu_run(ob_fmu *f, ob_fmu_turn *t, ob_error *e);

#endif
